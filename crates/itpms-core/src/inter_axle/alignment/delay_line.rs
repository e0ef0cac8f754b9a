//! What the front wheel met during the last second, to be read again where the rear wheel is now.

use nalgebra::{SMatrix, SVector};

use crate::inter_axle::alignment::channel::{Entry, KEPT};
use crate::memory::blank;
use crate::real::Real;

/// Entries kept: a second at 250 Hz.
const LENGTH: usize = 256;
/// Ways are kept modulo this many m, far more than a car drives in the second that is kept.
const LAP_M: f64 = 256.0;
/// Points of the interpolation.
const POINTS: usize = 6;

/// A ring of the newest entries.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DelayLine<T: Real> {
    /// Time in s of the newest entry, and from one to the next.
    newest_s: f64,
    period_s: f64,
    /// Ways in m, modulo [`LAP_M`]: single precision tells a hundredth of a millimeter then, however far the car has come.
    way_m: SVector<T, LENGTH>,
    speed_m_s: SVector<T, LENGTH>,
    signals: SMatrix<T, KEPT, LENGTH>,
    invalid: SVector<bool, LENGTH>,
    unloaded: SVector<bool, LENGTH>,
    /// Place of the newest entry, and how many there are.
    newest: usize,
    filled: usize,
    /// Entries in a second.
    rate_hz: T,
}

blank!(DelayLine<T> { newest_s, period_s, way_m, speed_m_s, signals, invalid, unloaded, newest, filled, rate_hz });

/// What was read back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Read<T> {
    pub(crate) signals: [T; KEPT],
    pub(crate) speed_m_s: T,
    pub(crate) invalid: bool,
    pub(crate) unloaded: bool,
}

impl<T: Real> DelayLine<T> {
    pub(crate) fn configure(&mut self, period_s: f64) {
        (self.newest_s, self.period_s) = (0.0, period_s);
        self.way_m.fill(T::zero());
        self.speed_m_s.fill(T::zero());
        self.signals.fill(T::zero());
        self.invalid.fill(false);
        self.unloaded.fill(false);
        (self.newest, self.filled, self.rate_hz) = (0, 0, T::lit(1.0 / period_s));
    }

    pub(crate) fn push(&mut self, entry: &Entry<T>) {
        if entry.after_gap {
            self.filled = 0;
        }
        self.newest = (self.newest + 1) % LENGTH;
        self.newest_s = entry.time_s;
        self.way_m[self.newest] = within_lap(entry.distance_m);
        self.speed_m_s[self.newest] = entry.speed_m_s;
        self.signals.set_column(self.newest, &SVector::from(entry.signals));
        self.invalid[self.newest] = entry.invalid;
        self.unloaded[self.newest] = entry.unloaded;
        self.filled = (self.filled + 1).min(LENGTH);
    }

    pub(crate) fn clear(&mut self) {
        self.filled = 0;
    }

    /// Where the entry `back` steps before the newest is kept.
    fn place(&self, back: usize) -> usize {
        (self.newest + LENGTH - back % LENGTH) % LENGTH
    }

    /// How far the front wheel came beyond a place within the lap by the entry in `place`, in m.
    fn beyond_m(&self, place: usize, way_m: T) -> T {
        let (beyond, lap) = (self.way_m[place] - way_m, T::lit(LAP_M));
        let half = T::lit(0.5 * LAP_M);
        if beyond > half {
            beyond - lap
        } else if beyond < -half {
            beyond + lap
        } else {
            beyond
        }
    }

    /// The time at which the front wheel was at `distance_m`; `None` if that is too long ago, or not yet.
    pub(crate) fn time_at(&self, distance_m: f64) -> Option<f64> {
        if self.filled < POINTS {
            return None;
        }
        let way_m = within_lap(distance_m);
        let is_beyond = |back: usize| self.beyond_m(self.place(back), way_m) > T::zero();
        // Ways never fall with time: halve the interval.
        let (mut near, mut far) = (0, self.filled - 1);
        if !(is_beyond(near) && self.beyond_m(self.place(far), way_m) <= T::zero()) {
            return None;
        }
        while far - near > 1 {
            let middle = usize::midpoint(near, far);
            if is_beyond(middle) {
                near = middle;
            } else {
                far = middle;
            }
        }
        let [before, after] = [far, near].map(|back| self.beyond_m(self.place(back), way_m));
        let share = -before / (after - before);
        Some(self.newest_s - (far as f64 - share.to_f64()) * self.period_s)
    }

    /// The signals at a time, through six points.
    pub(crate) fn read(&self, time_s: f64) -> Option<Read<T>> {
        self.read_back(self.steps_back(time_s))
    }

    /// Steps from a time to the newest entry.
    pub(crate) fn steps_back(&self, time_s: f64) -> T {
        T::lit(self.newest_s - time_s) * self.rate_hz
    }

    /// The signals so many steps before the newest entry.
    pub(crate) fn read_back(&self, steps: T) -> Option<Read<T>> {
        if !(steps >= T::lit(2.0) && steps < T::whole(self.filled as u32) - T::lit(3.0)) {
            return None;
        }
        let back = steps.to_whole().unsigned_abs();
        // From the entry just after the time: two on its young side, three on its old one.
        let (offset, back) = (steps - T::whole(back), back as usize);
        let (mut signals, mut invalid) = ([T::zero(); KEPT], false);
        for (i, &weight) in lagrange(offset).iter().enumerate() {
            let place = self.place(back + i - 2);
            invalid |= self.invalid[place];
            for (signal, &value) in signals.iter_mut().zip(&self.signals.column(place)) {
                *signal += weight * value;
            }
        }
        // The points further off have little weight.
        let unloaded = [back, back + 1].map(|back| self.unloaded[self.place(back)]).contains(&true);
        Some(Read { signals, speed_m_s: self.speed_m_s[self.place(back)], invalid, unloaded })
    }
}

/// A way in m modulo [`LAP_M`].
fn within_lap<T: Real>(distance_m: f64) -> T {
    // Without a division, which is long in double precision.
    T::lit(distance_m - LAP_M * f64::from((distance_m * (1.0 / LAP_M)) as i32))
}

/// Weights of the polynomial through the points -2 to 3 at `x` in `[0, 1)`.
fn lagrange<T: Real>(x: T) -> [T; POINTS] {
    core::array::from_fn(|i| {
        let here = i as f64 - 2.0;
        let mut weight = T::one();
        for j in 0..POINTS {
            if j != i {
                let there = j as f64 - 2.0;
                weight *= (x - T::lit(there)) / T::lit(here - there);
            }
        }
        weight
    })
}
