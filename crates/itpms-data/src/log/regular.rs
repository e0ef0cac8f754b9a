//! Whether the stamps of a whole log are those of one clock: rows that come evenly, at one rate.
//!
//! Called by the reader with every step from one row to the next. A clock that stamps when it finds the time, or a rate that changes in the
//! middle of a file, makes frequencies of an accelerometer that no wheel has.

use super::survey::GAP_PERIODS;
use crate::error::Problem;

/// Steps of a stretch, and stretches that decide.
const STEPS: usize = 512;
const LEAST: u32 = 3;
/// Standard deviation of a step over its mean: stamps that are rounded to less than the period have a third at most, as have
/// stamps that are off by a quarter of it.
const MOST_JITTER: f64 = 0.45;
/// Share of stretches that may be as uneven.
const UNEVEN_SHARE: f64 = 0.1;
/// Factor by which the step of a stretch may differ from the first ones'.
const OTHER_RATE: f64 = 1.5;

#[derive(Debug)]
pub(super) struct Regular {
    period_s: f64,
    steps: Vec<f64>,
    stretches: u32,
    uneven: u32,
    worst: f64,
    /// Stretches of another rate, one after the other, the mean step of the last one, and when they began.
    others: u32,
    other_s: f64,
    since_s: f64,
}

impl Regular {
    pub(super) fn new(period_s: f64) -> Self {
        Self {
            period_s,
            steps: Vec::with_capacity(STEPS),
            stretches: 0,
            uneven: 0,
            worst: 0.0,
            others: 0,
            other_s: f64::NAN,
            since_s: f64::NAN,
        }
    }

    /// Takes the step to the next row.
    pub(super) fn take(&mut self, from_s: f64, step_s: f64) -> Result<(), Problem> {
        self.steps.push(step_s);
        if self.steps.len() < STEPS {
            return Ok(());
        }
        self.steps.sort_by(f64::total_cmp);
        let median_s = self.steps[STEPS / 2];
        let even = &self.steps[..self.steps.partition_point(|step| *step <= GAP_PERIODS * median_s)];
        let mean_s = even.iter().sum::<f64>() / even.len() as f64;
        let variance = even.iter().map(|step| (step - mean_s).powi(2)).sum::<f64>() / even.len() as f64;
        let jitter = variance.sqrt() / mean_s;
        self.steps.clear();
        self.stretches += 1;
        if jitter > MOST_JITTER {
            self.uneven += 1;
            self.worst = self.worst.max(jitter);
        }
        let factor = mean_s / self.period_s;
        if (1.0 / OTHER_RATE..=OTHER_RATE).contains(&factor) {
            self.others = 0;
        } else {
            if self.others == 0 {
                self.since_s = from_s;
            }
            (self.others, self.other_s) = (self.others + 1, mean_s);
        }
        self.check()
    }

    fn check(&self) -> Result<(), Problem> {
        if self.uneven >= LEAST && f64::from(self.uneven) > UNEVEN_SHARE * f64::from(self.stretches) {
            let (period_s, jitter_percent) = ((self.period_s * 1e6).round() / 1e6, 100.0 * self.worst);
            return Err(format!(
                "the times are uneven: a step of {period_s} s has a standard deviation of {jitter_percent:.0} %, so frequencies are unknown; \
                 expected even samples (write the time at which each was taken, not at which it arrived)"
            )
            .into());
        }
        if self.others >= LEAST {
            let (from_hz, to_hz) = (1.0 / self.period_s, 1.0 / self.other_s);
            return Err(format!(
                "the rate changes from {from_hz:.0} to {to_hz:.0} Hz at {} s, expected one rate (cut the log there)",
                self.since_s
            )
            .into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(period_s: f64, times: impl IntoIterator<Item = f64>) -> Result<(), Problem> {
        let mut times: Vec<f64> = times.into_iter().collect();
        times.sort_by(f64::total_cmp);
        let mut regular = Regular::new(period_s);
        times.windows(2).try_for_each(|pair| regular.take(pair[0], pair[1] - pair[0]))
    }

    /// Sum of twelve uniform numbers: near enough to a normal distribution of variance one.
    fn normal(seed: &mut u64) -> f64 {
        let mut uniform = || {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*seed >> 40) as f64 / f64::from(1 << 24)
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    #[test]
    fn stamps_off_by_half_a_period_are_refused_and_rounded_or_lost_ones_are_not() {
        let mut seed = 1;
        for (off, is_even) in [(0.05, true), (0.2, true), (0.6, false), (1.5, false)] {
            let found = verdict(0.005, (0..6000).map(|k| (f64::from(k) + off * normal(&mut seed)) * 0.005));
            assert_eq!(found.is_ok(), is_even, "{off}: {found:?}");
        }
        for rate_hz in [400.0, 500.0, 667.0, 800.0, 950.0] {
            let rounded = (0..6000).map(|k| (f64::from(k) / rate_hz * 1000.0).floor() / 1000.0);
            assert!(verdict(1.0 / rate_hz, rounded).is_ok(), "{rate_hz}");
        }
        let lost = (0..6000).filter(|k| k % 7 != 0 && k % 11 != 0).map(|k| f64::from(k) * 0.002);
        assert!(verdict(0.002, lost).is_ok());
    }

    #[test]
    fn a_rate_that_changes_is_refused_and_a_pause_is_not() {
        let changing =
            (0..6000).map(|k| if k < 3000 { f64::from(k) * 0.001 } else { 3.0 + f64::from(k - 3000) * 0.01 });
        let text = verdict(0.001, changing).unwrap_err().to_string();
        assert!(text.contains("1000") && text.contains("100 Hz"), "{text}");
        assert!(verdict(0.001, (0..6000).map(|k| f64::from(k) * 0.001 + f64::from(k / 3000) * 60.0)).is_ok());
    }
}
