//! The tire's stiffness as the whole car knows it, with which a corner's estimator concludes: made by
//! [`CarEstimator`](crate::car::CarEstimator) of the fused belief.

use crate::model::Level;

/// Information about a corner from the whole car.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FusedStiffness<T> {
    pub(crate) stiffness_n_per_m: T,
    /// Its standard deviation as far as the signals tell, and what the vehicle file leaves open.
    pub(crate) stiffness_sd_n_per_m: T,
    pub(crate) considered_sd_n_per_m: T,
    pub(crate) level: Level,
    pub(crate) changing: T,
    /// Seconds of full information that it rests on.
    pub(crate) learned_s: T,
    /// Whether the road that its axles share is being learned from.
    pub(crate) learning: bool,
    /// Whether anything is received at all: frames, or pseudo-measurements of the corner's spectrum.
    pub(crate) has_signal: bool,
}
