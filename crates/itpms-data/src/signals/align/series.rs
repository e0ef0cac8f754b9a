//! Readings of one signal that wait for the rows they belong to: slow ones to be interpolated, fast ones to be filtered.

use std::collections::VecDeque;

use super::kernel::{HALF_WIDTH, weight};

/// Readings kept at most; more than any row can need (ten periods of 20 Hz at 50 kHz).
const MOST: usize = 32_768;
/// Neighbours further apart than this many periods say nothing about the time between them.
const GAP_PERIODS: f64 = 3.0;
/// The same for samples under the low-pass.
const HOLE_PERIODS: f64 = 2.5;

/// The newest readings, in the order of time.
#[derive(Debug, Clone)]
pub(super) struct Series {
    period_s: f64,
    readings: VecDeque<(f64, f64)>,
}

impl Series {
    pub(super) fn new(period_s: f64) -> Self {
        Self { period_s, readings: VecDeque::new() }
    }

    pub(super) fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Time of the newest reading in s.
    pub(super) fn newest_s(&self) -> f64 {
        self.readings.back().map_or(f64::NEG_INFINITY, |(time_s, _)| *time_s)
    }

    /// Takes a reading; an invalid one leaves a hole, one out of order is passed over.
    pub(super) fn push(&mut self, time_s: f64, value: f64) {
        if !(time_s > self.newest_s()) || !value.is_finite() {
            return;
        }
        if self.readings.len() == MOST {
            self.readings.pop_front();
        }
        self.readings.push_back((time_s, value));
    }

    /// Rows before this time are gone: forgets what only they could need.
    pub(super) fn forget_before(&mut self, time_s: f64) {
        while self.readings.get(1).is_some_and(|(next_s, _)| *next_s <= time_s) {
            self.readings.pop_front();
        }
    }

    pub(super) fn clear(&mut self) {
        self.readings.clear();
    }

    /// The value on the line between the readings around `time_s`; the last one where none follows yet; NaN in gaps.
    pub(super) fn at(&self, time_s: f64) -> f64 {
        let next = self.readings.partition_point(|(t, _)| *t < time_s);
        let before = next.checked_sub(1).and_then(|i| self.readings.get(i));
        match (before, self.readings.get(next)) {
            (_, Some((t, value))) if *t == time_s => *value,
            (Some((a_s, a)), Some((b_s, b))) if b_s - a_s <= GAP_PERIODS * self.period_s => {
                a + (b - a) * (time_s - a_s) / (b_s - a_s)
            }
            (Some((a_s, a)), None) if time_s - a_s <= GAP_PERIODS * self.period_s => *a,
            _ => f64::NAN,
        }
    }

    /// The value at `time_s` through the low-pass for rows of `row_period_s`; NaN where a hole is under the kernel.
    pub(super) fn filtered(&self, time_s: f64, row_period_s: f64) -> f64 {
        let reach_s = HALF_WIDTH * row_period_s;
        let first = self.readings.partition_point(|(t, _)| *t < time_s - reach_s);
        let (mut sum, mut norm) = (0.0, 0.0);
        let mut last_s = time_s - reach_s;
        let mut hole_s = 0.0f64;
        for (t, value) in self.readings.range(first..).take_while(|(t, _)| *t <= time_s + reach_s) {
            let w = weight((t - time_s) / row_period_s);
            sum += w * value;
            norm += w;
            hole_s = hole_s.max(t - last_s);
            last_s = *t;
        }
        hole_s = hole_s.max(time_s + reach_s - last_s);
        if hole_s <= HOLE_PERIODS * self.period_s && norm > 0.0 { sum / norm } else { f64::NAN }
    }
}
