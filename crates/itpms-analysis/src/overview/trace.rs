//! A signal over the whole of a log in bounded memory: its statistics, and per stretch of time the lowest value, the
//! highest and the root mean square. Filled by `Overview`, read by `page`.

/// Stretches held at most; beyond, neighbors are joined. A picture has not many more pixels.
const STRETCHES: usize = 512;

/// Statistics of a signal over one stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) count: u64,
    pub(super) low: f64,
    pub(super) high: f64,
    sum: f64,
    squares: f64,
}

impl Stretch {
    const EMPTY: Self =
        Self { count: 0, low: f64::INFINITY, high: f64::NEG_INFINITY, sum: 0.0, squares: 0.0 };

    fn add(&mut self, value: f64) {
        self.count += 1;
        self.low = self.low.min(value);
        self.high = self.high.max(value);
        self.sum += value;
        self.squares += value * value;
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    /// Mean, NaN without a value.
    pub(super) fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Root mean square of the deviation from `center`, NaN without a value.
    pub(super) fn rms_about(&self, center: f64) -> f64 {
        let mean = self.mean();
        let about_mean = (self.squares / self.count as f64 - mean * mean).max(0.0);
        (about_mean + (mean - center).powi(2)).sqrt()
    }
}

/// A signal's course and statistics.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trace {
    start_s: f64,
    width_s: f64,
    stretches: Vec<Stretch>,
    statistics: Running,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    pub samples: u64,
    pub missing: u64,
    /// Mean; this and the next three are NaN without a value.
    pub mean: f64,
    pub sd: f64,
    pub low: f64,
    pub high: f64,
    /// Smallest difference between one value and the next that is not zero: the resolution of a coarse sensor. NaN for a
    /// signal that never changes.
    pub smallest_step: f64,
    /// Values at the highest or the lowest that follow another one there: a signal that is cut off stays at its limit.
    pub repeated_at_limit: u64,
}

/// Welford's recursion, and what else takes no memory.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Running {
    samples: u64,
    missing: u64,
    mean: f64,
    /// Sum of the squared deviations from the mean.
    deviations: f64,
    last: f64,
    smallest_step: f64,
    /// Of the lowest and the highest value so far: the value, and how often it came twice in a row.
    low: (f64, u64),
    high: (f64, u64),
}

impl Running {
    const EMPTY: Self = Self {
        samples: 0,
        missing: 0,
        mean: 0.0,
        deviations: 0.0,
        last: f64::NAN,
        smallest_step: f64::INFINITY,
        low: (f64::INFINITY, 0),
        high: (f64::NEG_INFINITY, 0),
    };

    fn add(&mut self, value: f64) {
        self.samples += 1;
        let off = value - self.mean;
        self.mean += off / self.samples as f64;
        self.deviations += off * (value - self.mean);
        let step = (value - self.last).abs();
        if step > 0.0 {
            self.smallest_step = self.smallest_step.min(step);
        }
        self.last = value;
        if value < self.low.0 {
            self.low = (value, 0);
        }
        if value > self.high.0 {
            self.high = (value, 0);
        }
        for limit in [&mut self.low, &mut self.high] {
            limit.1 += u64::from(value == limit.0 && step == 0.0);
        }
    }
}

impl Trace {
    /// Empty, for samples `step_s` apart that begin at `start_s`.
    pub(super) fn new(start_s: f64, step_s: f64) -> Self {
        Self { start_s, width_s: step_s, stretches: Vec::new(), statistics: Running::EMPTY }
    }

    /// Takes a value, or counts that there is none. Times do not go back.
    pub(super) fn push(&mut self, time_s: f64, value: f64) {
        if !value.is_finite() {
            self.statistics.missing += 1;
            return;
        }
        self.statistics.add(value);
        let mut place = (time_s - self.start_s) / self.width_s;
        while place >= STRETCHES as f64 {
            self.stretches = self.stretches.chunks(2).map(joined).collect();
            self.width_s *= 2.0;
            place /= 2.0;
        }
        let index = place.max(0.0) as usize;
        if self.stretches.len() <= index {
            self.stretches.resize(index + 1, Stretch::EMPTY);
        }
        if let Some(stretch) = self.stretches.get_mut(index) {
            stretch.add(value);
        }
    }

