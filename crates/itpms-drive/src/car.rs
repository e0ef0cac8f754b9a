//! The estimator of a drive's car, whichever was chosen.

use itpms_core::car::CarEstimator;
use itpms_core::estimator::OutsideStiffness;
use itpms_core::model::CarEstimate;
use itpms_core::model::{Air, CalibrationError, CarSample, Corner, ParameterError, VehicleCalibration};
use itpms_core::monitor::{MonitorConfig, MonitoredCar, MonitoredWheels};
use itpms_core::warning::MonitorReport;
use itpms_paper::{EstimatorKind, PaperCar};

/// A running estimator of a car, in its box: by value it would cross the stack, and whose that is the caller alone knows.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AnyCar {
    /// The default one, under its monitor.
    Monitored(Box<MonitoredCar<f64>>),
    /// One of the paper's filters on each corner.
    Paper(Box<PaperCar<f64>>),
}

impl AnyCar {
    /// An estimator of `kind` for samples that come at about `sample_rate_hz`.
    ///
    /// # Errors
    /// The rate must be positive and finite; limits and parameters that the estimator refuses are named.
    pub fn new(
        kind: EstimatorKind,
        config: &MonitorConfig<f64>,
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        if kind != EstimatorKind::Informed {
            return Ok(Self::Paper(Box::new(PaperCar::new(kind, config, sample_rate_hz)?)));
        }
        let mut car = Box::new(MonitoredCar::unconfigured());
        car.configure(config, sample_rate_hz)?;
        Ok(Self::Monitored(car))
    }

    /// A car of which nothing is estimated.
    #[must_use]
    pub fn without_corners() -> Self {
        Self::Monitored(Box::new(MonitoredCar::unconfigured()))
    }

    /// The default estimator, where it is that one.
    #[must_use]
    pub fn estimator(&self) -> Option<&CarEstimator<f64>> {
        match self {
            Self::Monitored(car) => Some(car.estimator()),
            Self::Paper(_) => None,
        }
    }

    /// Takes the stiffness of a corner's tire that another source follows, which the paper's filters have no use for.
    pub fn follow(&mut self, corner: Corner, stiffness: Option<OutsideStiffness<f64>>) {
        if let Self::Monitored(car) = self {
            car.follow(corner, stiffness);
        }
    }

    /// Takes what the car's wheel speeds have shown, which the paper's filters have no use for.
    pub fn follow_wheels(&mut self, wheels: &MonitoredWheels<f64>) {
        if let Self::Monitored(car) = self {
            car.follow_wheels(wheels);
        }
    }

    /// Takes what the car says of the air around it, which the paper's filters have no use for.
    pub fn follow_air(&mut self, air: &Air<f64>) {
        if let Self::Monitored(car) = self {
            car.follow_air(air);
        }
    }

    /// All tires have their placard pressures from the next sample on, for `seconds`.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        match self {
            Self::Monitored(car) => car.begin_calibration(seconds),
            Self::Paper(car) => car.begin_calibration(seconds),
        }
    }

    /// Ends the calibration that is under way.
    pub fn end_calibration(&mut self) {
        if let Self::Monitored(car) = self {
            car.end_calibration();
        }
    }

    /// Begins with what an earlier drive taught, which the paper's filters have no use for.
    ///
    /// # Errors
    /// An implausible calibration, or one of other corners or other placard pressures.
    pub fn load_calibration(
        &mut self,
        calibration: &VehicleCalibration<f64>,
    ) -> Result<(), CalibrationError> {
        match self {
            Self::Monitored(car) => car.load_calibration(calibration),
            Self::Paper(_) => Ok(()),
        }
    }

    /// Takes one sample; gives the estimate after it.
    pub fn update(&mut self, sample: &CarSample<f64>) -> CarEstimate<f64> {
        match self {
            Self::Monitored(car) => car.update(sample),
            Self::Paper(car) => car.update(sample),
        }
    }

    /// What the monitor reports after the last sample.
    #[must_use]
    pub fn report(&self) -> &MonitorReport<f64> {
        match self {
            Self::Monitored(car) => car.report(),
            Self::Paper(car) => car.report(),
        }
    }

    /// Whether the speed says that the car stands while its wheels roll.
    #[must_use]
    pub fn denies_standstill(&self) -> bool {
        match self {
            Self::Monitored(car) => car.denies_standstill(),
            Self::Paper(car) => car.denies_standstill(),
        }
    }
}
