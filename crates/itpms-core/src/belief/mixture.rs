//! Gaussians added up to one with their mean and covariance, in the place of that one. Used by the hypotheses where ways of moving
//! meet; knows nothing of them.

use super::gaussian::{Hypothesis, Part};
use super::state::{RATE, SIZE, State};
use crate::real::Real;

/// Least weight of a Gaussian that is added.
const LEAST: f64 = 1e-30;

/// Gaussians added up to one.
pub(crate) struct Mixture<'a, T: Real> {
    /// Holds the sum of squares meanwhile.
    into: &'a mut Hypothesis<T>,
    weight: T,
    sum: State<T>,
    /// The first one's mean, around which squares are taken.
    around: Option<State<T>>,
}

impl<'a, T: Real> Mixture<'a, T> {
    /// Of nothing yet; what is in the place is lost.
    pub(crate) fn new(into: &'a mut Hypothesis<T>) -> Self {
        into.covariance.clear();
        Self { into, weight: T::zero(), sum: State::zeros(), around: None }
    }

    /// Of what is in the place, with this weight.
    pub(crate) fn around(into: &'a mut Hypothesis<T>, weight: T) -> Self {
        let around = into.mean;
        let weight = weight.max(T::lit(LEAST));
        into.covariance.scale(weight);
        Self { into, weight, sum: State::zeros(), around: Some(around) }
    }

    /// Adds a Gaussian with this weight, whatever its own.
    pub(crate) fn add(&mut self, weight: T, part: &Part<'_, T>) {
        let around = *self.around.get_or_insert(part.mean);
        let off = part.mean - around;
        // A weight of nothing still leaves a usable Gaussian.
        let weight = weight.max(T::lit(LEAST));
        self.weight += weight;
        self.sum += off * weight;
        // The rate, which comes last, has covariances of its own.
        self.into.covariance.add_part(RATE, weight, part.but_for_the_rate(), &off);
        for i in 0..SIZE {
            self.into.covariance[(i, RATE)] += (part.covariance(i, RATE) + off[i] * off[RATE]) * weight;
        }
    }

    /// The one Gaussian is in its place from here on.
    pub(crate) fn finish(self) {
        let share = T::one() / self.weight;
        let off = self.sum * share;
        let around = self.around.unwrap_or_else(State::zeros);
        self.into.covariance.scale_less_product(share, &off);
        self.into.mean = around + off;
        self.into.weight = self.weight;
    }
}
