//! A car under its monitor, one of whose tires loses air: `cargo run --release -p itpms-core --example puncture`.
//!
//! The measurements are simulated: 60 km/h on an average road; from 20 s on the front left tire falls from 241 to 170 kPa in 20 s.

#[path = "../tests/common/mod.rs"]
mod common;

use common::car_ride::{CarRide, PLACARD_KPA, RATE_HZ, config};
use itpms_core::{Alert, MonitorConfig, MonitoredCar, ParameterError};

/// Seconds at which the tire begins to lose air.
pub(crate) const BEGIN_S: f64 = 20.0;
/// What it has from 20 s later on.
pub(crate) const FINAL_KPA: f64 = 170.0;

fn pressures_kpa(time_s: f64) -> [f64; 4] {
    let share = ((time_s - BEGIN_S) / 20.0).clamp(0.0, 1.0);
    [PLACARD_KPA + share * (FINAL_KPA - PLACARD_KPA), PLACARD_KPA, PLACARD_KPA, PLACARD_KPA]
}

/// All that is warned of at the end of the drive.
pub(crate) fn drive() -> Result<Vec<Alert<f64>>, ParameterError> {
    let ride = CarRide { seconds: 60.0, pressure_kpa: pressures_kpa, ..CarRide::new(3) };
    let mut car = MonitoredCar::new(&MonitorConfig::new(&config()), RATE_HZ)?;
    let mut shown = 0;
    for sample in &ride.rows() {
        car.update(sample);
        for alert in car.report().alerts().skip(shown) {
            println!("{:5.1} s: {alert}", sample.time_s);
            shown += 1;
        }
    }
    Ok(car.report().alerts().copied().collect())
}

pub(crate) fn main() -> Result<(), ParameterError> {
    drive().map(|_| ())
}
