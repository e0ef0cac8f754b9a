//! Calibration of the car: how it differs from its vehicle file while all tires are known to be right.
//!
//! Made by [`CarEstimator::calibration`](crate::car::CarEstimator::calibration) when a calibration is over, given to the next drive's
//! estimator. Knows nothing of files: whoever stores it checks that it belongs to the car.

use crate::memory::Blank;
use crate::real::Real;

/// Standard deviation of the inter-axle residual's bias of a tire's compliance, as a share of that at placard pressure,
/// before any calibration.
pub(crate) const UNCALIBRATED_BIAS_SD: f64 = 0.015;
/// Standard deviation of a rear axle's coupling before anything is learned: none of independent wheels, some 0.05 to 0.1 of a twist beam,
/// 0.2 to 0.33 of a solid axle.
pub(crate) const UNKNOWN_COUPLING_SD: f64 = 0.15;

/// A learned quantity and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Learned<T> {
    /// The value.
    pub value: T,
    /// Its standard deviation.
    pub sd: T,
}

/// Learned values of one corner. Masses, damper and spring as relative deviations from the vehicle file.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerCalibration<T> {
    /// Pressure in kPa gauge that the tire was known to have.
    pub placard_kpa: T,
    /// Unsprung mass, relative deviation.
    pub unsprung_mass: Learned<T>,
    /// Damping, relative deviation.
    pub damping: Learned<T>,
    /// Suspension stiffness, relative deviation.
    pub spring: Learned<T>,
    /// Bias of the road's spectrum in kPa.
    pub spectrum_bias_kpa: Learned<T>,
    /// Bias of the tire's compliance by the shared road, as a share of that at placard pressure.
    pub shared_road_bias: Learned<T>,
}

impl<T: Real> CornerCalibration<T> {
    /// Prior of [`shared_road_bias`](Self::shared_road_bias).
    pub fn uncalibrated_residual_bias() -> Learned<T> {
        Learned { value: T::zero(), sd: T::lit(UNCALIBRATED_BIAS_SD) }
    }
}

/// Learned values of the whole car.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VehicleCalibration<T> {
    /// The corners, in the order of [`Corner::ALL`](crate::model::Corner::ALL).
    pub corners: [Option<CornerCalibration<T>>; 4],
    /// Stiffness of the front and the rear anti-roll bar at a wheel, over its spring's in the vehicle file.
    pub bar: [Learned<T>; 2],
    /// Share of a rear wheel's unsprung mass that moves with the other one.
    pub rear_axle_coupling: Learned<T>,
    /// Gain of the front wheel's sensor over the rear one's, left and right, less one.
    pub gain: [Learned<T>; 2],
    /// Wheelbase over speed, relative deviation.
    pub wheelbase: Learned<T>,
    /// Time in s by which the rear wheel's sensor is late against the front one's, left and right.
    pub skew_s: [Learned<T>; 2],
    /// Seconds of useful driving it was learned from.
    pub learned_s: T,
}

/// Why a stored reference is implausible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CalibrationError {
    /// A value is not finite, or an sd not positive and finite.
    NotANumber(&'static str),
    /// A value lies further out than any car could be.
    Implausible(&'static str),
    /// It was learned for other corners or other placard pressures.
    OtherCar,
}

impl core::fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotANumber(what) => write!(f, "{what} is not a finite number with a positive sd"),
            Self::Implausible(what) => write!(f, "{what} lies further out than any car could be"),
            Self::OtherCar => write!(f, "it was learned for other corners or other placard pressures"),
        }
    }
}

impl core::error::Error for CalibrationError {}

/// Largest plausible values: relative unsprung mass (and what of it is coupled), damping, spring, anti-roll bar, gain, wheelbase; the spectrum's bias as a share
/// of the placard pressure; skew in s; the shared road's bias. A file of typical values knows a car's unsprung masses to 15 %, its dampers
/// to 30 % and its springs to 25 %: a car three standard deviations off is a car.
const FURTHEST: [f64; 9] = [0.5, 1.0, 1.0, 2.0, 0.1, 0.05, 0.25, 0.02, 0.25];

/// Least anti-roll bar over the springs: a rigid axle whose springs stand at a share `r` of the half track resists roll by `r²` of what they
/// do above the wheels, as with a bar of `r² - 1`, and no car has them further in than half way.
const LEAST_BAR: f64 = -0.75;

impl<T: Real> VehicleCalibration<T> {
    /// What is believed of [`rear_axle_coupling`](Self::rear_axle_coupling) before any calibration has taught it.
    pub fn unknown_coupling() -> Learned<T> {
        Learned { value: T::zero(), sd: T::lit(UNKNOWN_COUPLING_SD) }
    }

    /// Checks every number: finite, with a positive sd, and no further out than a car can be.
    ///
    /// # Errors
    /// The first quantity that fails.
    pub fn check(&self) -> Result<(), CalibrationError> {
        let [mass, damping, spring, bar, gain, wheelbase, bias, skew, road_bias] = FURTHEST.map(T::lit);
        for corner in self.corners.iter().flatten() {
            if !(corner.placard_kpa > T::zero() && corner.placard_kpa.is_finite()) {
                return Err(CalibrationError::NotANumber("placard_kpa"));
            }
            plausible("unsprung_mass", &corner.unsprung_mass, mass)?;
            plausible("damping", &corner.damping, damping)?;
            plausible("spring", &corner.spring, spring)?;
            plausible("spectrum_bias_kpa", &corner.spectrum_bias_kpa, bias * corner.placard_kpa)?;
            plausible("shared_road_bias", &corner.shared_road_bias, road_bias)?;
        }
        for learned in &self.bar {
            plausible("bar", learned, bar)?;
            if learned.value < T::lit(LEAST_BAR) {
                return Err(CalibrationError::Implausible("bar"));
            }
        }
        plausible("rear_axle_coupling", &self.rear_axle_coupling, mass)?;
        self.gain.iter().try_for_each(|learned| plausible("gain", learned, gain))?;
        plausible("wheelbase", &self.wheelbase, wheelbase)?;
        self.skew_s.iter().try_for_each(|learned| plausible("skew_s", learned, skew))?;
        if !(self.learned_s > T::zero() && self.learned_s.is_finite()) {
            return Err(CalibrationError::NotANumber("learned_s"));
        }
        Ok(())
    }
}

fn plausible<T: Real>(what: &'static str, learned: &Learned<T>, furthest: T) -> Result<(), CalibrationError> {
    if !(learned.value.is_finite() && learned.sd > T::zero() && learned.sd.is_finite()) {
        return Err(CalibrationError::NotANumber(what));
    }
    if !(learned.value.abs() <= furthest) {
        return Err(CalibrationError::Implausible(what));
    }
    Ok(())
}
