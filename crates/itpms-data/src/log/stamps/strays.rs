//! Leaves out short runs of stamps that contradict the others of the same clock: a counter that wrapped below zero, a clock that was
//! set while the file was written.
//!
//! One for each clock: a table, a bus, a channel group.

use super::{Fate, Stamped, WINDOW_S};

/// Stamps far ahead of all others, or the first ones, are believed when they have gone on for so long, in s.
const BELIEVED_S: f64 = 1.0;
/// No pause is that long: a stamp so far ahead of the first ones shows that these were wrong.
const LONGEST_PAUSE_S: f64 = 86_400.0;
/// Samples that wait at most: more of them without a second passing are a clock that stands still.
const MOST_WAITING: usize = 65_536;

#[derive(Debug)]
pub(in crate::log) struct Strays<T> {
    /// The latest stamp that was believed; NaN before the first.
    latest_s: f64,
    /// A run that is not believed yet.
    waiting: Vec<T>,
}

impl<T: Stamped> Strays<T> {
    pub(in crate::log) fn new() -> Self {
        Self { latest_s: f64::NAN, waiting: Vec::new() }
    }

    /// Takes a sample; says what becomes of it, and of those that waited for it, in the order in which they came.
    pub(in crate::log) fn take(&mut self, sample: T, mut sink: impl FnMut(Fate<T>)) {
        let off_s = sample.time_s() - self.latest_s;
        if off_s.abs() <= WINDOW_S {
            self.leave_out(&mut sink);
            self.latest_s = self.latest_s.max(sample.time_s());
            return sink(Fate::Kept(sample));
        }
        if off_s < 0.0 {
            return sink(Fate::Stray(sample));
        }
        if let Some(last) = self.waiting.last() {
            let step_s = sample.time_s() - last.time_s();
            if step_s > WINDOW_S && step_s < LONGEST_PAUSE_S {
                // A slow signal, or a pause after a short stretch.
                self.believe(&mut sink);
            } else if step_s.abs() > WINDOW_S || self.waiting.len() == MOST_WAITING {
                self.leave_out(&mut sink);
            }
        }
        let began_s = self.waiting.first().map_or(sample.time_s(), Stamped::time_s);
        let lasts_s = (sample.time_s() - began_s).abs();
        self.waiting.push(sample);
        if lasts_s >= BELIEVED_S {
            self.believe(&mut sink);
        }
    }

    /// There are no more samples. A log of less than a second is believed.
    pub(in crate::log) fn finish(&mut self, mut sink: impl FnMut(Fate<T>)) {
        if self.latest_s.is_nan() {
            self.believe(&mut sink);
        }
        self.leave_out(&mut sink);
    }

    fn believe(&mut self, sink: &mut impl FnMut(Fate<T>)) {
        for sample in self.waiting.drain(..) {
            self.latest_s = self.latest_s.max(sample.time_s());
            sink(Fate::Kept(sample));
        }
    }

    fn leave_out(&mut self, sink: &mut impl FnMut(Fate<T>)) {
        self.waiting.drain(..).for_each(|sample| sink(Fate::Stray(sample)));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Sample;
    use super::*;

    /// The stamps that are kept, and how many are not.
    fn kept(stamps: impl IntoIterator<Item = f64>) -> (Vec<f64>, usize) {
        let (mut kept, mut strays) = (Vec::new(), 0);
        let mut sink = |fate: Fate<Sample>| match fate {
            Fate::Kept((time_s, _)) => kept.push(time_s),
            _ => strays += 1,
        };
        let mut filter = Strays::new();
        stamps.into_iter().for_each(|stamp| filter.take((stamp, 0), &mut sink));
        filter.finish(&mut sink);
        (kept, strays)
    }

    fn good(from: u32, to: u32) -> impl Iterator<Item = f64> {
        (from..to).map(|k| f64::from(k) * 0.002)
    }

    #[test]
    fn a_short_run_far_off_goes_wherever_it_is() {
        for by_s in [-1.8e10, -3600.0, -11.0, 11.0, 3600.0, 1.8e10] {
            for many in [1, 13, 400] {
                for at in [0, 2000, 4000 - many] {
                    let off = |k: u32| (at..at + many).contains(&k);
                    let stamps = (0..4000).map(|k| f64::from(k) * 0.002 + if off(k) { by_s } else { 0.0 });
                    // A few samples and then a pause are how a log may begin.
                    let pause = at == 0 && (-1e5..0.0).contains(&by_s);
                    let expected = if pause { 0 } else { many as usize };
                    let (kept, strays) = kept(stamps);
                    assert_eq!((kept.len(), strays), (4000 - expected, expected), "{by_s} {many} {at}");
                }
            }
        }
    }

    #[test]
    fn pauses_slow_signals_and_short_logs_stay() {
        let pause = good(0, 2000).chain(good(0, 2000).map(|t| t + 5000.0));
        assert_eq!(kept(pause).1, 0);
        let slow = (0..50).map(|k| f64::from(k) * 30.0);
        // The last one has nothing that follows it.
        assert_eq!(kept(slow).1, 1);
        assert_eq!(kept(good(0, 20)), (good(0, 20).collect(), 0));
        // Late by less than the window.
        let late = good(0, 2000).chain([1.0, 1.002]).chain(good(2000, 3000));
        assert_eq!(kept(late).1, 0);
    }

    #[test]
    fn what_stands_still_is_not_kept_for_ever() {
        let (kept, strays) = kept(good(0, 1500).chain(std::iter::repeat_n(77.0, 200_000)));
        assert_eq!((kept.len(), strays), (1500, 200_000));
    }
}
