//! What is compared.

use itpms_bench::peers::corner::Drive;
use itpms_bench::peers::{Peer, STEPS, on_kfilter, on_minikalman, on_nalgebra, ours};
use itpms_core::Real;

/// What a filter computes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Scalar {
    F32,
    F64,
}

impl Scalar {
    pub(crate) const BOTH: [Self; 2] = [Self::F32, Self::F64];

    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// The filter of one library. `key` is what the controller's program prints, too.
pub(crate) struct Row {
    pub(crate) key: &'static str,
    pub(crate) label: &'static str,
    pub(crate) bytes: fn(Scalar) -> usize,
    /// All steps once, from the start.
    pub(crate) run: fn(Scalar),
    /// Hands criterion what it times.
    pub(crate) time: fn(Scalar, &mut criterion::Criterion, &str),
}

/// Every filter that is written in Rust; filterpy's two rows come from `python`.
pub(crate) fn rows() -> Vec<Row> {
    vec![
        row::<ours::Lean<f32>, ours::Lean<f64>>("lean", "`AekfUiLean`"),
        row::<ours::Dense<f32>, ours::Dense<f64>>("dense", "`AekfUi`"),
        row::<on_nalgebra::Step<f32>, on_nalgebra::Step<f64>>("nalgebra", "nalgebra, written out"),
        row::<on_kfilter::Step<f32>, on_kfilter::Step<f64>>("kfilter", "kfilter"),
        row::<on_minikalman::Step<f32>, on_minikalman::Step<f64>>("minikalman", "minikalman"),
        row::<on_nalgebra::Ordinary<f32>, on_nalgebra::Ordinary<f64>>(
            "ordinary-nalgebra",
            "nalgebra, written out",
        ),
        row::<on_kfilter::Ordinary<f32>, on_kfilter::Ordinary<f64>>("ordinary-kfilter", "kfilter"),
        row::<on_minikalman::Ordinary<f32>, on_minikalman::Ordinary<f64>>(
            "ordinary-minikalman",
            "minikalman",
        ),
    ]
}

fn row<A: Peer<Scalar = f32>, B: Peer<Scalar = f64>>(key: &'static str, label: &'static str) -> Row {
    Row {
        key,
        label,
        bytes: |scalar| match scalar {
            Scalar::F32 => size_of::<A>(),
            Scalar::F64 => size_of::<B>(),
        },
        run: |scalar| match scalar {
            Scalar::F32 => run::<A>(),
            Scalar::F64 => run::<B>(),
        },
        time: |scalar, criterion, id| match scalar {
            Scalar::F32 => time::<A>(criterion, id),
            Scalar::F64 => time::<B>(criterion, id),
        },
    }
}

/// The samples, made beforehand.
pub(crate) fn samples<T: Real>() -> Vec<[T; 2]> {
    let mut drive = Drive::default();
    (0..STEPS).map(|_| drive.sample()).collect()
}

/// What is counted and timed: a step on a filter that lies in memory. Its name is what valgrind is given.
#[inline(never)]
fn counted_step<P: Peer>(filter: &mut P, measured: [P::Scalar; 2]) {
    filter.step(measured);
}

fn run<P: Peer>() {
    let mut filter = Box::new(P::fresh());
    for measured in samples() {
        counted_step(&mut *filter, measured);
    }
    assert!(filter.found().iter().all(|value| value.is_finite()), "a filter that diverged was counted");
}

fn time<P: Peer>(criterion: &mut criterion::Criterion, id: &str) {
    let samples = samples::<P::Scalar>();
    criterion.bench_function(id, |bencher| {
        let all = |filter: &mut P| {
            for measured in &samples {
                counted_step(filter, *measured);
            }
        };
        bencher.iter_batched_ref(P::fresh, all, criterion::BatchSize::SmallInput);
    });
}
