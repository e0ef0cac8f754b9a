//! A wheel's turning from edge to edge, as steps of a fixed length without what is slow (`docs/math/wheel-speed.md`, eq. 14).

use super::STEP_S;
use crate::memory::Blank;
use crate::real::Real;

/// `e^(-2 pi 4 Hz 1 ms)`: what of the slow part a step keeps.
const KEPT: f64 = 0.975_180;

#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Speed<T> {
    /// End of the step under way, and what it has turned by over the step's length.
    until_s: f64,
    turned: T,
    running: bool,
    /// The slow part of the rate, and of the remainder.
    slow: [T; 2],
}

impl<T: Real> Speed<T> {
    pub(super) fn restart(&mut self) {
        self.running = false;
    }

    /// A rate in rad/s from one edge to the next; gives each whole step's, without what changes slowly.
    pub(super) fn push(&mut self, from_s: f64, to_s: f64, rate_rad_s: T, mut take: impl FnMut(T)) {
        if !self.running {
            *self = Self {
                until_s: from_s + STEP_S,
                turned: T::zero(),
                running: true,
                slow: [rate_rad_s, T::zero()],
            };
        }
        let mut from_s = from_s;
        let per_step = T::lit(1.0 / STEP_S);
        while self.until_s <= to_s {
            let rate = self.turned + rate_rad_s * T::lit(self.until_s - from_s) * per_step;
            take(self.without_slow(rate));
            from_s = self.until_s;
            self.until_s += STEP_S;
            self.turned = T::zero();
        }
        self.turned += rate_rad_s * T::lit(to_s - from_s) * per_step;
    }

    fn without_slow(&mut self, rate: T) -> T {
        let mut left = rate;
        for slow in &mut self.slow {
            *slow += T::lit(1.0 - KEPT) * (left - *slow);
            left -= *slow;
        }
        left
    }
}
