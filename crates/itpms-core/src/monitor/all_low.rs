//! All wheels together: a slow loss of all four is more certain in their mean than in any one of them.

use super::alert::Cause;
use super::config::Limits;
use super::latch::{Evidence, Latch, Patience};
use super::wheel::is_learning;
use crate::car::CarEstimate;
use crate::real::Real;

/// One-sided 95 % quantile of a normal distribution.
const CERTAIN: f64 = 1.64;
/// No wheel may be above this share: else it is not all of them.
const NONE_ABOVE: f64 = 0.95;
/// The mean is fine again this much above its limit.
const FINE_ABOVE: f64 = 0.03;
/// Minutes, not seconds: the level of all four is what an estimator is most easily wrong in, and nobody loses four tires at
/// once.
const ALL_LOW: Patience = Patience { raise_s: 150.0, clear_s: 20.0 };

/// Remembers since when all wheels are low.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct AllLow<T> {
    latch: Latch,
    mean_share: T,
    sd_share: T,
}

impl<T: Real> AllLow<T> {
    pub(super) fn new() -> Self {
        Self { latch: Latch::new(), mean_share: T::one(), sd_share: T::zero() }
    }

    pub(super) fn latch(&self) -> &Latch {
        &self.latch
    }

    /// Why it is said, while it is.
    pub(super) fn cause(&self) -> Option<Cause<T>> {
        let (mean_share, sd_share) = (self.mean_share, self.sd_share);
        self.latch.is_said().then_some(Cause::AllLow { mean_share, sd_share })
    }

    /// Takes what was estimated over the last `step_s` seconds. Needs all four wheels and something learned of each.
    pub(super) fn update(
        &mut self,
        step_s: f64,
        estimate: &CarEstimate<T>,
        reference_kpa: [T; 4],
        limits: &Limits<T>,
    ) {
        let Some((mean, sd, highest)) = shares(estimate, reference_kpa) else { return };
        (self.mean_share, self.sd_share) = (mean, sd);
        let low = mean + T::lit(CERTAIN) * sd < limits.all_low_share;
        let evidence = if low && highest < T::lit(NONE_ABOVE) {
            Evidence::For
        } else if mean > limits.all_low_share + T::lit(FINE_ABOVE) {
            Evidence::Against
        } else {
            Evidence::Neither
        };
        self.latch.update(estimate.time_s, step_s, evidence, ALL_LOW);
    }
}

/// Mean of pressure over reference, its sd with the errors' correlations, and the highest.
fn shares<T: Real>(estimate: &CarEstimate<T>, reference_kpa: [T; 4]) -> Option<(T, T, T)> {
    let mut share = [T::zero(); 4];
    let mut sd = [T::zero(); 4];
    for (i, corner) in estimate.corners.iter().enumerate() {
        let corner = corner.as_ref().filter(|corner| is_learning(corner))?;
        share[i] = corner.pressure_kpa / reference_kpa[i];
        sd[i] = corner.pressure_sd_kpa / reference_kpa[i];
    }
    let quarter = T::lit(0.25);
    let mut variance = T::zero();
    for (i, row) in estimate.correlation.iter().enumerate() {
        for (j, correlation) in row.iter().enumerate() {
            variance += *correlation * sd[i] * sd[j];
        }
    }
    let mean = quarter * share.iter().fold(T::zero(), |sum, share| sum + *share);
    let highest = share.iter().fold(share[0], |highest, share| highest.max(*share));
    Some((mean, quarter * variance.max(T::zero()).sqrt(), highest))
}
