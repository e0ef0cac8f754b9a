//! Whether each wheel's sensor still moves. One that repeats its last value, or zero, would make of every change of speed a change of radius.

use super::block::LEAST_SPEED_M_S;
use super::sample::WheelSpeedSample;
use crate::conditioning::pauses::PAUSE_S;
use crate::memory::Blank;
use crate::model::{Corner, Wheels};
use crate::real::Real;

/// Samples with a change at two other wheels in which a sensor that moves does so, too.
const OTHERS_CHANGED: u8 = 12;
/// By how many of the smallest steps seen the others have to have moved: of coarse speeds, one may stay while others go two steps.
const STEPS: f64 = 3.0;

/// See the [module](self).
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SensorWatch<T> {
    last: [T; 4],
    /// Since a wheel last changed: the mean of the others then, samples in which two of them changed, and how long these took in s.
    others: [T; 4],
    changed: [u8; 4],
    for_s: [T; 4],
    /// Smallest change of a sample seen, in m/s; zero before the first.
    step: T,
    stuck: Wheels,
}

impl<T: Real> SensorWatch<T> {
    /// Takes a sample that is complete, so many s after the last one.
    pub(super) fn take(&mut self, sample: &WheelSpeedSample<T>, step_s: T) {
        let now = sample.wheel_speed_m_s;
        let moved: [T; 4] = core::array::from_fn(|i| (now[i] - self.last[i]).abs());
        self.last = now;
        let smallest = moved.into_iter().filter(|moved| *moved > T::zero()).reduce(T::at_most);
        if let Some(smallest) = smallest.filter(|smallest| !(self.step > T::zero() && self.step < *smallest))
        {
            self.step = smallest;
        }
        let number = moved.iter().filter(|moved| **moved > T::zero()).count();
        let mut stuck = Wheels::NONE;
        for (corner, moved) in Corner::ALL.into_iter().zip(moved) {
            let (i, others) = (corner.index(), others(&now, corner.index()));
            if moved > T::zero() {
                (self.others[i], self.changed[i], self.for_s[i]) = (others, 0, T::zero());
                continue;
            }
            if number >= 2 && others > T::lit(LEAST_SPEED_M_S) {
                self.changed[i] = self.changed[i].saturating_add(1);
                self.for_s[i] += step_s;
            }
            let is_stuck = self.changed[i] >= OTHERS_CHANGED
                && self.for_s[i] >= T::lit(PAUSE_S)
                && (others - self.others[i]).abs() >= T::lit(STEPS) * self.step;
            if is_stuck || self.stuck.contains(corner) {
                stuck = stuck | corner.into();
            }
        }
        self.stuck = stuck;
    }

    /// The smallest step of the speeds in m/s: what they are sent in, or less than anything by which they differ.
    pub(super) fn step_m_s(&self) -> T {
        self.step
    }

    /// The wheels whose sensors have not moved since others did.
    pub(super) fn stuck(&self) -> Wheels {
        self.stuck
    }
}

/// Mean of the other wheels' speeds.
fn others<T: Real>(speeds: &[T; 4], wheel: usize) -> T {
    let [fl, fr, rl, rr] = *speeds;
    (fl + fr + rl + rr - speeds[wheel]) * T::lit(1.0 / 3.0)
}
