//! Which tire has lost air, from wheel speeds alone: `cargo run --release -p itpms-core --example wheel_speeds`.
//!
//! The measurements are simulated: 72 km/h straight on. A calibration of ten minutes, then a drive on which the rear right tire rolls on
//! a radius that is 0.25 % smaller.

use itpms_core::wheel_speed::{DrivenAxle, WheelSpeedConfig, WheelSpeedSample};
use itpms_core::{MonitoredWheels, ParameterError};

const RATE_HZ: f64 = 20.0;
const CALIBRATION_S: f64 = 600.0;
const DRIVE_S: f64 = 2400.0;
/// By how much the tire's radius is smaller, as a share of it.
pub(crate) const SMALLER: f64 = 0.0025;

/// Wheel speeds as a bus sends them: tires that are not quite alike, steps of 0.01 m/s, noise of one step.
fn sample(k: u32, smaller: f64, noise: &mut impl FnMut() -> f64) -> WheelSpeedSample<f64> {
    let factors = [1.0, 1.0005, 0.9990, 0.9993 / (1.0 - smaller)];
    WheelSpeedSample {
        time_s: f64::from(k) / RATE_HZ,
        wheel_speed_m_s: factors.map(|factor| ((20.0 * factor + 0.01 * noise()) * 100.0).round() / 100.0),
        yaw_rate_rad_s: 0.0,
        accel_x_m_s2: 0.0,
        accel_y_m_s2: 0.0,
        brake: Some(false),
    }
}

/// The monitor at the end. A controller has it in a `static`, as `MonitoredWheels::unconfigured()`, and configures it there.
pub(crate) fn drive() -> Result<MonitoredWheels<f64>, ParameterError> {
    // Wheelbase and tracks in m, driven axle.
    let mut monitor = MonitoredWheels::new(&WheelSpeedConfig::new(2.66, 1.56, 1.57, DrivenAxle::Front))?;
    // All pressures have just been set.
    monitor.begin_calibration(CALIBRATION_S)?;
    let mut state = 1u32;
    // Uniform in -1 to 1: Knuth's and Lewis' generator is enough here.
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 23) - 1.0
    };
    for k in 0..(DRIVE_S * RATE_HZ) as u32 {
        let calibrated = monitor.calibration().is_some();
        monitor.update(&sample(k, if calibrated { SMALLER } else { 0.0 }, &mut noise));
    }
    Ok(monitor)
}

pub(crate) fn main() -> Result<(), ParameterError> {
    let monitor = drive()?;
    if let Some(alert) = monitor.alert() {
        println!("{alert}");
    }
    let report = monitor.radii();
    println!("{:?} after {:.0} s", report.state, report.time_s);
    for (name, wheel) in ["front left", "front right", "rear left", "rear right"].iter().zip(&report.wheels) {
        println!("{name:12} radius {:+.3} ± {:.3} %", 100.0 * wheel.change, 100.0 * wheel.change_sd);
    }
    Ok(())
}
