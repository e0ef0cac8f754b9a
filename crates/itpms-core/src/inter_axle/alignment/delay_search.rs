//! The delay: where the front's road, shifted, looks most like the rear's. Needed first, and where the two are no longer alike,
//! because the constraint is only linear in small errors of the delay.

use nalgebra::SVector;

use crate::memory::Blank;
use crate::real::Real;

pub(crate) const SHIFTS: usize = 25;
/// How far at first, in each direction, as a share of the delay: what a vehicle file and a speed are off. And later on: another
/// source of the speed, or other wheels.
pub(crate) const AT_FIRST: f64 = 0.03;
pub(crate) const LATER: f64 = 0.12;
/// And that many seconds more.
const SECONDS: f64 = 0.005;
const LOOK_S: f64 = 1.5;
/// Correlation that has to be reached.
const ENOUGH: f64 = 0.6;
/// Seconds after which a search without success starts again, and the shared road is given up until it is found.
pub(crate) const GIVE_UP_S: f64 = 6.0;

/// Running sums of the search on one side.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DelaySearch<T: Real> {
    /// How far it looks, as a share of the delay.
    reach: f64,
    cross: SVector<T, SHIFTS>,
    front: SVector<T, SHIFTS>,
    rear: SVector<T, SHIFTS>,
    seconds: f64,
    delay_sum_s: T,
    stretch_sum: T,
    count: T,
    /// Wheelbase and skew that were believed when the search began, which its shifts are counted from.
    used: Option<[T; 2]>,
}

/// A delay that was found: seconds more than expected with this wheelbase and skew, at a mean expected delay and a mean logarithm of
/// the rear's speed over the front's.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Found<T> {
    pub(crate) later_s: T,
    pub(crate) delay_s: T,
    pub(crate) stretch: T,
    pub(crate) used: [T; 2],
}

impl<T: Real> DelaySearch<T> {
    pub(crate) fn new(reach: f64) -> Self {
        Self { reach, ..Self::BLANK }
    }

    pub(crate) fn restart(&mut self) {
        if self.used.is_some() {
            *self = Self::new(self.reach);
        }
    }

    /// Wheelbase and skew to look with: those `believed` as the search begins, to its end. What the other side finds
    /// meanwhile is no part of this side's shifts.
    pub(crate) fn count_from(&mut self, believed: [T; 2]) -> [T; 2] {
        *self.used.get_or_insert(believed)
    }

    /// Takes the rear's road, the delay and stretch expected of it, and for every shift the front's road; the shift in s is given by [`Self::shift_s`].
    pub(crate) fn push(
        &mut self,
        rear: T,
        [delay_s, stretch]: [T; 2],
        period_s: f64,
        front: impl Fn(T) -> Option<T>,
    ) -> Option<Found<T>> {
        let (first_s, step_s) =
            (self.shift_s(0, delay_s), self.shift_s(1, delay_s) - self.shift_s(0, delay_s));
        for i in 0..SHIFTS {
            if let Some(front) = front(first_s + step_s * T::whole(i as u32)) {
                self.cross[i] += front * rear;
                self.front[i] += front * front;
                self.rear[i] += rear * rear;
            }
        }
        self.seconds += period_s;
        self.delay_sum_s += delay_s;
        self.stretch_sum += stretch;
        self.count += T::one();
        if self.seconds < LOOK_S {
            return None;
        }
        let found = self.peak();
        if found.is_some() || self.seconds > GIVE_UP_S {
            self.restart();
        }
        found
    }

    fn peak(&self) -> Option<Found<T>> {
        let height = SVector::<T, SHIFTS>::from_fn(|i, _| {
            self.cross[i] / (self.front[i] * self.rear[i]).sqrt().max(T::lit(1e-30))
        });
        let at = height.imax();
        // At the edge the true maximum may lie outside.
        if at == 0 || at >= SHIFTS - 1 || !(height[at] > T::lit(ENOUGH)) {
            return None;
        }
        let (before, here, after) = (height[at - 1], height[at], height[at + 1]);
        let bend = before - T::lit(2.0) * here + after;
        let off = if bend < T::zero() { T::lit(0.5) * (before - after) / bend } else { T::zero() };
        let delay_s = self.delay_sum_s / self.count;
        let step_s = self.shift_s(1, delay_s) - self.shift_s(0, delay_s);
        let stretch = self.stretch_sum / self.count;
        Some(Found { later_s: self.shift_s(at, delay_s) + off * step_s, delay_s, stretch, used: self.used? })
    }

    /// Seconds of the `i`-th shift.
    fn shift_s(&self, i: usize, delay_s: T) -> T {
        let reach = T::lit(self.reach) * delay_s + T::lit(SECONDS);
        reach * (T::lit(2.0 / (SHIFTS - 1) as f64) * T::whole(i as u32) - T::one())
    }
}
