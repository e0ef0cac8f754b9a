//! Wall-clock time per sample: `cargo bench -p itpms-bench --features time`.
#![allow(missing_docs)] // The macros make public items.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use itpms_bench::car::{Extent, RunningCar};
use itpms_bench::{HOP, PUBLISHED_WARM_UP, RATE_HZ, Running, WARM_UP, published, road, sample};
use itpms_core::Real;
use itpms_paper::EstimatorKind;

fn scalar<T: Real>(c: &mut Criterion, name: &str) {
    c.bench_function(&format!("road filter, {name}"), |b| {
        let (mut filter, mut k) = (road::<T>(), WARM_UP);
        let samples: Vec<_> = (0..WARM_UP).map(sample::<T>).collect();
        b.iter(|| {
            k += 1;
            filter.update(k as f64 / RATE_HZ, black_box(&samples[k % WARM_UP]))
        });
    });
    for kind in [EstimatorKind::Informed, EstimatorKind::AekfUiInformed] {
        let mut running = Running::<T>::new(kind);
        c.bench_function(&format!("{}, one frame of {HOP} samples, {name}", kind.label()), |b| {
            b.iter(|| black_box(&mut running).advance_by(HOP));
        });
    }
}

fn published_step(c: &mut Criterion) {
    let start = published();
    c.bench_function("published AEKF-UI step, f64", |b| {
        let sample = sample(PUBLISHED_WARM_UP);
        // From the same state every time: a filter that runs away is not what is measured.
        b.iter_batched_ref(
            || start,
            |filter| filter.step(black_box(1.0 / RATE_HZ), black_box(&sample)),
            BatchSize::SmallInput,
        );
    });
}

/// The whole car as it is shipped, over a stretch of six tenths of a second.
fn whole_car<T: Real>(c: &mut Criterion, name: &str) {
    for rate_hz in [200.0, 500.0] {
        let start = RunningCar::<T>::new(Extent::Everything, rate_hz);
        let stretch = start.stretch();
        c.bench_function(&format!("car, {stretch} samples at {rate_hz} Hz, {name}"), |b| {
            let go = |car: &mut RunningCar<T>| car.advance_by(black_box(stretch));
            b.iter_batched_ref(|| start.clone(), go, BatchSize::LargeInput);
        });
    }
}

fn all(c: &mut Criterion) {
    published_step(c);
    scalar::<f64>(c, "f64");
    scalar::<f32>(c, "f32");
    whole_car::<f64>(c, "f64");
    whole_car::<f32>(c, "f32");
}

criterion_group!(benches, all);
criterion_main!(benches);
