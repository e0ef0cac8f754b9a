//! Instructions per sample under valgrind: `cargo bench -p itpms-bench --features instructions`. Needs valgrind and
//! `gungraun-runner` of the version in Cargo.lock.
#![allow(missing_docs)] // The macros make public items.

use std::hint::black_box;

use gungraun::{library_benchmark, library_benchmark_group, main};
use itpms_bench::car::{Extent, RunningCar};
use itpms_bench::{HOP, RATE_HZ, Running, WARM_UP, lean, published, road};
use itpms_core::Real;
use itpms_core::model::CornerSample;
use itpms_paper::{AekfUi, AekfUiLean, EstimatorKind};
use itpms_road::RoadFilter;

/// A sample made beforehand, so that making it is not counted.
const PROBE_F64: CornerSample<f64> = CornerSample { body_accel_m_s2: 0.4, wheel_accel_m_s2: -2.3 };
const PROBE_F32: CornerSample<f32> = CornerSample { body_accel_m_s2: 0.4, wheel_accel_m_s2: -2.3 };

// Boxed, because moving them in and out of the measured function would be counted.

fn boxed_published() -> Box<AekfUi<f64>> {
    Box::new(published())
}

fn boxed_lean<T: Real>() -> Box<AekfUiLean<T>> {
    Box::new(lean())
}

fn boxed_road<T: Real>() -> Box<RoadFilter<T>> {
    Box::new(road())
}

/// An estimator that has come `ahead` samples past the start of a frame.
fn informed<T: Real>(ahead: usize) -> Box<Running<T>> {
    let mut running = Box::new(Running::new(EstimatorKind::Informed));
    running.advance_by(ahead);
    running
}

#[library_benchmark]
#[bench::step(setup = boxed_published)]
fn published_f64(mut filter: Box<AekfUi<f64>>) -> Box<AekfUi<f64>> {
    black_box(filter.step(black_box(1.0 / RATE_HZ), &black_box(PROBE_F64)));
    filter
}

#[library_benchmark]
#[bench::step(setup = boxed_lean::<f64>)]
fn lean_f64(mut filter: Box<AekfUiLean<f64>>) -> Box<AekfUiLean<f64>> {
    black_box(filter.step(black_box(1.0 / RATE_HZ), &black_box(PROBE_F64)));
    filter
}

#[library_benchmark]
#[bench::step(setup = boxed_lean::<f32>)]
fn lean_f32(mut filter: Box<AekfUiLean<f32>>) -> Box<AekfUiLean<f32>> {
    black_box(filter.step(black_box(1.0 / RATE_HZ as f32), &black_box(PROBE_F32)));
    filter
}

#[library_benchmark]
#[bench::step(setup = boxed_road::<f64>)]
fn road_f64(mut filter: Box<RoadFilter<f64>>) -> Box<RoadFilter<f64>> {
    black_box(filter.update(black_box(WARM_UP as f64 / RATE_HZ), &black_box(PROBE_F64)));
    filter
}

#[library_benchmark]
#[bench::step(setup = boxed_road::<f32>)]
fn road_f32(mut filter: Box<RoadFilter<f32>>) -> Box<RoadFilter<f32>> {
    black_box(filter.update(black_box(WARM_UP as f64 / RATE_HZ), &black_box(PROBE_F32)));
    filter
}

#[library_benchmark]
#[bench::without_frame(args = (3), setup = informed::<f64>)]
#[bench::with_frame(args = (HOP - 1), setup = informed::<f64>)]
fn informed_sample_f64(mut running: Box<Running<f64>>) -> Box<Running<f64>> {
    black_box(running.advance());
    running
}

#[library_benchmark]
#[bench::without_frame(args = (3), setup = informed::<f32>)]
#[bench::with_frame(args = (HOP - 1), setup = informed::<f32>)]
fn informed_sample_f32(mut running: Box<Running<f32>>) -> Box<Running<f32>> {
    black_box(running.advance());
    running
}

