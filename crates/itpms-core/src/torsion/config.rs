//! Configuration of a wheel's torsional analysis.

use super::teeth::MOST_TEETH;
use crate::memory::Blank;
use crate::model::{ParameterError, positive};
use crate::real::Real;

/// A wheel's sensor and tire.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorsionConfig<T> {
    /// Teeth of the sensor's ring, 20 to 96.
    pub teeth: u32,
    /// Rolling radius in m.
    pub rolling_radius_m: T,
    /// Resonance at 20 m/s in Hz, as far as it is known before a calibration: to 5 Hz.
    pub resonance_hz: T,
    /// By how many Hz it rises per kPa.
    pub resonance_per_kpa: T,
}

impl<T: Real> TorsionConfig<T> {
    /// A passenger car's wheel nothing is known of: 48 teeth, 49.5 Hz, .052 Hz per kPa.
    #[must_use]
    pub fn new() -> Self {
        Self {
            teeth: 48,
            rolling_radius_m: T::lit(0.31),
            resonance_hz: T::lit(49.5),
            resonance_per_kpa: T::lit(0.052),
        }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        if !(20..=MOST_TEETH as u32).contains(&self.teeth) {
            let value = f64::from(self.teeth);
            return Err(ParameterError { name: "teeth", value, expected: "a number from 20 to 96" });
        }
        positive("rolling_radius_m", self.rolling_radius_m)?;
        positive("resonance_hz", self.resonance_hz)?;
        positive("resonance_per_kpa", self.resonance_per_kpa)?;
        Ok(())
    }
}

impl<T: Real> Default for TorsionConfig<T> {
    fn default() -> Self {
        Self::new()
    }
}
