//! The first readings: how fast each signal comes, which acceleration is the clock, and how far the others lie behind it.

use itpms_core::model::Corner;

use crate::log::{Field, LogColumns, SLOTS, Slot};
use crate::signals::Reading;

const LENGTH_S: f64 = 2.0;
/// Readings after which it ends all the same: nine signals of 2 kHz for two seconds are 36 000.
const MOST: usize = 65_536;
/// Readings of a signal from which its period is believed.
pub(super) const FEWEST: usize = 8;
/// A step of more than this many typical ones is a gap and does not count for the mean.
const GAP_PERIODS: f64 = 3.0;

#[derive(Debug, Default)]
pub(super) struct Survey {
    readings: Vec<Reading>,
    first_s: f64,
    last_s: f64,
}

impl Survey {
    pub(super) fn push(&mut self, reading: Reading) {
        if self.readings.is_empty() {
            (self.first_s, self.last_s) = (reading.time_s, reading.time_s);
        }
        self.first_s = self.first_s.min(reading.time_s);
        self.last_s = self.last_s.max(reading.time_s);
        self.readings.push(reading);
    }

    pub(super) fn is_over(&self) -> bool {
        self.last_s - self.first_s >= LENGTH_S || self.readings.len() >= MOST
    }

    /// Gives all readings away, in their order.
    pub(super) fn take(&mut self) -> Vec<Reading> {
        std::mem::take(&mut self.readings)
    }

    /// Nothing could be made of them: the older half goes, so that memory and waiting have an end.
    pub(super) fn forget_older_half(&mut self) {
        let newer = self.readings.split_off(self.readings.len().div_ceil(2));
        *self = Self::default();
        for reading in newer {
            self.push(reading);
        }
    }

    fn times(&self, slot: Slot) -> Vec<f64> {
        let mut times: Vec<f64> = self
            .readings
            .iter()
            .filter(|reading| reading.slot == slot)
            .map(|reading| reading.time_s)
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

#[derive(Debug)]
pub(super) struct Clock {
    /// The acceleration whose times are the rows'.
    pub(super) slot: Slot,
    pub(super) period_s: f64,
    /// Period of each signal in s; NaN where too few readings came.
    pub(super) periods_s: [f64; SLOTS],
    /// How far each signal's readings lie behind the clock's, in s, within half a period.
    pub(super) offsets_s: [f64; SLOTS],
    /// The first reading of each signal in s; NaN where there was none.
    pub(super) first_s: [f64; SLOTS],
}

impl Clock {
    /// The slowest acceleration of a complete corner, or of any if no corner is complete yet, else the slowest wheel speed; `None`
    /// without one.
    pub(super) fn of(survey: &Survey, columns: &LogColumns) -> Option<Self> {
        let times: Vec<Vec<f64>> = Slot::all().map(|slot| survey.times(slot)).collect();
        let mut periods_s = [f64::NAN; SLOTS];
        let mut first_s = [f64::NAN; SLOTS];
        for ((period, first), times) in periods_s.iter_mut().zip(&mut first_s).zip(&times) {
            *period = mean_period(times);
            *first = times.first().copied().unwrap_or(f64::NAN);
        }
        let pair = |corner| [Field::BodyAccel, Field::WheelAccel].map(|field| Slot::Corner(corner, field));
        let known = |slot: &Slot| periods_s[slot.index()].is_finite();
        let present = columns.present();
        let complete = |corner: &Corner| pair(*corner).iter().all(known) && present.contains(corner);
        let (mut clock, mut rolling): (Option<Slot>, Option<Slot>) = (None, None);
        for whole in [true, false] {
            let corners = present.iter().filter(|corner| !whole || complete(corner));
            for slot in corners.flat_map(|corner| pair(*corner)).filter(known) {
                // A tenth slower is as fast: the first of them is the clock.
                let slower = |than: Slot| periods_s[slot.index()] > 1.1 * periods_s[than.index()];
                if clock.is_none_or(slower) {
                    clock = Some(slot);
                }
            }
            if clock.is_some() {
                break;
            }
        }
        // Of wheels that come equally fast the first.
        for slot in columns.slots().filter(|slot| clock.is_none() && slot.is_wheel_speed() && known(slot)) {
            if rolling.is_none_or(|than: Slot| periods_s[slot.index()] > 1.1 * periods_s[than.index()]) {
                rolling = Some(slot);
            }
        }
        let slot = clock.or(rolling)?;
        let period_s = periods_s[slot.index()];
        let ticks = &times[slot.index()];
        let mut offsets_s = [0.0; SLOTS];
        for (offset, times) in offsets_s.iter_mut().zip(&times) {
            *offset = mean_offset(times, ticks, period_s);
        }
        Some(Self { slot, period_s, periods_s, offsets_s, first_s })
    }
}

/// The mean step, gaps left out: stamps may be rounded to whole milliseconds. NaN for too few times.
pub(crate) fn mean_period(times: &[f64]) -> f64 {
    if times.len() < FEWEST {
        return f64::NAN;
    }
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let median = steps[steps.len() / 2];
    let regular = &steps[..steps.partition_point(|step| *step <= GAP_PERIODS * median)];
    regular.iter().sum::<f64>() / regular.len() as f64
}

/// The mean distance to the nearest tick, as a mean of angles: half a period late and half a period early are the same.
fn mean_offset(times: &[f64], ticks: &[f64], period_s: f64) -> f64 {
    let (mut sine, mut cosine) = (0.0, 0.0);
    for time_s in times {
        let next = ticks.partition_point(|tick| tick < time_s);
        let nearest = [next.checked_sub(1), Some(next)]
            .into_iter()
            .flatten()
            .filter_map(|i| ticks.get(i))
            .map(|tick| time_s - tick)
            .min_by(|a, b| a.abs().total_cmp(&b.abs()));
        if let Some(distance_s) = nearest.filter(|distance| distance.abs() <= period_s) {
            let angle = std::f64::consts::TAU * distance_s / period_s;
            sine += angle.sin();
            cosine += angle.cos();
        }
    }
    let offset_s = sine.atan2(cosine) / std::f64::consts::TAU * period_s;
    // Equal times give a rounding error instead of zero.
    if offset_s.abs() < 1e-9 * period_s { 0.0 } else { offset_s }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_stamps_and_gaps_do_not_spoil_a_period() {
        let times: Vec<f64> = (0..400).map(|i| (f64::from(i) * 2.5).floor() / 1000.0).collect();
        assert!((mean_period(&times) - 0.0025).abs() < 1e-5);
        let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.002 + f64::from(i / 200)).collect();
        assert!((mean_period(&times) - 0.002).abs() < 1e-12);
        assert!(mean_period(&times[..7]).is_nan());
    }

    #[test]
    fn an_offset_is_signed_and_half_a_period_at_most() {
        let ticks: Vec<f64> = (0..500).map(|i| f64::from(i) * 0.002).collect();
        for shift in [-0.0009, -0.0004, 0.0, 0.0003, 0.0009] {
            let times: Vec<f64> = ticks.iter().map(|tick| tick + shift).collect();
            assert!((mean_offset(&times, &ticks, 0.002) - shift).abs() < 1e-9, "{shift}");
        }
        let times: Vec<f64> = ticks.iter().map(|tick| tick + 0.0015).collect();
        assert!((mean_offset(&times, &ticks, 0.002) + 0.0005).abs() < 1e-5);
    }
}
