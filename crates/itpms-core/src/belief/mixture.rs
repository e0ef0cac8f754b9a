//! Gaussians added up to one with their mean and covariance. Used by the hypotheses where ways of moving meet; knows nothing of them.

use super::gaussian::Hypothesis;
use super::state::{Covariance, SIZE, State};
use crate::real::Real;

/// Gaussians added up to one.
pub(crate) struct Mixture<T: Real> {
    weight: T,
    sum: State<T>,
    square: Covariance<T>,
    /// The first one's mean, around which squares are taken.
    around: Option<State<T>>,
}

impl<T: Real> Mixture<T> {
    pub(crate) fn new() -> Self {
        Self { weight: T::zero(), sum: State::zeros(), square: Covariance::zeros(), around: None }
    }

    /// Adds a Gaussian with this weight, whatever its own.
    pub(crate) fn add(&mut self, weight: T, hypothesis: &Hypothesis<T>) {
        let around = *self.around.get_or_insert(hypothesis.mean);
        let off = hypothesis.mean - around;
        // A weight of nothing still leaves a usable Gaussian.
        let weight = weight.max(T::lit(1e-30));
        self.weight += weight;
        self.sum += off * weight;
        // Entry by entry, as matrices in between would be the largest things on the stack.
        for j in 0..SIZE {
            for i in 0..SIZE {
                self.square[(i, j)] += (hypothesis.covariance[(i, j)] + off[i] * off[j]) * weight;
            }
        }
    }

    pub(crate) fn into_hypothesis(self) -> Hypothesis<T> {
        let off = self.sum / self.weight;
        let around = self.around.unwrap_or_else(State::zeros);
        let mut hypothesis = Hypothesis { mean: around + off, covariance: self.square, weight: self.weight };
        for j in 0..SIZE {
            for i in 0..SIZE {
                hypothesis.covariance[(i, j)] = hypothesis.covariance[(i, j)] / self.weight - off[i] * off[j];
            }
        }
        hypothesis
    }
}
