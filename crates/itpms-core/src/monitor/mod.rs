//! The monitor that a car would ship: watches sensors and pressures, and says what is wrong, since when and why.
//!
//! [`MonitoredCar`] is the whole: an estimator between the two halves of a [`Monitor`]. Called by the binary, the
//! studies and controllers. The monitor must never know how a pressure was estimated, nor the truth
//! (docs/math/monitor.md).

mod alert;
mod config;
mod monitored;
mod report;
mod wheels;

pub use alert::{Alert, Cause, Malfunction, Place, Reading, Sensor};
pub use config::{Limits, MonitorConfig, Regulation};
pub use monitored::MonitoredCar;
pub use report::{Change, Doubt, MonitorReport, WheelReport, WheelState};
pub use wheels::Wheels;

use crate::car::CarEstimate;
use crate::quarter_car::{ParameterError, positive};
use crate::real::Real;
use crate::sample::CarSample;

/// A running monitor. A value: clone it, save it, go on. Per sample: [`screen`](Self::screen) what the sensors say, give
/// what it returns to the estimator, and let it [`judge`](Self::judge) what comes out; [`MonitoredCar`] does so.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Monitor<T> {
    config: MonitorConfig<T>,
    report: MonitorReport<T>,
}

impl<T: Real> Monitor<T> {
    /// A monitor for samples that come at about `sample_rate_hz`.
    ///
    /// # Errors
    /// The rate must be positive and finite.
    pub fn new(config: &MonitorConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        positive("sample_rate_hz", sample_rate_hz)?;
        Ok(Self { config: *config, report: MonitorReport::empty() })
    }

    /// Looks at a sample; gives it back without the values that are not to be learned from.
    pub fn screen(&mut self, sample: &CarSample<T>) -> CarSample<T> {
        *sample
    }

    /// Takes what was estimated after the sample; gives the wheels whose estimator should start again, because their
    /// sensors have come back. The estimate leaves with the monitor's validity and warnings.
    pub fn judge(&mut self, estimate: &mut CarEstimate<T>) -> Wheels {
        self.report.time_s = estimate.time_s;
        Wheels::NONE
    }

    /// What there is to say now.
    pub fn report(&self) -> &MonitorReport<T> {
        &self.report
    }

    /// What it was told.
    pub fn config(&self) -> &MonitorConfig<T> {
        &self.config
    }
}
