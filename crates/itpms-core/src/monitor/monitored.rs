//! An estimator under a monitor: bad sensors are kept from it, what it says is judged, and corners start again when
//! their sensors are back.

use crate::car::{CarEstimate, CarEstimator};
use crate::estimator::EstimatorKind;
use crate::model::{CarSample, Corner, ParameterError};
use crate::monitor::Monitor;
use crate::real::Real;
use crate::warning::MonitorReport;

/// A running estimator and its monitor. A value: clone it, save it, go on.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub struct MonitoredCar<T: Real> {
    estimator: CarEstimator<T>,
    monitor: Monitor<T>,
}

impl<T: Real> MonitoredCar<T> {
    /// Puts the two together, before the first sample.
    pub fn new(estimator: CarEstimator<T>, monitor: Monitor<T>) -> Self {
        Self { estimator, monitor }
    }

    /// Takes one sample; gives the estimate after it, its validity and warnings being the monitor's. A published filter's
    /// estimate, which is never valid, is passed on as it is.
    pub fn update(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        if matches!(self.estimator.kind(), EstimatorKind::AekfUi | EstimatorKind::EkfUi) {
            return self.estimator.update(sample);
        }
        let screened = self.monitor.screen(sample);
        let rollback_requested = self.monitor.take_rollback_request();
        if !rollback_requested.is_empty() {
            self.estimator.rollback(Corner::ALL.map(|corner| rollback_requested.contains(corner)));
        }
        let mut estimate = self.estimator.update(&screened);
        for corner in self.monitor.judge(&mut estimate).iter() {
            self.estimator.restart_corner(corner);
        }
        estimate
    }

    /// What there is to say now.
    pub fn report(&self) -> &MonitorReport<T> {
        self.monitor.report()
    }

    /// Whether the speed says that the car stands while its wheels roll ([`Monitor::denies_standstill`]).
    pub fn denies_standstill(&self) -> bool {
        self.monitor.denies_standstill()
    }

    /// The estimator.
    pub fn estimator(&self) -> &CarEstimator<T> {
        &self.estimator
    }

    /// The driver's reset: all tires have their placard pressures from the next sample on. The estimator learns the car for
    /// `seconds`; the monitor then takes what the warm tires are read to have for what they should have. Before the first
    /// sample, too.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.estimator.begin_calibration(seconds)?;
        self.monitor.begin_calibration(seconds)
    }
}
