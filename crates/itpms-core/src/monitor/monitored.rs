//! An estimator under a monitor: bad sensors are kept from it, what it says is judged, and corners start again when
//! their sensors are back.

use crate::car::CarEstimator;
use crate::estimator::OutsideStiffness;
use crate::memory::Blank;
use crate::model::{
    Air, CalibrationError, CarEstimate, CarSample, Corner, ParameterError, VehicleCalibration,
};
use crate::monitor::{Monitor, MonitorConfig, MonitoredWheels};
use crate::real::Real;
use crate::warning::MonitorReport;

/// A running estimator and its monitor. A value: clone it, save it, go on.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MonitoredCar<T: Real> {
    estimator: CarEstimator<T>,
    monitor: Monitor<T>,
}

impl<T: Real> MonitoredCar<T> {
    /// A car for samples that come at about `sample_rate_hz`, by value: some 140 KB in `f32`, and on the stack more than once
    /// that until it is where it stays. A controller [configures](Self::configure) it in a `static`.
    ///
    /// # Errors
    /// The rate must be 100 to 2000 Hz, limits and references numbers in order; parameters of a corner that the filters
    /// refuse are named.
    pub fn new(config: &MonitorConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let mut car = Self::unconfigured();
        car.configure(config, sample_rate_hz)?;
        Ok(car)
    }

    /// Memory for a car, as a constant: for a `static`, to be [configured](Self::configure) where it lies. Until then it is a car
    /// without corners, of which nothing is estimated.
    #[must_use]
    pub const fn unconfigured() -> Self {
        Self::BLANK
    }

    /// What [`new`](Self::new) does, where the car lies: it takes little stack. Whatever was there is forgotten.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the car is unconfigured then.
    pub fn configure(
        &mut self,
        config: &MonitorConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<(), ParameterError> {
        self.estimator.configure(&config.car, sample_rate_hz)?;
        self.estimator.set_options(&config.options);
        self.monitor.configure(config, sample_rate_hz).inspect_err(|_| self.estimator.clear())
    }

    /// Begins with what a calibration on an earlier drive taught; before the first sample.
    ///
    /// # Errors
    /// An implausible calibration, or one of other corners or other placard pressures.
    pub fn load_calibration(&mut self, calibration: &VehicleCalibration<T>) -> Result<(), CalibrationError> {
        self.estimator.load_calibration(calibration)
    }

    /// Takes one sample; gives the estimate after it, its validity and warnings being the monitor's.
    pub fn update(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        let at = self.estimator.clock().take(sample.time_s, sample.speed_m_s);
        let (at, screened) = self.monitor.screen(&at, sample);
        let suspected = self.monitor.take_rollback_request();
        if !suspected.is_empty() {
            self.estimator.rollback(Corner::ALL.map(|corner| suspected.contains(corner)));
        }
        let mut estimate = self.estimator.update_at(&at, &screened);
        for corner in self.monitor.judge(&at, &mut estimate).iter() {
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

    /// Ends the calibration that is to begin or under way, as where a log ends with it; what it taught is there then.
    pub fn end_calibration(&mut self) {
        self.estimator.end_calibration();
        self.monitor.end_calibration();
    }

    /// Takes the stiffness of a corner's tire that another source follows from the next sample on, in the place of what the corner's
    /// own frames show, until `None` is given.
    pub fn follow(&mut self, corner: Corner, stiffness: Option<OutsideStiffness<T>>) {
        self.estimator.follow(corner, stiffness);
    }

    /// Takes what the wheel speeds of the same car have shown with their last sample: a second witness of how the tires
    /// differ. A car without four corners whose axles share the road learns nothing from it.
    pub fn follow_wheels(&mut self, wheels: &MonitoredWheels<T>) {
        if wheels.has_news() {
            self.estimator.follow_radii(wheels.differences());
        }
    }

    /// Takes the air around the car as measured ([`Monitor::follow_air`]), before the sample of the same time.
    pub fn follow_air(&mut self, air: &Air<T>) {
        self.monitor.follow_air(air);
    }

    /// The estimator.
    pub fn estimator(&self) -> &CarEstimator<T> {
        &self.estimator
    }

    /// The driver's calibration: all tires have their placard pressures from the next sample on. The estimator learns the car for
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
