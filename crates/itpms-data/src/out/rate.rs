//! Which rows of a drive become rows of the output: the first one, then the first at or after every further period.
//!
//! Called by whoever writes estimates at another rate than the rows'.

/// Share of a period by which a row may be early: times in a file are rounded.
const EARLY: f64 = 1e-6;

/// Lets rows through at a rate. A value: whoever stops and goes on keeps its two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateGate {
    rate_hz: f64,
    pub start_s: Option<f64>,
    /// Periods after the start that are due next.
    pub due: f64,
}

impl RateGate {
    /// A gate that lets this many rows a second through.
    pub fn new(rate_hz: f64) -> Self {
        Self { rate_hz, start_s: None, due: 0.0 }
    }

    /// Whether the row at this time goes out. Across a gap nothing is made up for.
    pub fn lets_through(&mut self, time_s: f64) -> bool {
        let start_s = *self.start_s.get_or_insert(time_s);
        // A time that counts from 1970 has two digits less than that.
        let early = EARLY + 2.0 * f64::EPSILON * time_s.abs() * self.rate_hz;
        let periods = (time_s - start_s) * self.rate_hz + early;
        if periods < self.due {
            return false;
        }
        self.due = periods.floor() + 1.0;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(rate_hz: f64, times: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut gate = RateGate::new(rate_hz);
        times.filter(|time_s| gate.lets_through(*time_s)).collect()
    }

    #[test]
    fn ten_rows_a_second_whatever_the_sampling() {
        // 40 s at 500 Hz: exactly every 50th row.
        let out = through(10.0, (0..20_000).map(|i| f64::from(i) / 500.0));
        assert_eq!(out.len(), 400);
        assert!(out.iter().zip(0..).all(|(t, i)| *t == f64::from(i * 50) / 500.0));
        // 333 Hz: the first row at or after each tenth.
        let out = through(10.0, (0..3330).map(|i| 5.0 + f64::from(i) / 333.0));
        assert_eq!(out.len(), 100);
        assert!(
            out.iter()
                .zip(0..)
                .all(|(t, i)| (0.0..1.0 / 333.0).contains(&(t - 5.0 - f64::from(i) / 10.0 + 1e-9)))
        );
    }

    #[test]
    fn a_rate_above_the_logs_gives_every_row_and_a_gap_none() {
        assert_eq!(through(1e4, (0..50).map(|i| f64::from(i) / 100.0)).len(), 50);
        assert_eq!(through(10.0, [0.0, 0.05, 7.03, 7.05, 7.1].into_iter()), [0.0, 7.03, 7.1]);
    }
}
