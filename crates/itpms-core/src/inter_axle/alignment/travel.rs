//! Distance travelled and speed, on the samples' clock.

use super::axle_pair::SLOWEST_M_S;
use crate::memory::blank;
use crate::real::Real;

/// Time in s over which the speed is averaged.
const SPEED_S: f64 = 1.5;
/// Longest time in s between two samples over which the distance is counted.
const LONGEST_STEP_S: f64 = 0.5;

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Travel<T> {
    time_s: f64,
    distance_m: f64,
    speed_m_s: T,
    mean_speed_m_s: T,
    /// Seconds driven since a shared road was last learned from; all of them while the speed is unknown.
    unshared_s: f64,
}

blank!(Travel<T> { time_s, distance_m, speed_m_s, mean_speed_m_s, unshared_s });

impl<T: Real> Travel<T> {
    pub(crate) fn new() -> Self {
        Self {
            time_s: f64::NAN,
            distance_m: 0.0,
            speed_m_s: T::lit(f64::NAN),
            mean_speed_m_s: T::zero(),
            unshared_s: 0.0,
        }
    }

    /// Takes a sample's time and speed; NaN: the speed is unknown.
    pub(crate) fn drive(&mut self, time_s: f64, speed_m_s: T) {
        let seconds = time_s - self.time_s;
        let follows = seconds > 0.0 && seconds < LONGEST_STEP_S;
        if follows && self.speed_m_s.is_finite() {
            let mean = if speed_m_s.is_finite() {
                T::lit(0.5) * (speed_m_s + self.speed_m_s)
            } else {
                self.speed_m_s
            };
            self.distance_m += mean.to_f64() * seconds;
            let share = (T::lit(seconds) * T::lit(1.0 / SPEED_S)).min(T::one());
            self.mean_speed_m_s += (mean - self.mean_speed_m_s) * share;
            if mean > T::lit(SLOWEST_M_S) {
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

    /// Distance in m so many seconds before a time near the last sample's; NaN while the speed is unknown.
    pub(crate) fn distance_before_m(&self, time_s: f64, before_s: f64) -> f64 {
        if self.speed_m_s.is_finite() {
            self.distance_m - self.speed_m_s.to_f64() * (self.time_s - time_s + before_s)
        } else {
            f64::NAN
        }
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
    pub(crate) fn unshared_s(&self) -> f64 {
        self.unshared_s
    }

    pub(crate) fn restart_unshared(&mut self) {
        self.unshared_s = 0.0;
    }
}
