//! From when on the losses of this drive are counted: once tires are known and nothing moves, and anew after whatever may have changed them
//! (docs/math/level-and-loss.md).

use crate::memory::blank;

/// Seconds of shared road after which a tire's level is what it will be but for what is constant, and so cancels in a loss; after a
/// calibration, in which all tires were known, at once.
const SETTLING_S: f64 = 25.0;
const CALIBRATED_SETTLING_S: f64 = 1.0;

/// See the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Losses {
    /// Since when, in s, if they are.
    since_s: Option<f64>,
    /// Seconds of shared road that have to be learned from before.
    settled_at_s: f64,
}

blank!(Losses { since_s, settled_at_s });

impl Losses {
    /// Not yet.
    pub(super) fn none() -> Self {
        Self { since_s: None, settled_at_s: SETTLING_S }
    }

    /// Tires may have changed: their levels have to be found anew. `learned_s`: seconds of shared road so far.
    pub(super) fn end(&mut self, learned_s: f64) {
        *self = Self { since_s: None, settled_at_s: learned_s + SETTLING_S };
    }

    /// A calibration has just ended. `learned_s`: seconds of shared road so far.
    pub(super) fn settle_soon(&mut self, learned_s: f64) {
        self.settled_at_s = learned_s + CALIBRATED_SETTLING_S;
    }

    pub(super) fn begin(&mut self, time_s: f64) {
        self.since_s = Some(time_s);
    }

    /// Whether they are to be counted from now on.
    pub(super) fn have_settled(&self, learned_s: f64) -> bool {
        self.since_s.is_none() && learned_s >= self.settled_at_s
    }

    /// Since when they are counted, in s.
    pub(super) fn since_s(&self) -> Option<f64> {
        self.since_s
    }
}
