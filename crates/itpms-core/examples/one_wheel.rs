//! The pressure of one tire from the accelerations above and at its wheel: `cargo run --release -p itpms-core --example one_wheel`.
//!
//! The measurements are simulated: 40 s at 50 km/h on an average road, the tire at 230 kPa. The estimator knows the corner's masses,
//! spring, damper and tire, and neither the road nor the pressure.

#[path = "../tests/common/mod.rs"]
mod common;

use common::ride::{Ride, Row};
use itpms_core::{CornerConfig, CornerEstimate, Estimator, ParameterError};

/// What is estimated after each row, and the true pressure in kPa.
pub(crate) fn drive() -> Result<Vec<(CornerEstimate<f64>, f64)>, ParameterError> {
    let ride = Ride::new(1);
    let mut estimator = Estimator::new(&CornerConfig::paper(), ride.rate_hz)?;
    let mut estimate = |row: Row| {
        let estimate = estimator.update(row.time_s, row.speed_m_s, row.body, row.wheel);
        (estimate, row.pressure_kpa)
    };
    Ok(ride.rows().into_iter().map(&mut estimate).collect())
}

pub(crate) fn main() -> Result<(), ParameterError> {
    for (estimate, truth_kpa) in drive()?.iter().skip(499).step_by(2500) {
        let (pressure_kpa, sd_kpa) = (estimate.pressure_kpa, estimate.pressure_sd_kpa);
        println!("{pressure_kpa:5.1} ± {sd_kpa:4.1} kPa, true {truth_kpa:.1}  {:?}", estimate.validity);
    }
    Ok(())
}