#[library_benchmark]
#[bench::ten_frames(args = (0), setup = informed::<f64>)]
fn informed_300_samples_f64(mut running: Box<Running<f64>>) -> Box<Running<f64>> {
    running.advance_by(10 * HOP);
    running
}

#[library_benchmark]
#[bench::ten_frames(args = (0), setup = informed::<f32>)]
fn informed_300_samples_f32(mut running: Box<Running<f32>>) -> Box<Running<f32>> {
    running.advance_by(10 * HOP);
    running
}

fn car_stretch<T: Real>(extent: Extent, rate_hz: f64) -> RunningCar<T> {
    RunningCar::new(extent, rate_hz)
}

fn car_without_frame<T: Real>(rate_hz: f64) -> RunningCar<T> {
    let mut car = RunningCar::new(Extent::Everything, rate_hz);
    car.advance_to_no_frame();
    car
}

fn car_with_all_frames<T: Real>(rate_hz: f64) -> RunningCar<T> {
    let mut car = RunningCar::new(Extent::Everything, rate_hz);
    car.advance_to_most_frames();
    car
}

#[library_benchmark]
#[bench::everything_500_hz(args = (Extent::Everything, 500.0), setup = car_stretch::<f64>)]
#[bench::without_road_500_hz(args = (Extent::WithoutRoad, 500.0), setup = car_stretch::<f64>)]
#[bench::without_monitor_500_hz(args = (Extent::WithoutRoadAndMonitor, 500.0), setup = car_stretch::<f64>)]
#[bench::corners_alone_500_hz(args = (Extent::CornersAlone, 500.0), setup = car_stretch::<f64>)]
#[bench::everything_200_hz(args = (Extent::Everything, 200.0), setup = car_stretch::<f64>)]
fn car_stretch_f64(mut car: RunningCar<f64>) -> RunningCar<f64> {
    car.advance_by(car.stretch());
    car
}

#[library_benchmark]
#[bench::everything_500_hz(args = (Extent::Everything, 500.0), setup = car_stretch::<f32>)]
#[bench::without_road_500_hz(args = (Extent::WithoutRoad, 500.0), setup = car_stretch::<f32>)]
#[bench::everything_200_hz(args = (Extent::Everything, 200.0), setup = car_stretch::<f32>)]
fn car_stretch_f32(mut car: RunningCar<f32>) -> RunningCar<f32> {
    car.advance_by(car.stretch());
    car
}

#[library_benchmark]
#[bench::without_frame_500_hz(args = (500.0), setup = car_without_frame::<f64>)]
#[bench::all_frames_500_hz(args = (500.0), setup = car_with_all_frames::<f64>)]
#[bench::all_frames_200_hz(args = (200.0), setup = car_with_all_frames::<f64>)]
fn car_sample_f64(mut car: RunningCar<f64>) -> RunningCar<f64> {
    black_box(car.advance());
    car
}

#[library_benchmark]
#[bench::without_frame_500_hz(args = (500.0), setup = car_without_frame::<f32>)]
#[bench::all_frames_500_hz(args = (500.0), setup = car_with_all_frames::<f32>)]
#[bench::all_frames_200_hz(args = (200.0), setup = car_with_all_frames::<f32>)]
fn car_sample_f32(mut car: RunningCar<f32>) -> RunningCar<f32> {
    black_box(car.advance());
    car
}

library_benchmark_group!(
    name = whole_car,
    benchmarks = [car_stretch_f64, car_stretch_f32, car_sample_f64, car_sample_f32]
);
library_benchmark_group!(
    name = per_sample,
    benchmarks = [
        published_f64,
        lean_f64,
        lean_f32,
        road_f64,
        road_f32,
        informed_sample_f64,
        informed_sample_f32,
        informed_300_samples_f64,
        informed_300_samples_f32
    ]
);
main!(library_benchmark_groups = [per_sample, whole_car]);
