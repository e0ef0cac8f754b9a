//! Gaussians added up to one with their mean and covariance. Used by the modes where ways of moving meet; knows nothing of them.

use super::modes::Mode;
use super::parameters::{Covariance, State};
use crate::real::Real;

/// Gaussians added up to one.
pub(super) struct Mixture<T: Real> {
    weight: T,
    sum: State<T>,
    square: Covariance<T>,
    /// The first one's mean, around which squares are taken.
    around: Option<State<T>>,
}

impl<T: Real> Mixture<T> {
    pub(super) fn new() -> Self {
        Self { weight: T::zero(), sum: State::zeros(), square: Covariance::zeros(), around: None }
    }

    pub(super) fn add(&mut self, weight: T, mean: &State<T>, covariance: &Covariance<T>) {
        let around = *self.around.get_or_insert(*mean);
        let off = mean - around;
        // A weight of nothing still leaves a usable Gaussian.
        let weight = weight.max(T::lit(1e-30));
        self.weight += weight;
        self.sum += off * weight;
        self.square += (covariance + off * off.transpose()) * weight;
    }

    pub(super) fn into_mode(self) -> Mode<T> {
        let off = self.sum / self.weight;
        let around = self.around.unwrap_or_else(State::zeros);
        let covariance = self.square / self.weight - off * off.transpose();
        Mode { mean: around + off, covariance, weight: self.weight }
    }
}
