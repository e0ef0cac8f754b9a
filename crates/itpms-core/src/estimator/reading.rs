//! What every method tells after a step, and whether that may be believed.

use crate::memory::blank;
use crate::model::{CornerConfig, Validity};
use crate::real::Real;

/// Seconds of full information before an estimate counts.
pub(super) const STARTING_S: f64 = 2.0;
/// Standard deviation, as a share of the placard pressure, beyond which an estimate says nothing.
const WORTHLESS: f64 = 0.25;

/// What every estimator can say after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reading<T> {
    pub(super) stiffness_n_per_m: T,
    pub(super) stiffness_sd_n_per_m: T,
    pub(super) road_m: T,
    pub(super) road_sd_m: T,
    pub(super) validity: Validity,
    pub(super) forgetting: T,
    pub(super) nis: T,
    pub(super) gate: T,
    pub(super) change_probability: T,
}

blank!(Reading<T> {
    stiffness_n_per_m, stiffness_sd_n_per_m, road_m, road_sd_m, validity, forgetting, nis, gate,
    change_probability,
});

/// Whether a stiffness of this sd may be believed, given how much was learned.
pub(super) fn validity<T: Real>(config: &CornerConfig<T>, learned_s: T, pressure_sd_kpa: T) -> Validity {
    if !(learned_s >= T::lit(STARTING_S)) {
        Validity::Starting
    } else if !is_known(config, pressure_sd_kpa) {
        Validity::NoInformation
    } else {
        Validity::Valid
    }
}

/// Whether a pressure of this sd says anything.
pub(super) fn is_known<T: Real>(config: &CornerConfig<T>, pressure_sd_kpa: T) -> bool {
    pressure_sd_kpa <= T::lit(WORTHLESS) * config.placard_kpa
}
