//! The true times of samples that came evenly, under a clock that counts in steps longer than their period.
//!
//! Each time is the mean of the stamps around it: over a symmetric stretch of even samples that is the value of the straight line of
//! least squares, and what the steps took off averages out over some dozens of them. At either end of a stretch the line goes on.

use std::collections::VecDeque;

use super::Stamped;

/// Half the length over which stamps are averaged, in s, and at least in steps of the clock.
const HALF_S: f64 = 0.5;
const HALF_STEPS: f64 = 8.0;
const FEWEST_HALF: usize = 16;

/// A stretch without gaps.
#[derive(Debug)]
pub(super) struct Spread<T> {
    pub(super) step_s: f64,
    half: usize,
    /// The samples under the mean, and those behind its middle that have no time yet.
    samples: VecDeque<T>,
    /// Stamps are added up from here on, so that their digits last.
    base_s: f64,
    sum_s: f64,
    /// From the mean to the time, once it is known.
    shift_s: Option<f64>,
    last_s: f64,
    pub(super) spread: u64,
    /// Of these, samples whose stamp is further from their time than the clock's step explains.
    pub(super) unsure: u64,
}

impl<T: Stamped> Spread<T> {
    /// A stretch under a clock of this step with so many samples a second, after a sample at `last_s`.
    pub(super) fn new(step_s: f64, rate_hz: f64, last_s: f64) -> Self {
        let half_s = HALF_S.max(HALF_STEPS * step_s);
        Self {
            step_s,
            half: FEWEST_HALF.max((half_s * rate_hz) as usize),
            samples: VecDeque::new(),
            base_s: last_s,
            sum_s: 0.0,
            shift_s: None,
            last_s,
            spread: 0,
            unsure: 0,
        }
    }

    /// Takes the next sample; hands out those whose time is known.
    pub(super) fn push(&mut self, sample: T, sink: &mut impl FnMut(T)) {
        let window = 2 * self.half + 1;
        if self.samples.len() == window
            && let Some(oldest) = self.samples.pop_front()
        {
            self.sum_s -= oldest.time_s() - self.base_s;
        }
        self.sum_s += sample.time_s() - self.base_s;
        self.samples.push_back(sample);
        if self.samples.len() < window {
            return;
        }
        if self.shift_s.is_none() {
            self.along_the_line(0..self.half, sink);
        }
        let mean_s = self.base_s + self.sum_s / window as f64;
        self.hand_out(self.half, mean_s, 0.0, sink);
    }

    /// The stretch is over; the last time that was given out.
    pub(super) fn finish(&mut self, sink: &mut impl FnMut(T)) -> f64 {
        let whole = self.samples.len() > 2 * self.half;
        self.along_the_line(if whole { self.half + 1 } else { 0 }..self.samples.len(), sink);
        self.samples.clear();
        self.last_s
    }

    /// Samples of which the mean says nothing: on the line of least squares through all that are here.
    fn along_the_line(&mut self, places: std::ops::Range<usize>, sink: &mut impl FnMut(T)) {
        let middle = (self.samples.len() as f64 - 1.0) / 2.0;
        let mean_s = self.base_s + self.sum_s / self.samples.len().max(1) as f64;
        let (mut with_place, mut of_place) = (0.0, 0.0);
        for (place, sample) in self.samples.iter().enumerate() {
            let off = place as f64 - middle;
            with_place += off * (sample.time_s() - mean_s);
            of_place += off * off;
        }
        let period_s = if of_place > 0.0 { with_place / of_place } else { 0.0 };
        for place in places {
            self.hand_out(place, mean_s + (place as f64 - middle) * period_s, period_s, sink);
        }
    }

    fn hand_out(&mut self, place: usize, time_s: f64, period_s: f64, sink: &mut impl FnMut(T)) {
        let Some(sample) = self.samples.get(place) else { return };
        // Whether the clock rounds or cuts off is not known: it goes on from the sample before, as far as a step allows.
        let half_step_s = 0.5 * self.step_s;
        let shift_s = *self
            .shift_s
            .get_or_insert_with(|| (self.last_s + period_s - time_s).clamp(-half_step_s, half_step_s));
        self.spread += 1;
        let rounded_s = (sample.time_s() - time_s).abs();
        self.unsure += u64::from(!(rounded_s <= 1.1 * self.step_s));
        let time_s = time_s + shift_s;
        if time_s > self.last_s {
            self.last_s = time_s;
        }
        sink(sample.at(self.last_s));
    }
}
