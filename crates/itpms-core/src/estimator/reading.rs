//! A corner's reading after a step, and whether it is valid.

use super::fused_stiffness::FusedStiffness;
use crate::conditioning::pauses::ENOUGH_S;
use crate::memory::Blank;
use crate::model::{CornerConfig, Validity};
use crate::real::Real;
use crate::single_wheel::Belief;

/// Standard deviation, as a share of the placard pressure, beyond which an estimate says nothing.
const WORTHLESS: f64 = 0.25;

/// Stiffness of a tire and how it came about.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reading<T> {
    pub(super) stiffness_n_per_m: T,
    pub(super) stiffness_sd_n_per_m: T,
    pub(super) validity: Validity,
    pub(super) forgetting: T,
    pub(super) nis: T,
    pub(super) gate: T,
    pub(super) change_probability: T,
}

impl<T: Real> Reading<T> {
    /// By the Bayes filter's belief.
    pub(super) fn of(config: &CornerConfig<T>, belief: &Belief<T>) -> Self {
        Self {
            stiffness_n_per_m: config.tire.stiffness_n_per_m(belief.pressure_kpa),
            stiffness_sd_n_per_m: belief.pressure_sd_kpa * config.tire.stiffness_per_kpa(),
            validity: match validity(config, belief.learned_s, belief.pressure_sd_kpa) {
                Validity::Valid if !belief.is_in_range => Validity::NoInformation,
                validity => validity,
            },
            forgetting: belief.variance_growth,
            nis: belief.nis,
            gate: belief.gate,
            change_probability: belief.moving,
        }
    }

    /// Puts the whole car's estimate in place of the corner's own reading.
    pub(super) fn fuse(&mut self, config: &CornerConfig<T>, fused: &FusedStiffness<T>) {
        self.stiffness_n_per_m = fused.stiffness_n_per_m;
        self.stiffness_sd_n_per_m = fused.stiffness_sd_n_per_m;
        self.change_probability = fused.changing;
        if !fused.has_signal {
            self.gate = T::zero();
        } else if fused.learning {
            self.gate = T::one();
        }
        let sd_kpa = fused.stiffness_sd_n_per_m / config.tire.stiffness_per_kpa();
        self.validity = validity(config, fused.learned_s, sd_kpa);
    }
}

/// Whether a stiffness of this sd may be believed, given how much was learned.
fn validity<T: Real>(config: &CornerConfig<T>, learned_s: T, pressure_sd_kpa: T) -> Validity {
    if !(learned_s >= T::lit(ENOUGH_S)) {
        Validity::Starting
    } else if !is_known(config, pressure_sd_kpa) {
        Validity::NoInformation
    } else {
        Validity::Valid
    }
}

pub(super) fn is_known<T: Real>(config: &CornerConfig<T>, pressure_sd_kpa: T) -> bool {
    pressure_sd_kpa <= T::lit(WORTHLESS) * config.placard_kpa
}
