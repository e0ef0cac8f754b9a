//! Statistics of a clock and of a signal, from a stream of any length. Called by the lists of each format.

/// So many steps say what is a gap.
const FIRST_STEPS: usize = 2048;
/// A step of more than this many median ones is a gap, as in drive logs.
const GAP_STEPS: f64 = 3.0;

/// The clock of a message or channel group.
#[derive(Debug, Clone, Default)]
pub(super) struct Clock {
    samples: u64,
    first_s: Option<f64>,
    last_s: f64,
    /// The first steps, until there are enough.
    steps: Vec<f64>,
    regular: Option<Regular>,
}

/// Steps that are no gaps: their number, mean and sum of squares about it (Welford's recursion).
#[derive(Debug, Clone, Copy)]
struct Regular {
    longest_s: f64,
    count: u64,
    mean_s: f64,
    squares: f64,
}

impl Regular {
    /// The regular step among the first ones; `None` without any.
    fn of(steps: &[f64]) -> Option<Self> {
        let mut sorted = steps.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = *sorted.get(sorted.len() / 2)?;
        let mut regular = Self { longest_s: GAP_STEPS * median, count: 0, mean_s: 0.0, squares: 0.0 };
        steps.iter().for_each(|step| regular.add(*step));
        Some(regular)
    }

    fn add(&mut self, step_s: f64) {
        if !(step_s <= self.longest_s) {
            return;
        }
        self.count += 1;
        let off = step_s - self.mean_s;
        self.mean_s += off / self.count as f64;
        self.squares += off * (step_s - self.mean_s);
    }
}

impl Clock {
    pub(super) fn tick(&mut self, time_s: f64) {
        self.samples += 1;
        if !time_s.is_finite() {
            return;
        }
        let step_s = time_s - self.last_s;
        if self.first_s.is_none() {
            self.first_s = Some(time_s);
        } else if step_s >= 0.0 {
            match &mut self.regular {
                Some(regular) => regular.add(step_s),
                None => {
                    self.steps.push(step_s);
                    if self.steps.len() == FIRST_STEPS {
                        self.regular = Regular::of(&std::mem::take(&mut self.steps));
                    }
                }
            }
        }
        self.last_s = time_s;
    }

    pub(super) fn samples(&self) -> u64 {
        self.samples
    }

    /// First and last time in s, if there is any.
    pub(super) fn span_s(&self) -> Option<(f64, f64)> {
        self.first_s.map(|first_s| (first_s, self.last_s))
    }

    /// Samples per second: the inverse of the mean step, gaps left out, rounded to a whole number where it is within
    /// 0.1 % of one; and the steps' standard deviation in s. `None` below two samples or where time stands still.
    pub(super) fn rate_hz_and_jitter_s(&self) -> Option<(f64, f64)> {
        let regular = self.regular.or_else(|| Regular::of(&self.steps))?;
        if !(regular.mean_s > 0.0) {
            return None;
        }
        let rate_hz = 1.0 / regular.mean_s;
        let whole = rate_hz.round();
        let rate_hz = if (rate_hz / whole - 1.0).abs() < 1e-3 { whole } else { rate_hz };
        Some((rate_hz, (regular.squares / regular.count as f64).max(0.0).sqrt()))
    }
}

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

    #[cfg(feature = "can")]
    pub(super) fn and(self, other: &Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            missing: self.missing + other.missing,
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_jitter_of_a_long_log_with_gaps() {
        let mut clock = Clock::default();
        // Of three steps one is 2 ms and two are 2.75 ms; every thousandth is a gap of a second.
        let mut time_s = 100.0;
        for i in 0..300_000 {
            clock.tick(time_s);
            let step_s = if i % 3 == 0 { 2.0e-3 } else { 2.75e-3 };
            time_s += if i % 1000 == 999 { 1.0 } else { step_s };
        }
        let (rate, jitter) = clock.rate_hz_and_jitter_s().unwrap();
        // Mean 2.5 ms; sd 0.75 sqrt(2) / 3 ms. The gaps fall on either step, which moves both by less than 1e-4 of them.
        assert_eq!(rate, 400.0);
        assert!((jitter / (0.75e-3 * 2f64.sqrt() / 3.0) - 1.0).abs() < 1e-3, "{jitter}");
        assert_eq!((clock.samples(), clock.span_s().map(|(first, _)| first)), (300_000, Some(100.0)));
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
