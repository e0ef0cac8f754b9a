//! What each tire has lost in this drive, in kPa, by itself and against the others (docs/math/level-and-loss.md, eq. 3 and 4). The level's
//! error is in none of it. What the vehicle file leaves open is a share of the loss: it says how much was lost, and not whether.

use nalgebra::SVector;

use super::considered::{CALIBRATED_SD, Considered};
use super::fusion::FusedLosses;
use crate::model::Loss;
use crate::real::Real;

impl<T: Real> Considered<T> {
    /// Of tires that have lost so much stiffness.
    pub(super) fn losses(&self, fused: &FusedLosses<T>) -> [Loss<T>; 4] {
        let FusedLosses { level_n_per_m, lost_n_per_m, covariance, .. } = fused;
        let is_there = |i: usize| self.per_kpa[i] > T::zero();
        let kpa = |i: usize, n_per_m: T| if is_there(i) { n_per_m / self.per_kpa[i] } else { T::zero() };
        let lost = SVector::<T, 4>::from_fn(|i, _| kpa(i, lost_n_per_m[i]));
        let level = SVector::<T, 4>::from_fn(|i, _| {
            self.placard_kpa[i] + kpa(i, level_n_per_m[i] - self.placard_n_per_m[i])
        });
        // What the signals tell, and what another road may make of each tire on its own.
        let by_signals = |weights: &SVector<T, 4>| {
            let by = SVector::<T, 4>::from_fn(|i, _| kpa(i, weights[i]));
            by.dot(&(covariance * by)).max(T::zero())
        };
        let variance = |weights: &SVector<T, 4>| {
            let road =
                |i: usize| kpa(i, T::lit(CALIBRATED_SD) * (level_n_per_m[i] - lost_n_per_m[i])) * weights[i];
            by_signals(weights) + (0..4).fold(T::zero(), |sum, i| sum + road(i) * road(i))
        };
        core::array::from_fn(|i| {
            let mut weights = SVector::<T, 4>::zeros();
            weights[i] = T::one();
            let (lost_kpa, change_sd_kpa) = (lost[i], by_signals(&weights).sqrt());
            let lost_sd_kpa = (variance(&weights) + self.relative[(i, i)] * lost_kpa * lost_kpa).sqrt();
            let others = (0..4).filter(|&j| j != i && is_there(j) && level[j] > T::zero());
            let count = T::lit(others.clone().count().max(1) as f64);
            let on_average = others.clone().fold(T::zero(), |sum, j| sum + lost[j] / level[j]) / count;
            // What the others gain, they gain by being warmer: that this one is not as warm is no loss.
            if on_average > T::zero() {
                others.for_each(|j| weights[j] = -level[i] / (level[j] * count));
            }
            Loss {
                level_kpa: level[i],
                lost_kpa,
                lost_sd_kpa,
                change_sd_kpa,
                excess_kpa: weights.dot(&lost),
                excess_sd_kpa: variance(&weights).sqrt(),
            }
        })
    }
}
