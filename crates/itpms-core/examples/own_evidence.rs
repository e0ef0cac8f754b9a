//! Evidence of one's own beside the accelerations: `cargo run --release -p itpms-core --example own_evidence`.
//!
//! The measurements are simulated: 40 s at 50 km/h on a road so smooth that the accelerations show next to nothing, the tire falling from
//! 230 to 200 kPa. Something else, such as a deflection sensor in the tire, reads its stiffness ten times a second to within 5 %: a filter of
//! two lines follows those readings, and the estimator takes what it believes in the place of its own frames.

#[path = "../tests/common/mod.rs"]
mod common;

use common::quarter_plant::Random;
use common::ride::{Ride, Row};
use itpms_core::estimator::OutsideStiffness;
use itpms_core::{CornerConfig, CornerEstimate, Estimator, ParameterError};

/// Standard deviation of a reading, as a share of the stiffness.
const READING_SD: f64 = 0.05;
/// By how much the stiffness may wander in the root of a second, as a share of it.
const WANDER: f64 = 0.01;
/// Seconds between readings.
const STEP_S: f64 = 0.1;

/// A Kalman filter of one state: the stiffness, which wanders.
struct Deflection {
    stiffness_n_per_m: f64,
    variance: f64,
    /// Mean of the squared residuals over what they should be.
    nis: f64,
}

impl Deflection {
    fn new(stiffness_n_per_m: f64) -> Self {
        Self { stiffness_n_per_m, variance: (0.2 * stiffness_n_per_m).powi(2), nis: 1.0 }
    }

    fn read(&mut self, reading_n_per_m: f64) -> OutsideStiffness<f64> {
        let noise = (READING_SD * self.stiffness_n_per_m).powi(2);
        self.variance += (WANDER * self.stiffness_n_per_m).powi(2) * STEP_S;
        let residual = reading_n_per_m - self.stiffness_n_per_m;
        self.nis += 0.05 * (residual * residual / (self.variance + noise) - self.nis);
        let gain = self.variance / (self.variance + noise);
        self.stiffness_n_per_m += gain * residual;
        self.variance *= 1.0 - gain;
        OutsideStiffness {
            stiffness_n_per_m: self.stiffness_n_per_m,
            stiffness_sd_n_per_m: self.variance.sqrt(),
            rate_per_s: 0.0,
            // A filter's estimate is not independent of its earlier ones.
            independent_sd_n_per_m: None,
            change_probability: 0.0,
            nis: self.nis,
            learned_s: STEP_S,
        }
    }
}

/// What is estimated after each row, with the readings or without, and the true pressure in kPa.
pub(crate) fn drive(with_readings: bool) -> Result<Vec<(CornerEstimate<f64>, f64)>, ParameterError> {
    let ride = Ride { roughness_m3: |_| 1e-9, pressure_kpa: |time_s| 230.0 - 0.75 * time_s, ..Ride::new(4) };
    let config = CornerConfig::paper();
    let mut estimator = Estimator::new(&config, ride.rate_hz)?;
    let mut deflection = Deflection::new(config.tire.stiffness_n_per_m(config.placard_kpa));
    let (mut noise, mut next_s) = (Random::new(5), 0.0);
    let mut estimate = |row: Row| {
        if with_readings && row.time_s >= next_s {
            let truth = config.tire.stiffness_n_per_m(row.pressure_kpa);
            estimator.follow(Some(deflection.read(truth * (1.0 + READING_SD * noise.normal()))));
            next_s += STEP_S;
        }
        (estimator.update(row.time_s, row.speed_m_s, row.body, row.wheel), row.pressure_kpa)
    };
    Ok(ride.rows().into_iter().map(&mut estimate).collect())
}

pub(crate) fn main() -> Result<(), ParameterError> {
    for (name, with_readings) in [("accelerations alone", false), ("with own evidence", true)] {
        println!("{name}");
        for (estimate, truth_kpa) in drive(with_readings)?.iter().skip(499).step_by(2500) {
            let (pressure_kpa, sd_kpa) = (estimate.pressure_kpa, estimate.pressure_sd_kpa);
            println!("  {pressure_kpa:5.1} ± {sd_kpa:4.1} kPa, true {truth_kpa:.1}  {:?}", estimate.validity);
        }
    }
    Ok(())
}
