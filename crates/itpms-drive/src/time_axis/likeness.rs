//! How alike two wheels are, at every distance from one to the other: correlations over stretches of road.

use super::{CELLS, LAGS, OFF, STRETCH};

/// How alike a wheel is to one that comes so many cells later: sums of products, of each side.
#[derive(Debug)]
pub(super) struct Likeness {
    cross: Vec<f64>,
    first: Vec<f64>,
    later: Vec<f64>,
}

impl Likeness {
    pub(super) fn new() -> Self {
        let [cross, first, later] = [(); 3].map(|()| vec![0.0; LAGS]);
        Self { cross, first, later }
    }

    pub(super) fn take(&mut self, first: &[f64], later: &[f64]) {
        const CELLS_TAKEN: usize = STRETCH - LAGS;
        let first = &first[..CELLS_TAKEN];
        let first_square = product(first, first);
        let mut later_square = product(&later[..CELLS_TAKEN], &later[..CELLS_TAKEN]);
        for lag in 0..LAGS {
            let window = &later[lag..lag + CELLS_TAKEN];
            self.cross[lag] += product(first, window);
            self.first[lag] += first_square;
            self.later[lag] += later_square;
            // The window moves on by a cell.
            let (leaves, enters) = (later[lag], later[lag + CELLS_TAKEN]);
            later_square += enters * enters - leaves * leaves;
        }
    }

    /// Correlation at a distance of so many cells; NaN where nothing was taken.
    pub(super) fn at(&self, lag: usize) -> f64 {
        self.cross[lag] / (self.first[lag] * self.later[lag]).sqrt()
    }

    /// The highest near a wheelbase; a shoulder of one elsewhere is none.
    pub(super) fn at_the_wheelbase(&self) -> f64 {
        let near = |lag: &usize| (*lag as f64 / CELLS as f64).ln().abs() <= OFF;
        let is_peak = |lag: &usize| self.at(*lag) >= self.at(lag - 1) && self.at(*lag) >= self.at(lag + 1);
        (1..LAGS - 1).filter(near).filter(is_peak).map(|lag| self.at(lag)).fold(0.0, f64::max)
    }
}

/// Scalar product, in four partial sums that do not wait for one another.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let (fours_a, rest_a) = a.as_chunks::<4>();
    let (fours_b, rest_b) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in fours_a.iter().zip(fours_b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_correlation_at_each_distance() {
        // Two logarithmic sweeps that have no period in common.
        let wheel =
            |rate: f64| -> Vec<f64> { (0..STRETCH).map(|i| (rate * (1.0 + i as f64).ln()).sin()).collect() };
        let (first, later) = (wheel(31.0), wheel(37.0));
        let mut likeness = Likeness::new();
        likeness.take(&first, &later);
        for lag in [0, 1, 17, LAGS - 1] {
            let pairs = || first.iter().zip(&later[lag..]).take(STRETCH - LAGS);
            let of = |value: fn((&f64, &f64)) -> f64| pairs().map(value).sum::<f64>();
            let expected = of(|(a, b)| a * b) / (of(|(a, _)| a * a) * of(|(_, b)| b * b)).sqrt();
            assert!(
                (likeness.at(lag) - expected).abs() < 1e-12,
                "{lag}: {} for {expected}",
                likeness.at(lag)
            );
        }
    }
}
