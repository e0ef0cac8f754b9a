//! How much faster than driving: half an hour of `drive-normal` through the monitored car at 200 and 500 Hz, on one core.
//! `cargo run --release -p itpms-bench --example drive`.

use std::hint::black_box;
use std::time::Instant;

use itpms_bench::car::{shipped, taken};
use itpms_core::Real;
use itpms_core::model::CarSample;
use itpms_sim::error::ScenarioError;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

const DRIVE_S: f64 = 1800.0;

fn main() -> Result<(), ScenarioError> {
    for rate_hz in [200.0, 500.0] {
        let scenario = Scenario { rate_hz, duration_s: DRIVE_S, ..Scenario::builtin("drive-normal")? };
        let rows: Vec<_> = Simulation::new(&scenario, 1)?.map(|row| row.car_sample()).collect();
        report::<f64>("f64", rate_hz, &rows);
        report::<f32>("f32", rate_hz, &rows);
    }
    Ok(())
}

fn report<T: Real>(scalar: &str, rate_hz: f64, rows: &[CarSample<f64>]) {
    let mut car = shipped::<T>(rate_hz);
    let (wall, processor) = (Instant::now(), processor_s());
    for row in rows {
        black_box(car.update(&taken(row)));
    }
    // The processor's time where the system tells it: others may be at work on the same core.
    let (named, seconds) = match (processor, processor_s()) {
        (Some(before), Some(after)) => ("processor", after - before),
        _ => ("wall", wall.elapsed().as_secs_f64()),
    };
    let driven_s = rows.len() as f64 / rate_hz;
    let (per_sample_us, faster) = (1e6 * seconds / rows.len() as f64, driven_s / seconds);
    println!(
        "{scalar}, {rate_hz} Hz: {seconds:.1} s ({named}), {per_sample_us:.2} us per sample, {faster:.0} times"
    );
}

/// Seconds this thread has been on a processor, on Linux.
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}
