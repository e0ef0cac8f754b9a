//! How far the car has come and how fast it is, on the samples' clock.

use super::way::Way;
use crate::conditioning::STANDING_M_S;
use crate::conditioning::pauses::MISSING_S;
use crate::memory::Blank;
use crate::real::Real;

/// Time in s over which the speed is averaged.
const SPEED_S: f64 = 1.5;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Travel<T> {
    time_s: f64,
    way: Way,
    speed_m_s: T,
    mean_speed_m_s: T,
    /// Seconds driven since a shared road was last learned from; all of them while the speed is unknown.
    unshared_s: T,
}

impl<T: Real> Travel<T> {
    pub(crate) fn new() -> Self {
        Self { time_s: f64::NAN, speed_m_s: T::lit(f64::NAN), ..Self::BLANK }
    }

    /// Takes a sample's time and speed; NaN: the speed is unknown.
    pub(crate) fn drive(&mut self, time_s: f64, speed_m_s: T) {
        let seconds = T::lit(time_s - self.time_s);
        let follows = seconds > T::zero() && seconds < T::lit(MISSING_S);
        if follows && self.speed_m_s.is_finite() {
            let mean = if speed_m_s.is_finite() {
                T::lit(0.5) * (speed_m_s + self.speed_m_s)
            } else {
                self.speed_m_s
            };
            self.way = self.way.ahead(mean * seconds);
            let share = (seconds * T::lit(1.0 / SPEED_S)).min(T::one());
            self.mean_speed_m_s += (mean - self.mean_speed_m_s) * share;
            if mean > T::lit(STANDING_M_S) {
                self.unshared_s += seconds;
            }
        } else if follows {
            self.unshared_s += seconds;
        }
        if time_s.is_finite() {
            self.time_s = time_s;
        }
        self.speed_m_s = speed_m_s;
    }

    /// Where the car was so many seconds before a time near the last sample's; `None` while the speed is unknown.
    pub(crate) fn way_before(&self, time_s: f64, before_s: T) -> Option<Way> {
        let back_m = self.speed_m_s * (T::lit(self.time_s - time_s) + before_s);
        back_m.is_finite().then(|| self.way.ahead(-back_m))
    }

    /// Time in s of the last sample.
    pub(crate) fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Speed in m/s; NaN: unknown.
    pub(crate) fn speed_m_s(&self) -> T {
        self.speed_m_s
    }

    /// The same, averaged over [`SPEED_S`].
    pub(crate) fn mean_speed_m_s(&self) -> T {
        self.mean_speed_m_s
    }

    /// Seconds driven since a shared road was last learned from.
    pub(crate) fn unshared_s(&self) -> T {
        self.unshared_s
    }

    pub(crate) fn restart_unshared(&mut self) {
        self.unshared_s = T::zero();
    }
}
