//! A clock that only goes forwards, whatever the stamps of the samples do.
//!
//! Stands before the estimators and the monitor, so that a clock that is set, or one stray stamp, is a pause to them and
//! nothing else: calibrations end, warm references and beliefs go on. Called by them; knows nothing of the sampled quantities.

use crate::conditioning::pauses::PAUSE_S;
use crate::memory::Blank;
use crate::real::ROUND_F64;

/// Least distance of two stamps, in sampling periods: closer ones are the same.
pub(crate) const CLOSEST: f64 = 0.05;
/// Longest distance of stamps that follow one another, in periods: two samples in a row may be missing.
pub(crate) const LONGEST_BRIDGE: f64 = 3.5;
/// Parts of a period to which stamps count, from the first one on: neither where a clock begins nor how its stamps are rounded decides anything.
const PARTS: f64 = 1024.0;
/// Steps, one after the other, after which stamps that are out of line are believed: where they lie in the past, and so
/// could be old ones that come late, and where they lie ahead.
const SET_BACK: u32 = 16;
const LEAPT: u32 = 1;

/// The stamp in s of a steady time that is so much ahead of the stamps, to a microsecond.
pub(crate) fn stamp_s(steady_s: f64, ahead_s: f64) -> f64 {
    ((steady_s - ahead_s) * 1e6 + ROUND_F64 - ROUND_F64) / 1e6
}

/// The time in s before which a stamp's own rounding is smaller than the least distance of two; nor are infinite and NaN ones resolved.
fn latest_resolved_s(period_s: f64) -> f64 {
    CLOSEST / f64::EPSILON * period_s
}

/// Stamps that are out of line, and whether they follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Stray {
    first_s: f64,
    last_s: f64,
    /// How many steps one after the other.
    steps: u32,
}

impl Stray {
    /// None yet.
    const NONE: Self = Self { first_s: f64::NEG_INFINITY, last_s: f64::NEG_INFINITY, steps: 0 };

    /// Takes another one; it follows the last one if it is at most `longest_s` later.
    fn take(&mut self, time_s: f64, period_s: f64, longest_s: f64) {
        let step_s = time_s - self.last_s;
        // The same time again says nothing.
        if step_s.abs() < CLOSEST * period_s {
            return;
        }
        if step_s > 0.0 && step_s <= longest_s {
            self.steps += 1;
        } else {
            (self.first_s, self.steps) = (time_s, 0);
        }
        self.last_s = time_s;
    }
}

/// Makes of the stamps of samples a time that only goes forwards.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SteadyClock {
    period_s: f64,
    /// See [`latest_resolved_s`].
    latest_s: f64,
    /// The last stamp that was believed; minus infinity before the first.
    stamp_s: f64,
    /// Offset of the steady time from the stamps: it begins at zero.
    ahead_s: f64,
    stray: Stray,
}

impl SteadyClock {
    /// A clock for samples that come at about `sample_rate_hz`.
    pub(crate) fn new(sample_rate_hz: f64) -> Self {
        let period_s = 1.0 / sample_rate_hz;
        Self {
            period_s,
            latest_s: latest_resolved_s(period_s),
            stamp_s: f64::NEG_INFINITY,
            ahead_s: 0.0,
            stray: Stray::NONE,
        }
    }

    /// Takes a sample's stamp in s; gives the steady time, or `None` for a stamp that is not to be used: one that is not
    /// finite, too large to be resolved, or out of line with those around it.
    pub(crate) fn take(&mut self, time_s: f64) -> Option<f64> {
        if !(time_s.abs() < self.latest_s) {
            return None;
        }
        let step_s = time_s - self.stamp_s;
        // One that is further ahead has to be followed by another one before it is believed.
        let in_line = self.stamp_s == f64::NEG_INFINITY || (0.0..=PAUSE_S).contains(&step_s);
        if !in_line {
            // Ahead, samples may come as seldom as they may before it; old ones that come late come as they were sent.
            let longest_s = if step_s > 0.0 { PAUSE_S } else { LONGEST_BRIDGE * self.period_s };
            self.stray.take(time_s, self.period_s, longest_s);
            if self.stray.steps < if step_s > 0.0 { LEAPT } else { SET_BACK } {
                return None;
            }
            if step_s < 0.0 {
                // For how long is unknown; at least for those that were not believed.
                let lost_s = time_s - self.stray.first_s + self.period_s;
                self.ahead_s += lost_s - step_s;
            }
        } else if self.stamp_s == f64::NEG_INFINITY {
            self.ahead_s = -time_s;
        }
        self.stray = Stray::NONE;
        self.stamp_s = time_s;
        Some(self.now_s())
    }

    /// The steady time of the last stamp that was believed; minus infinity before the first.
    pub(crate) fn now_s(&self) -> f64 {
        let part_s = self.period_s / PARTS;
        ((self.stamp_s + self.ahead_s) / part_s + ROUND_F64 - ROUND_F64) * part_s
    }

