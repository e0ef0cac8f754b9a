//! How a monitored car is configured: the car, how its estimator is used, and the limits of its warnings.

use crate::car::EstimatorOptions;
use crate::decision;
use crate::diagnosis;
use crate::memory::Blank;
use crate::model::{CarConfig, ParameterError, SEA_LEVEL_KPA, positive};
use crate::real::Real;
use crate::warning::{self, Limits, Regulation, Rules};
use crate::wheel_speed::WheelSpeedConfig;

/// The configuration of a monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MonitorConfig<T> {
    /// The car, as its estimator knows it; without corners wheel speeds are all there is.
    pub car: CarConfig<T>,
    /// Configuration of the wheel speeds; `None`: they are not used.
    pub wheel_speeds: Option<WheelSpeedConfig<T>>,
    /// When to say what.
    pub limits: Limits<T>,
    /// Reference of each pressure in kPa; `None`: the placard's. A warm reference goes here.
    pub reference_kpa: [Option<T>; 4],
    /// Pressure of the air in kPa where the tires are filled, which gauges count from: 101.325 at sea level.
    pub home_kpa: T,
    /// How the car's estimator is used.
    pub options: EstimatorOptions,
    /// Numbers of the monitor that are usually left as they are.
    pub tuning: Tuning,
}

/// The tables of numbers by which a monitor works; wheel speeds have [their own](crate::wheel_speed::Tuning).
#[derive(Debug, Clone, Copy, PartialEq, Default, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tuning {
    /// Which sensors are wrong.
    pub diagnosis: diagnosis::Tuning,
    /// Which tires are low.
    pub decision: decision::Tuning,
    /// For how long evidence has to last.
    pub warning: warning::Tuning,
}

impl<T: Real> Blank for MonitorConfig<T> {
    /// Wheel speeds of zeros: that there are none is no zero.
    const BLANK: Self = Self {
        car: CarConfig::BLANK,
        wheel_speeds: Some(WheelSpeedConfig::BLANK),
        limits: Limits::BLANK,
        reference_kpa: [None; 4],
        home_kpa: T::ZERO,
        options: EstimatorOptions::BLANK,
        tuning: Tuning::BLANK,
    };
}

impl<T: Real> MonitorConfig<T> {
    /// The car with the limits of UN R141, against its placard.
    pub fn new(car: &CarConfig<T>) -> Self {
        Self {
            car: *car,
            wheel_speeds: None,
            limits: Regulation::default().into(),
            reference_kpa: [None; 4],
            home_kpa: T::lit(SEA_LEVEL_KPA),
            options: EstimatorOptions::default(),
            tuning: Tuning::default(),
        }
    }

    /// By what its warnings are decided.
    pub(super) fn rules(&self) -> Rules<'_, T> {
        Rules { limits: &self.limits, decision: &self.tuning.decision, tuning: &self.tuning.warning }
    }

    /// Whether a monitor can go by it.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        self.limits.check()?;
        self.tuning.diagnosis.check()?;
        self.tuning.decision.check()?;
        self.tuning.warning.check()?;
        positive("home_kpa", self.home_kpa)?;
        for reference in self.reference_kpa.into_iter().flatten() {
            positive("reference_kpa", reference)?;
        }
        Ok(())
    }
}
