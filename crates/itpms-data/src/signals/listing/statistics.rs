//! What a list says of a clock and of a signal, from a stream of any length. Called by the lists of each format.

/// Steps of a clock that are kept; when there are more, every other one goes, and from then on every other one comes.
const KEPT_STEPS: usize = 2048;
/// A step of more than this many median ones is a gap, as in drive logs.
const GAP_STEPS: f64 = 3.0;

/// The clock of a message or channel group.
#[derive(Debug, Clone, Default)]
pub(super) struct Clock {
    samples: u64,
    first_s: f64,
    last_s: f64,
    steps: Vec<f64>,
    /// Every how many steps one is kept; zero before the first.
    stride: u64,
}

impl Clock {
    pub(super) fn tick(&mut self, time_s: f64) {
        self.samples += 1;
        if !time_s.is_finite() {
            return;
        }
        if self.stride == 0 {
            (self.first_s, self.stride) = (time_s, 1);
        } else if self.samples.is_multiple_of(self.stride) {
            self.steps.push(time_s - self.last_s);
            if self.steps.len() == KEPT_STEPS {
                let mut place = 0;
                self.steps.retain(|_| {
                    place += 1;
                    place % 2 == 0
                });
                self.stride *= 2;
            }
        }
        self.last_s = time_s;
    }

    pub(super) fn samples(&self) -> u64 {
        self.samples
    }

    /// First and last time in s, if there is any.
    pub(super) fn span_s(&self) -> Option<(f64, f64)> {
        (self.stride > 0).then_some((self.first_s, self.last_s))
    }

    /// Samples per second: the inverse of the mean step, gaps left out; and the steps' standard deviation in s. `None`
    /// below two samples or where time stands still.
    pub(super) fn rate_hz_and_jitter_s(&self) -> Option<(f64, f64)> {
        let mut steps: Vec<f64> = self.steps.iter().copied().filter(|step| *step >= 0.0).collect();
        steps.sort_by(f64::total_cmp);
        let median = *steps.get(steps.len() / 2)?;
        let regular = &steps[..steps.partition_point(|step| *step <= GAP_STEPS * median)];
        let mean = regular.iter().sum::<f64>() / regular.len() as f64;
        let variance = regular.iter().map(|step| (step - mean).powi(2)).sum::<f64>() / regular.len() as f64;
        (mean > 0.0).then(|| (1.0 / mean, variance.sqrt()))
    }
}

/// The values of a signal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    pub(super) samples: u64,
    pub(super) missing: u64,
    pub(super) min: f64,
    pub(super) max: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { samples: 0, missing: 0, min: f64::INFINITY, max: f64::NEG_INFINITY }
    }
}

impl Range {
    pub(super) fn add(&mut self, value: f64) {
        if value.is_nan() {
            self.missing += 1;
            return;
        }
        self.samples += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_jitter_of_a_long_log_with_gaps() {
        let mut clock = Clock::default();
        // 2 ms and 2.5 ms in turn, and every thousandth sample a gap of a second: mean 2.25 ms, sd 0.25 ms.
        let mut time_s = 100.0;
        for i in 0..1_000_000 {
            clock.tick(time_s);
            time_s += if i % 1000 == 999 {
                1.0
            } else if i % 3 == 0 {
                2.0e-3
            } else {
                2.75e-3
            };
        }
        let (rate, jitter) = clock.rate_hz_and_jitter_s().unwrap();
        // A third of the steps is 2 ms, the others 2.75: mean 2.5 ms, sd 0.75 sqrt(2) / 3 ms. Of 2048 kept steps the
        // share of a third may be off by some percent.
        assert!((rate - 400.0).abs() < 6.0, "{rate}");
        assert!((jitter - 0.75e-3 * 2f64.sqrt() / 3.0).abs() < 2e-5, "{jitter}");
        assert!(clock.steps.len() <= KEPT_STEPS && clock.samples() == 1_000_000);
        assert_eq!(clock.span_s().map(|(first, _)| first), Some(100.0));
    }

    #[test]
    fn little_is_no_rate() {
        let mut clock = Clock::default();
        assert_eq!(clock.span_s(), None);
        clock.tick(1.0);
        assert!(clock.rate_hz_and_jitter_s().is_none());
        clock.tick(1.0);
        assert!(clock.rate_hz_and_jitter_s().is_none());
        let mut range = Range::default();
        [3.0, f64::NAN, -1.0].into_iter().for_each(|value| range.add(value));
        assert_eq!((range.samples, range.missing, range.min, range.max), (2, 1, -1.0, 3.0));
    }
}
