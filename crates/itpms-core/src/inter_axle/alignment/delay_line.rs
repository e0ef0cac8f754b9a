//! The front wheel's last second, to be read again where the rear wheel is now.

use nalgebra::{SMatrix, SVector};

use crate::inter_axle::alignment::channel::{Entry, KEPT};
use crate::inter_axle::alignment::way::Way;
use crate::memory::Blank;
use crate::real::Real;

/// Entries kept: a second at 250 Hz.
const LENGTH: usize = 256;
const POINTS: usize = 6;

/// A ring of the newest entries.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DelayLine<T: Real> {
    /// Time in s of the newest entry.
    newest_s: f64,
    way: SVector<Way, LENGTH>,
    speed_m_s: SVector<T, LENGTH>,
    signals: SMatrix<T, KEPT, LENGTH>,
    invalid: SVector<bool, LENGTH>,
    unloaded: SVector<bool, LENGTH>,
    /// Place of the newest entry, and how many there are.
    newest: usize,
    filled: usize,
    rate_hz: T,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Read<T> {
    pub(crate) signals: [T; KEPT],
    pub(crate) speed_m_s: T,
    pub(crate) invalid: bool,
    pub(crate) unloaded: bool,
}

impl<T: Real> DelayLine<T> {
    pub(crate) fn configure(&mut self, period_s: f64) {
        self.newest_s = 0.0;
        self.way.fill(Way::BLANK);
        self.speed_m_s.fill(T::zero());
        self.signals.fill(T::zero());
        self.invalid.fill(false);
        self.unloaded.fill(false);
        (self.newest, self.filled, self.rate_hz) = (0, 0, T::lit(1.0 / period_s));
    }

    /// Takes an entry and where it was.
    pub(crate) fn push(&mut self, entry: &Entry<T>, way: Way) {
        if entry.after_gap {
            self.filled = 0;
        }
        self.newest = (self.newest + 1) % LENGTH;
        self.newest_s = entry.time_s;
        self.way[self.newest] = way;
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

    /// Steps from the time at which the front wheel was at a place to the newest entry; `None` if that is too long ago, or not yet.
    pub(crate) fn steps_back_at(&self, way: Way) -> Option<T> {
        if self.filled < POINTS {
            return None;
        }
        let at = |back: usize| self.way[self.place(back)];
        // Ways never fall with time: halve the interval.
        let (mut near, mut far) = (0, self.filled - 1);
        if !at(near).is_beyond(way) || at(far).is_beyond(way) {
            return None;
        }
        while far - near > 1 {
            let middle = usize::midpoint(near, far);
            if at(middle).is_beyond(way) {
                near = middle;
            } else {
                far = middle;
            }
        }
        let share = way.beyond::<T>(at(far)) / at(near).beyond(at(far));
        Some(T::whole(far as u32) - share)
    }

    /// Time in s of the newest entry.
    pub(crate) fn newest_s(&self) -> f64 {
        self.newest_s
    }

    /// Entries a second.
    pub(crate) fn rate_hz(&self) -> T {
        self.rate_hz
    }

    /// Steps from a time to the newest entry.
    pub(crate) fn steps_back(&self, time_s: f64) -> T {
        T::lit(self.newest_s - time_s) * self.rate_hz
    }

    /// The signals so many steps before the newest entry, through six points.
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
