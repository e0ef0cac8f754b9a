//! A checksum of every number that the core gives for a short drive, in `f32` and `f64`: what a refactoring must leave as it
//! is (`.ci/golden_trace.py`). `cargo run --release -p itpms-bench --example trace`.
#![allow(clippy::expect_used)] // As in the library: without its fixed drive there is nothing to check.

use itpms_bench::car::{shipped, taken};
use itpms_bench::{RATE_HZ, SPEED_M_S, sample};
use itpms_core::Real;
use itpms_core::model::{CarSample, CornerConfig, CornerEstimate, CornerSample};
use itpms_paper::{AnyEstimator, EstimatorKind};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

const DRIVE_S: f64 = 40.0;
/// A sensor is lost for a while, so that its corner restarts.
const LOST_S: std::ops::Range<f64> = 28.0..33.0;

/// FNV-1a over the bits of numbers.
struct Checksum(u64);

impl Checksum {
    fn take<T: Real>(&mut self, value: T) {
        for byte in value.to_f64().to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn take_corner<T: Real>(&mut self, corner: &CornerEstimate<T>) {
        let numbers = [corner.pressure_kpa, corner.pressure_sd_kpa, corner.stiffness_n_per_m, corner.road_m];
        numbers.into_iter().for_each(|number| self.take(number));
        self.take(T::lit(f64::from(u8::from(corner.validity.is_valid()))));
    }
}

fn four_wheels<T: Real>(rows: &[CarSample<f64>], rate_hz: f64) -> u64 {
    let (mut car, mut sum) = (shipped::<T>(rate_hz), Checksum(0xcbf2_9ce4_8422_2325));
    for row in rows {
        let estimate = car.update(&taken(row));
        estimate.corners.iter().flatten().for_each(|corner| sum.take_corner(corner));
        sum.take(T::lit(car.report().alerts().count() as f64));
    }
    sum.0
}

fn one_wheel<T: Real>(kind: EstimatorKind) -> u64 {
    let mut estimator =
        AnyEstimator::new(kind, &CornerConfig::<T>::paper(), RATE_HZ).expect("the paper's corner");
    let mut sum = Checksum(0xcbf2_9ce4_8422_2325);
    for k in 0..(DRIVE_S * RATE_HZ) as usize {
        let CornerSample { body_accel_m_s2, wheel_accel_m_s2 } = sample::<T>(k);
        let time_s = k as f64 / RATE_HZ;
        sum.take_corner(&estimator.update(time_s, T::lit(SPEED_M_S), body_accel_m_s2, wheel_accel_m_s2));
    }
    sum.0
}

fn main() {
    for rate_hz in [100.0, 200.0, 500.0] {
        let mut scenario = Scenario::builtin("drive-puncture").expect("a built-in drive");
        (scenario.rate_hz, scenario.duration_s) = (rate_hz, DRIVE_S);
        let mut rows: Vec<_> =
            Simulation::new(&scenario, 2).expect("a built-in drive").map(|row| row.car_sample()).collect();
        for row in rows.iter_mut().filter(|row| LOST_S.contains(&row.time_s)) {
            if let Some(front_right) = &mut row.corners[1] {
                front_right.wheel_accel_m_s2 = f64::NAN;
            }
        }
        println!("core, four wheels, {rate_hz} Hz, f32 {:016x}", four_wheels::<f32>(&rows, rate_hz));
        println!("core, four wheels, {rate_hz} Hz, f64 {:016x}", four_wheels::<f64>(&rows, rate_hz));
    }
    for kind in EstimatorKind::ALL {
        println!("core, one wheel, {}, f64 {:016x}", kind.label(), one_wheel::<f64>(kind));
    }
    println!("core, one wheel, informed, f32 {:016x}", one_wheel::<f32>(EstimatorKind::Informed));
}
