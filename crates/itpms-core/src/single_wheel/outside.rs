//! A stiffness that a source outside the estimator follows by itself.

use crate::memory::Blank;

/// A tire's stiffness as a source of evidence outside the estimator follows it, as on a road that repeats itself: whoever
/// knows better than the frames of a corner gives it to [`Estimator::follow`](crate::Estimator::follow) or
/// [`MonitoredCar::follow`](crate::MonitoredCar::follow).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OutsideStiffness<T> {
    /// Stiffness in N/m, all in all.
    pub stiffness_n_per_m: T,
    /// Its standard deviation in N/m.
    pub stiffness_sd_n_per_m: T,
    /// Its relative change per second.
    pub rate_per_s: T,
    /// Standard deviation in N/m of the same stiffness as a measurement that is independent of the last one with such a deviation;
    /// `None`: not independent.
    pub independent_sd_n_per_m: Option<T>,
    /// Probability that it changes, 0 to 1.
    pub change_probability: T,
    /// Residual power over expected power: about 1 when the source's model holds.
    pub nis: T,
    /// Seconds of full information since the last one.
    pub learned_s: T,
}