    /// Middle of each stretch in s, and what the signal did in it; stretches without a value are among them.
    pub(super) fn course(&self) -> impl Iterator<Item = (f64, &Stretch)> {
        let middle = |index: usize| self.start_s + (index as f64 + 0.5) * self.width_s;
        self.stretches.iter().enumerate().map(move |(index, stretch)| (middle(index), stretch))
    }

    pub(super) fn statistics(&self) -> Statistics {
        let s = &self.statistics;
        let there = |value: f64| if s.samples > 0 { value } else { f64::NAN };
        Statistics {
            samples: s.samples,
            missing: s.missing,
            mean: there(s.mean),
            sd: there((s.deviations / s.samples.max(1) as f64).sqrt()),
            low: there(s.low.0),
            high: there(s.high.0),
            smallest_step: if s.smallest_step.is_finite() { s.smallest_step } else { f64::NAN },
            repeated_at_limit: s.low.1 + s.high.1,
        }
    }
}

fn joined(pair: &[Stretch]) -> Stretch {
    pair.iter().fold(Stretch::EMPTY, |sum, stretch| sum.join(stretch))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_signal_takes_bounded_memory_and_keeps_its_extremes() {
        let mut trace = Trace::new(100.0, 0.01);
        for i in 0..1_000_000 {
            let spike = if i == 700_000 { 50.0 } else { 0.0 };
            trace.push(100.0 + f64::from(i) * 0.01, f64::from(i % 5) + spike);
        }
        assert!(trace.stretches.len() <= STRETCHES && trace.stretches.len() > STRETCHES / 2 - 1);
        let (time_s, top) = trace.course().max_by(|a, b| a.1.high.total_cmp(&b.1.high)).unwrap();
        assert!((time_s - 7_100.0).abs() < trace.width_s, "{time_s}");
        assert_eq!(top.high, 50.0);
        // Values 0 to 4 in turn: mean 2, rms of 0, 1, 2, 3, 4.
        let (_, first) = trace.course().next().unwrap();
        assert!((first.mean() - 2.0).abs() < 0.01 && (first.rms_about(0.0) - 6f64.sqrt()).abs() < 0.01);
        assert_eq!(trace.course().map(|(_, stretch)| stretch.count).sum::<u64>(), 1_000_000);
    }

    #[test]
    fn statistics_are_those_of_the_definition() {
        let mut trace = Trace::new(0.0, 0.1);
        let values = [1.0, 1.5, f64::NAN, 3.0, 3.0, 3.0, -1.0];
        for (i, value) in values.into_iter().enumerate() {
            trace.push(i as f64 * 0.1, value);
        }
        let s = trace.statistics();
        assert_eq!((s.samples, s.missing, s.low, s.high), (6, 1, -1.0, 3.0));
        assert!((s.mean - 10.5 / 6.0).abs() < 1e-12);
        // Mean of the squares (1 + 2.25 + 27 + 1)/6 less the square of the mean.
        assert!((s.sd - (31.25f64 / 6.0 - 1.75 * 1.75).sqrt()).abs() < 1e-12);
        assert_eq!((s.smallest_step, s.repeated_at_limit), (0.5, 2));
    }

    #[test]
    fn a_signal_without_a_value_has_no_statistics() {
        let mut trace = Trace::new(0.0, 0.1);
        trace.push(0.0, f64::NAN);
        let s = trace.statistics();
        assert_eq!((s.samples, s.missing), (0, 1));
        assert!(s.mean.is_nan() && s.sd.is_nan() && s.low.is_nan() && s.smallest_step.is_nan());
    }
}
