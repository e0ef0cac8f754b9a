//! Whether each wheel's sensor still sends, and moves. One that repeats its last value, or zero, would make of every change of speed a change of
//! radius; without one of four nothing is compared.

use super::block::{BLOCK_S, Block};
use super::sample::is_speed;
use crate::conditioning::pauses::PAUSE_S;
use crate::memory::Blank;
use crate::model::{Corner, WheelSpeedSample, Wheels};
use crate::real::Real;
use crate::wheel_speed::Tuning;
use crate::wheel_speed::state::{AXLE, SCALE};

/// Samples with a change at two other wheels in which a sensor that moves does so, too.
const OTHERS_CHANGED: u8 = 12;
/// By how many of the smallest steps seen the others have to have moved: of coarse speeds, one may stay while others go two steps.
const STEPS: f64 = 3.0;

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
    /// How long each wheel has had no speed while two others had one, in s.
    missing_s: [T; 4],
    /// For how long the ratio of each axle has been one of no radii, in s, and the mean of it and of the ratio between the axles then.
    absurd_s: [T; 2],
    absurd: [[T; 2]; 2],
}

impl<T: Real> SensorWatch<T> {
    /// Takes a sample that is complete, so many s after the last one.
    pub(super) fn take(&mut self, sample: &WheelSpeedSample<T>, step_s: T, tuning: &Tuning) {
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
            if number >= 2 && others > T::lit(tuning.least_speed_m_s) {
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

    /// Notes which wheels have a speed, so many s after the last sample.
    pub(super) fn note_missing(&mut self, sample: &WheelSpeedSample<T>, step_s: T) {
        let sends = sample.wheel_speed_m_s.map(is_speed);
        let sending = sends.iter().filter(|sends| **sends).count();
        for (missing_s, sends) in self.missing_s.iter_mut().zip(sends) {
            *missing_s = match sends {
                true => T::zero(),
                // That all are missing is no sensor's fault.
                false if sending < 2 => *missing_s,
                false => (*missing_s + step_s).at_most(T::lit(2.0 * PAUSE_S)),
            };
        }
    }

    /// The wheels that have had no speed for a second while others had one.
    pub(super) fn missing(&self) -> Wheels {
        let missing = |corner: &Corner| self.missing_s[corner.index()] >= T::lit(PAUSE_S);
        Corner::ALL.into_iter().filter(missing).collect()
    }

    /// Takes a block that was driven well.
    pub(super) fn take_block(&mut self, block: &Block<T>, tuning: &Tuning) {
        let [_, passes_s, _] = tuning.sure_for_s;
        for (i, (absurd_s, mean)) in self.absurd_s.iter_mut().zip(&mut self.absurd).enumerate() {
            let now = [block.ratio[i], block.ratio[AXLE]];
            // A bend does the same to both axles.
            let other = T::lit(2.0) * block.ratio[1 - i].abs();
            if !(now[0].abs() < T::lit(tuning.absurd_ratio).at_least(other)) {
                *absurd_s = (*absurd_s + T::lit(BLOCK_S)).at_most(T::lit(passes_s + 2.0));
                for (mean, now) in mean.iter_mut().zip(now) {
                    *mean += (now - *mean) * T::lit(BLOCK_S) / *absurd_s;
                }
            } else {
                *absurd_s = (*absurd_s - T::lit(2.0 * BLOCK_S)).at_least(T::zero());
            }
        }
    }

    /// The wheel whose speed is none of a tire that rolls beside the others, and how many times theirs it is.
    pub(super) fn odd(&self, tuning: &Tuning) -> Option<(Corner, T)> {
        let [_, passes_s, _] = tuning.sure_for_s;
        let axle = self.absurd_s.iter().position(|s| *s >= T::lit(passes_s))?;
        let [ratio, between] = *self.absurd.get(axle)?;
        // The wheel that has it in the ratio of its axle has half of it between the axles.
        let front = if axle == 0 { between } else { -between };
        let left = (ratio > T::zero()) == (front > T::zero());
        let corner = *Corner::ALL.get(2 * axle + usize::from(!left))?;
        let ln = T::lit(1.0 / SCALE) * if left { ratio } else { -ratio };
        Some((corner, ln.exp_fast()))
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
