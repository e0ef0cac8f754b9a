//! Time as it comes with the samples: what to make of each stamp, and how far apart they usually are.
//!
//! Called by [`crate::filter`]; knows no state and no sensor.
use itpms_core::Real;

/// A step in s no log has: its rows count as one.
const SHORTEST_STEP_S: f64 = 1e-6;
/// A longer step in s is taken for a broken time stamp, once.
const LONGEST_STEP_S: f64 = 1_000.0;
/// After so many samples at impossible times it is the clock that has been set.
const PATIENCE: u8 = 3;

/// What to make of a sample's time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arrival<T> {
    First,
    Next(T),
    /// Not after the last one, or absurdly late: leave it out.
    Ignored,
    /// The clock was set: begin anew.
    Anew,
}

/// The last sample's time, and the usual interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Clock<T> {
    time_s: Option<f64>,
    interval_s: T,
    ignored: u8,
}

impl<T: Real> Clock<T> {
    pub(crate) fn new() -> Self {
        Self { time_s: None, interval_s: T::zero(), ignored: 0 }
    }

    /// Time in s of the last sample that counted, 0 before the first.
    pub(crate) fn time_s(&self) -> f64 {
        self.time_s.unwrap_or(0.0)
    }

    /// Usual interval in s, 0 before the second sample.
    pub(crate) fn interval_s(&self) -> T {
        self.interval_s
    }

    /// What [`Clock::take`] would make of a time.
    pub(crate) fn arrival(&self, time_s: f64) -> Arrival<T> {
        let Some(last) = self.time_s else {
            return if time_s.is_finite() { Arrival::First } else { Arrival::Ignored };
        };
        let step_s = time_s - last;
        if (SHORTEST_STEP_S..=LONGEST_STEP_S).contains(&step_s) {
            Arrival::Next(T::lit(step_s))
        } else if !is_repeated(step_s) && time_s.is_finite() && self.ignored >= PATIENCE {
            Arrival::Anew
        } else {
            Arrival::Ignored
        }
    }

    pub(crate) fn take(&mut self, time_s: f64) -> Arrival<T> {
        let arrival = self.arrival(time_s);
        if arrival == Arrival::Ignored {
            // The last stamp again says nothing of the clock.
            if !self.time_s.is_some_and(|last| is_repeated(time_s - last)) {
                self.ignored = self.ignored.saturating_add(1);
            }
            return arrival;
        }
        self.ignored = 0;
        self.time_s = Some(time_s);
        if let Arrival::Next(step_s) = arrival {
            self.learn(step_s);
        }
        arrival
    }

    /// Mean interval; gaps and stumbling clocks move it by a tenth at most.
    fn learn(&mut self, step_s: T) {
        let known = self.interval_s;
        self.interval_s = if !(known > T::zero()) {
            step_s
        } else if step_s > T::lit(2.0) * known {
            T::lit(1.1) * known
        } else if step_s < T::lit(0.5) * known {
            T::lit(0.9) * known
        } else {
            known + T::lit(0.02) * (step_s - known)
        };
    }
}

fn is_repeated(step_s: f64) -> bool {
    step_s.abs() < SHORTEST_STEP_S
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_that_is_repeated_is_no_clock_that_was_set() {
        let mut clock = Clock::<f64>::new();
        for second in 0..5 {
            let time = f64::from(second);
            clock.take(time);
            for _ in 0..9 {
                assert_eq!(clock.take(time), Arrival::Ignored);
            }
        }
        assert_eq!(clock.take(5.0), Arrival::Next(1.0));
    }

    #[test]
    fn one_broken_stamp_is_left_out_and_a_set_clock_is_followed() {
        let mut clock = Clock::<f64>::new();
        assert_eq!(clock.take(f64::NAN), Arrival::Ignored);
        assert_eq!(clock.take(10.0), Arrival::First);
        assert_eq!(clock.take(10.5), Arrival::Next(0.5));
        assert_eq!(clock.take(1e300), Arrival::Ignored);
        assert_eq!(clock.take(10.5), Arrival::Ignored);
        assert_eq!(clock.take(11.0), Arrival::Next(0.5));
        for time in [1.0, 1.1, 1.2] {
            assert_eq!(clock.take(time), Arrival::Ignored);
        }
        assert_eq!(clock.take(1.3), Arrival::Anew);
        assert_eq!(clock.take(1.4), Arrival::Next(1.4 - 1.3));
    }

    #[test]
    fn the_interval_is_found_behind_a_gap_at_the_start() {
        let mut clock = Clock::<f64>::new();
        let mut time = 0.0;
        clock.take(time);
        time += 30.0;
        for _ in 0..1000 {
            clock.take(time);
            time += 0.002;
        }
        assert!((clock.interval_s() - 0.002).abs() < 1e-6);
    }
}
