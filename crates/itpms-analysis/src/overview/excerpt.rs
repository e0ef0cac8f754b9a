//! The two seconds of a corner in which its wheel moves most, sample by sample. Filled by `Overview`, read by `page`.

const LENGTH_S: f64 = 2.0;

/// A row: time in s, acceleration of the body and of the wheel in m/s².
type Row = (f64, f64, f64);

/// The window that runs along, and the liveliest so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Excerpt {
    running: Vec<Row>,
    best: Vec<Row>,
    best_variance: f64,
}

impl Excerpt {
    /// Takes a row; a missing value is a gap in the curve.
    pub(super) fn push(&mut self, time_s: f64, body_m_s2: f64, wheel_m_s2: f64) {
        let begins_s = self.running.first().map_or(time_s, |row| row.0);
        if time_s - begins_s >= LENGTH_S {
            self.close();
        }
        self.running.push((time_s, body_m_s2, wheel_m_s2));
    }

    fn close(&mut self) {
        let variance = variance(&self.running);
        if self.best.is_empty() || variance > self.best_variance {
            std::mem::swap(&mut self.best, &mut self.running);
            self.best_variance = variance;
        }
        self.running.clear();
    }

    /// The rows; a log shorter than the window gives what it has.
    pub(super) fn finish(mut self) -> Vec<Row> {
        self.close();
        self.best
    }
}

fn variance(rows: &[Row]) -> f64 {
    let values = || rows.iter().map(|row| row.2).filter(|value| value.is_finite());
    let count = values().count().max(1) as f64;
    let mean = values().sum::<f64>() / count;
    values().map(|value| (value - mean).powi(2)).sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_liveliest_two_seconds_are_kept() {
        let mut excerpt = Excerpt::default();
        for i in 0..10_000 {
            let time_s = f64::from(i) * 0.01;
            // An offset before it is no motion.
            let (loud, offset) = if (40.0..44.0).contains(&time_s) { (3.0, 0.0) } else { (1.0, 8.0) };
            excerpt.push(time_s, 0.0, offset + loud * f64::from(i % 2));
        }
        let rows = excerpt.finish();
        assert_eq!(rows.len(), 200);
        assert!(rows[0].0 >= 39.9 && rows[199].0 < 44.1, "{:?}", rows[0]);
    }

    #[test]
    fn a_short_log_is_its_own_excerpt() {
        let mut excerpt = Excerpt::default();
        excerpt.push(5.0, 1.0, f64::NAN);
        excerpt.push(5.01, 1.0, 2.0);
        assert_eq!(excerpt.finish().len(), 2);
        assert!(Excerpt::default().finish().is_empty());
    }
}
