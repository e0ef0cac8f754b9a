//! What is believed of the tires at a moment, over all hypotheses: enough to say it for any moment after, in which those that change
//! go on at their rates.

use nalgebra::{SMatrix, SVector};

use super::gaussian::Hypothesis;
use super::state::{RATE, TIRE};
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Tires<T: Real> {
    pub(super) time_s: f64,
    /// Means of the compliances, and of their rates; the products of both.
    mean: SVector<T, 4>,
    rate: SVector<T, 4>,
    square: SMatrix<T, 4, 4>,
    rate_by_mean: SMatrix<T, 4, 4>,
    rate_square: SMatrix<T, 4, 4>,
    /// Means of the losses, their products, and those with the compliances; whether they are counted.
    loss: SVector<T, 4>,
    loss_square: SMatrix<T, 4, 4>,
    loss_by_mean: SMatrix<T, 4, 4>,
    pub(super) count_losses: bool,
    /// Probability that each tire changes, and that any does.
    pub(crate) changing: [T; 4],
    pub(crate) any_changes: T,
}

impl<T: Real> Tires<T> {
    /// Of no hypothesis.
    pub(super) fn clear(&mut self) {
        for of_each in [&mut self.mean, &mut self.rate, &mut self.loss] {
            of_each.fill(T::zero());
        }
        for products in [
            &mut self.square,
            &mut self.rate_by_mean,
            &mut self.rate_square,
            &mut self.loss_square,
            &mut self.loss_by_mean,
        ] {
            products.fill(T::zero());
        }
    }

    /// Adds a hypothesis of this weight in which those compliances follow the rate that are `changing`.
    pub(super) fn add(&mut self, hypothesis: &Hypothesis<T>, weight: T, changing: &[T; 4]) {
        let Hypothesis { mean, covariance, .. } = hypothesis;
        let rate = mean[RATE];
        for (i, corner) in Corner::ALL.into_iter().enumerate() {
            let tire = mean[TIRE + i];
            self.mean[i] += weight * tire;
            self.rate[i] += weight * changing[i] * rate;
            let loss = hypothesis.loss(corner);
            self.loss[i] += weight * loss;
            for j in 0..4 {
                if changing[i] > T::zero() {
                    let both = covariance[(RATE, TIRE + j)] + rate * mean[TIRE + j];
                    self.rate_by_mean[(i, j)] += weight * both;
                    let square = covariance[(RATE, RATE)] + rate * rate;
                    self.rate_square[(i, j)] += weight * changing[j] * square;
                }
            }
            for (j, other) in Corner::ALL.into_iter().enumerate() {
                self.loss_square[(i, j)] +=
                    weight * (hypothesis.loss_covariance(corner, other) + loss * hypothesis.loss(other));
                self.loss_by_mean[(i, j)] +=
                    weight * (hypothesis.loss_by_tire(corner, other) + loss * mean[TIRE + j]);
                self.square[(i, j)] += weight * (covariance[(TIRE + i, TIRE + j)] + tire * mean[TIRE + j]);
            }
        }
    }

    /// Mean and covariance of the compliances, each so many seconds later.
    pub(crate) fn after(&self, seconds: &[T; 4]) -> (SVector<T, 4>, SMatrix<T, 4, 4>) {
        let mean = SVector::<T, 4>::from_fn(|i, _| self.mean[i] + seconds[i] * self.rate[i]);
        let covariance = SMatrix::from_fn(|i, j| {
            let (by_i, by_j) = (seconds[i], seconds[j]);
            self.square[(i, j)]
                + by_i * self.rate_by_mean[(i, j)]
                + by_j * self.rate_by_mean[(j, i)]
                + by_i * by_j * self.rate_square[(i, j)]
                - mean[i] * mean[j]
        });
        (mean, covariance)
    }

    /// What each tire has lost in this drive, as a compliance, so many seconds later, the covariance of that, and the covariance of losses
    /// (rows) with compliances; `None` as long as losses are not counted.
    pub(crate) fn losses_after(&self, seconds: &[T; 4]) -> Option<(SVector<T, 4>, [SMatrix<T, 4, 4>; 2])> {
        self.count_losses.then(|| {
            let mean = SVector::from_fn(|i, _| self.loss[i] + seconds[i] * self.rate[i]);
            let own = self.loss_square - self.loss * self.loss.transpose();
            (mean, [own, self.loss_by_mean - self.loss * self.mean.transpose()])
        })
    }

    pub(crate) fn time_s(&self) -> f64 {
        self.time_s
    }
}
