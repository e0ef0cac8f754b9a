//! Conclusion about a corner, kept by its owner until the next one.

use super::reading::Reading;
use crate::memory::Blank;
use crate::model::{CornerEstimate, Diagnostics, Level, Loss, Validity, Warning};
use crate::real::Real;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CornerConclusion<T: Real> {
    pub(super) reading: Reading<T>,
    pub(crate) stiffness_sd_n_per_m: T,
    pub(super) pressure_kpa: T,
    pub(crate) pressure_sd_kpa: T,
    pub(super) change_sd_kpa: T,
    pub(super) level: Level,
    pub(super) validity: Validity,
    pub(crate) axle_difference_sd_kpa: Option<T>,
    pub(crate) loss: Option<Loss<T>>,
}

impl<T: Real> CornerConclusion<T> {
    pub(crate) fn stiffness_n_per_m(&self) -> T {
        self.reading.stiffness_n_per_m
    }

    /// As the estimate of a sample of this time in s.
    pub(crate) fn at(&self, time_s: f64) -> CornerEstimate<T> {
        let reading = &self.reading;
        CornerEstimate {
            time_s,
            stiffness_n_per_m: reading.stiffness_n_per_m,
            stiffness_sd_n_per_m: self.stiffness_sd_n_per_m,
            pressure_kpa: self.pressure_kpa,
            pressure_sd_kpa: self.pressure_sd_kpa,
            change_sd_kpa: self.change_sd_kpa,
            level: self.level,
            axle_difference_sd_kpa: self.axle_difference_sd_kpa,
            loss: self.loss,
            cold: None,
            road_m: T::lit(f64::NAN),
            road_sd_m: T::lit(f64::NAN),
            validity: self.validity,
            warning: Warning::None,
            diagnostics: Diagnostics {
                forgetting: reading.forgetting,
                nis: reading.nis,
                gate: reading.gate,
                change_probability: reading.change_probability,
                pressure_variance_kpa2: self.change_sd_kpa * self.change_sd_kpa,
            },
        }
    }
}
