//! How often what has been learned is concluded: pressures hardly change between two samples, and what they cost adds up.

use crate::memory::blank;

/// Time in s between two conclusions, and the longest for which one is told again, as where samples are missing.
const EVERY_S: f64 = 0.01;
const LONGEST_S: f64 = 0.02;

/// Says of each sample whether it is time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Cadence {
    every: u32,
    since: u32,
    last_s: f64,
}

blank!(Cadence { every, since, last_s });

impl Cadence {
    /// A hundred times a second, or with every sample where they come no faster.
    pub(crate) fn new(sample_rate_hz: f64) -> Self {
        Self { every: (sample_rate_hz * EVERY_S + 0.5) as u32, since: 0, last_s: f64::NEG_INFINITY }
    }

    /// With every sample.
    pub(crate) fn always() -> Self {
        Self { every: 1, since: 0, last_s: f64::NEG_INFINITY }
    }

    /// Takes a sample of that time in s.
    pub(crate) fn is_due(&mut self, time_s: f64) -> bool {
        self.since = self.since.saturating_add(1);
        // No number is no time to go by.
        let due = self.since >= self.every || !(time_s - self.last_s < LONGEST_S);
        if due {
            (self.since, self.last_s) = (0, time_s);
        }
        due
    }

    /// The next sample is due.
    pub(crate) fn restart(&mut self) {
        self.last_s = f64::NEG_INFINITY;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_times_a_second_and_after_a_hole() {
        for (rate_hz, expected) in [(20.0, 1000), (100.0, 1000), (200.0, 500), (500.0, 200), (1000.0, 100)] {
            let mut cadence = Cadence::new(rate_hz);
            let due = (0..1000).filter(|&k| cadence.is_due(f64::from(k) / rate_hz)).count();
            assert_eq!(due, expected, "{rate_hz}");
        }
        let mut cadence = Cadence::new(500.0);
        assert!(
            [0.0, 0.002, 0.004, 1.0, 1.002].map(|time_s| cadence.is_due(time_s))
                == [true, false, false, true, false]
        );
        cadence.restart();
        assert!(cadence.is_due(1.004) && cadence.is_due(f64::NAN));
    }
}
