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

    /// Takes a stretch of both.
    pub(super) fn take(&mut self, first: &[f64], later: &[f64]) {
        for lag in 0..LAGS {
            let pairs = first[..STRETCH - LAGS].iter().zip(&later[lag..STRETCH - LAGS + lag]);
            for (first, later) in pairs {
                self.cross[lag] += first * later;
                self.first[lag] += first * first;
                self.later[lag] += later * later;
            }
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