    /// The steady time at a stamp that may not have been believed, if it is right; infinite if unknown.
    pub(crate) fn at_latest_s(&self, time_s: f64) -> f64 {
        let ahead = time_s.abs() < self.latest_s && time_s >= self.stamp_s;
        if ahead { time_s + self.ahead_s } else { f64::INFINITY }
    }

    /// Present offset of the steady time from the stamps in s.
    pub(crate) fn ahead_s(&self) -> f64 {
        self.ahead_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.01;

    fn steady(stamps: impl IntoIterator<Item = f64>) -> (SteadyClock, [Option<f64>; 400]) {
        let mut clock = SteadyClock::new(1.0 / PERIOD_S);
        let mut times = [None; 400];
        for (time, stamp) in times.iter_mut().zip(stamps) {
            *time = clock.take(stamp);
        }
        (clock, times)
    }

    fn stamp(k: usize) -> f64 {
        k as f64 * PERIOD_S
    }

    #[test]
    fn an_honest_clock_is_passed_on() {
        // Doubled rows and holes, too.
        let honest = |k: usize| stamp(k / 2 * 3);
        let (clock, times) = steady((0..400).map(honest));
        assert!((0..400).all(|k| times[k] == Some(honest(k))));
        assert_eq!(clock.ahead_s(), 0.0);
    }

    #[test]
    fn one_stray_stamp_is_left_out() {
        for stray in [1e3, 1e9, 1e200, f64::INFINITY, -1e3, f64::NEG_INFINITY, f64::NAN, stamp(150)] {
            let (clock, times) = steady((0..400).map(|k| if k == 200 { stray } else { stamp(k) }));
            assert!((0..400).all(|k| times[k] == (k != 200).then(|| stamp(k))), "{stray}");
            assert_eq!(clock.now_s(), stamp(399));
        }
    }

    #[test]
    fn a_pause_is_believed_with_its_second_stamp() {
        let (_, times) = steady((0..400).map(|k| stamp(k) + if k < 200 { 0.0 } else { 3600.0 }));
        assert_eq!(times[200], None);
        assert!((times[201].unwrap() - stamp(201) - 3600.0).abs() < 1e-9);
    }

    #[test]
    fn after_a_pause_samples_may_come_more_seldom() {
        // Twelve periods apart, after an hour.
        let (clock, times) =
            steady((0..400).map(|k| if k < 200 { stamp(k) } else { 3600.0 + stamp(12 * k) }));
        assert!(times[200].is_none() && times[201..].iter().all(Option::is_some), "{:?}", times[201]);
        assert!((clock.now_s() - 3600.0 - stamp(12 * 399)).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_believed_yet_may_be_right() {
        let (clock, _) = steady((0..400).map(stamp));
        assert_eq!(clock.at_latest_s(stamp(399)), clock.now_s());
        assert_eq!(clock.at_latest_s(3600.0), 3600.0);
        for stray in [stamp(398), 1e200, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(clock.at_latest_s(stray), f64::INFINITY, "{stray}");
        }
    }

    #[test]
    fn a_clock_that_is_set_back_goes_on() {
        for back_s in [0.3, 10.0, 1e6] {
            let (clock, times) = steady((0..400).map(|k| stamp(k) - if k < 200 { 0.0 } else { back_s }));
            assert!(times[200..216].iter().all(Option::is_none), "{back_s}");
            // As if it had not been set.
            for (k, time) in times.iter().enumerate().skip(216) {
                assert!(time.is_some_and(|time| (time - stamp(k)).abs() < 1e-9), "{back_s}: {k} {time:?}");
            }
            assert!((clock.ahead_s() - back_s).abs() < 1e-9);
        }
    }

    #[test]
    fn a_first_stamp_from_the_future_is_only_an_offset() {
        let (_, times) = steady((0..400).map(|k| if k == 0 { 1e5 } else { stamp(k) }));
        let late = times.iter().flatten().count();
        assert_eq!(late, 400 - 16);
        assert!(times[17].is_some_and(|time| (time - stamp(17)).abs() < 1e-6), "{:?}", times[17]);
    }

    #[test]
    fn neither_where_a_clock_begins_nor_how_it_is_rounded_changes_a_time() {
        let rounded = |k: usize| (1e6 * stamp(k)).round() / 1e6;
        let (_, times) = steady((0..400).map(stamp));
        for origin_s in [-30.0, -1e-3, 1.0 / 3.0, 86_400.0, 1.7e9] {
            let (clock, moved) = steady((0..400).map(|k| origin_s + rounded(k)));
            assert_eq!(moved, times, "{origin_s}");
            assert!((stamp_s(clock.now_s(), clock.ahead_s()) - origin_s - stamp(399)).abs() < 1e-6);
        }
    }
}
