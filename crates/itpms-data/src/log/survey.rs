//! A first look at a log: its sample period and its jitter, from the rows the reader has looked ahead.
//!
//! Called once by the reader when a log is opened, and by whoever listens to a bus.

use itpms_core::conditioning::SAMPLE_RATES_HZ;

use super::row::LogRow;
use super::slot::Slot;
use crate::error::Problem;

/// Rows read ahead to judge a log before the first is handed out: 8 s at 500 Hz, 2 s at 2 kHz.
pub const SURVEY_ROWS: usize = 4096;
/// A step of more than this many median periods is a gap.
pub(super) const GAP_PERIODS: f64 = 3.0;

/// No wheel can be seen below twice the wheel hop's 10 to 14 Hz, and no accelerometer of a car samples faster than
/// this: outside, the unit of the time is wrong.
pub(super) const POSSIBLE_RATES_HZ: std::ops::RangeInclusive<f64> = 20.0..=50_000.0;
/// Of wheel speeds alone, which come with every tenth of a second or more often.
const POSSIBLE_WHEEL_SPEED_RATES_HZ: std::ops::RangeInclusive<f64> = 9.5..=50_000.0;

/// Evidence of the first rows about the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    pub rows: usize,
    /// Median step of the time in s.
    pub sample_period_s: f64,
    pub jitter_s: f64,
    /// Samples per second: the inverse of the mean step, gaps left out (the median step of a clock that counts whole
    /// milliseconds can be far off), rounded to a whole number where it is within 0.1 % of one.
    pub sample_rate_hz: f64,
}

impl Survey {
    /// The rate for which an estimator is made, in Hz: the fastest it is for where samples come faster, and where every tenth or so is
    /// lost that of the others.
    pub fn estimator_rate_hz(&self) -> f64 {
        let median_hz = 1.0 / self.sample_period_s;
        let lossy = self.sample_rate_hz < *SAMPLE_RATES_HZ.start() && median_hz >= *SAMPLE_RATES_HZ.start();
        let rate_hz = if lossy { median_hz } else { self.sample_rate_hz };
        rate_hz.min(*SAMPLE_RATES_HZ.end())
    }

    /// The survey of these rows, in the order of their times.
    /// Errors: there are fewer than two rows, or the rate is none of a car's accelerometers.
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a LogRow>) -> Result<Self, Problem> {
        let mut accelerations = false;
        let time_s = |row: &LogRow| {
            accelerations |= row.corners.iter().any(Option::is_some);
            row.time_s
        };
        let times: Vec<f64> = rows.into_iter().map(time_s).collect();
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if steps.is_empty() {
            return Err(Problem::TooFewSamples(times.len() as u64));
        }
        steps.sort_by(f64::total_cmp);
        let sample_period_s = steps[steps.len() / 2];
        let regular = &steps[..steps.partition_point(|step| *step <= GAP_PERIODS * sample_period_s)];
        let mean = regular.iter().sum::<f64>() / regular.len() as f64;
        let variance = regular.iter().map(|step| (step - mean).powi(2)).sum::<f64>() / regular.len() as f64;
        let rate = 1.0 / mean;
        let possible = if accelerations { POSSIBLE_RATES_HZ } else { POSSIBLE_WHEEL_SPEED_RATES_HZ };
        if !possible.contains(&rate) {
            return Err(Problem::SamplePeriod {
                clock: Slot::Time.name(),
                period_s: sample_period_s,
                rate_hz: rate,
            });
        }
        let whole = rate.round();
        let sample_rate_hz = if (rate / whole - 1.0).abs() < 1e-3 { whole } else { rate };
        Ok(Self { rows: times.len(), sample_period_s, jitter_s: variance.sqrt(), sample_rate_hz })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn survey(times: impl IntoIterator<Item = f64>) -> Result<Survey, Problem> {
        let rows: Vec<LogRow> =
            times.into_iter().map(|time_s| LogRow::without_motion(time_s, f64::NAN, [None; 4])).collect();
        Survey::of(&rows)
    }

    #[test]
    fn a_whole_rate_is_found_through_rounded_stamps_jitter_and_gaps() {
        let s = survey((0..2000).map(|i| 1.7e9 + f64::from(i) / 500.0)).unwrap();
        assert_eq!(s.sample_rate_hz, 500.0);
        // 400 Hz on a millisecond clock: steps of 2 and 3 ms, never of 2.5.
        let s = survey((0..2000).map(|i| (f64::from(i) * 2.5).floor() / 1000.0)).unwrap();
        assert_eq!(s.sample_rate_hz, 400.0);
        assert!((s.jitter_s - 0.0005).abs() < 1e-5, "{}", s.jitter_s);
        // A second is missing after a thousand rows.
        let s = survey((0..2000).map(|i| f64::from(i) / 200.0 + f64::from(i / 1000))).unwrap();
        assert_eq!((s.sample_rate_hz, s.estimator_rate_hz()), (200.0, 200.0));
        assert!(s.jitter_s < 1e-9);
        // Every fifth row of 100 Hz is missing; 5 kHz.
        let s = survey((0..2000).filter(|i| i % 5 != 0).map(|i| f64::from(i) / 100.0)).unwrap();
        assert!((s.estimator_rate_hz() - 100.0).abs() < 1e-6 && s.sample_rate_hz < 81.0);
        assert_eq!(survey((0..2000).map(|i| f64::from(i) / 5000.0)).unwrap().estimator_rate_hz(), 2100.0);
    }

    #[test]
    fn one_sample_and_milliseconds_are_refused() {
        assert!(matches!(survey([3.0]), Err(Problem::TooFewSamples(1))));
        let text = survey((0..100).map(|i| f64::from(i) * 2.0)).unwrap_err().to_string();
        assert!(text.contains("0.5") && text.contains("looks like milliseconds"), "{text}");
        // A duration of pandas or polars, which Parquet holds as an integer.
        let text = survey((0..100).map(|i| f64::from(i) * 2e6)).unwrap_err().to_string();
        assert!(text.contains("looks like nanoseconds"), "{text}");
    }
}
