//! Loss of each tire in this drive in kPa, by itself and against the others (docs/math/level-and-loss.md, eq. 3 and 4). The level's
//! error is in none of it. What the vehicle file leaves open is a share of the loss: it says how much was lost, and not whether.

use nalgebra::{SMatrix, SVector};

use super::considered::Considered;
use super::fusion::FusedLosses;
use crate::model::{Corner, Loss};
use crate::real::Real;

/// A tire below this share of its placard pressure, or of its axle's other tire's share, may have lost air before losses were counted.
const UNHARMED: f64 = 0.9;

impl<T: Real> Considered<T> {
    /// Of tires that have lost so much stiffness, the standard deviations of whose pressures are `sds_kpa`.
    /// With the covariance of their errors in kPa², but for what the vehicle file leaves open.
    pub(super) fn losses(
        &self,
        fused: &FusedLosses<T>,
        sds_kpa: &[Option<T>; 4],
    ) -> ([Loss<T>; 4], SMatrix<T, 4, 4>) {
        let FusedLosses { level_n_per_m, lost_n_per_m, covariance, .. } = fused;
        let is_there = |i: usize| self.per_kpa[i] > T::zero();
        let kpa = |i: usize, n_per_m: T| if is_there(i) { n_per_m / self.per_kpa[i] } else { T::zero() };
        let lost = SVector::<T, 4>::from_fn(|i, _| kpa(i, lost_n_per_m[i]));
        let level = SVector::<T, 4>::from_fn(|i, _| {
            self.placard_kpa[i] + kpa(i, level_n_per_m[i] - self.placard_n_per_m[i])
        });
        // What the signals tell, and with it what another road may make of the tires.
        let by_signals = |weights: &SVector<T, 4>| {
            let by = SVector::<T, 4>::from_fn(|i, _| kpa(i, weights[i]));
            by.dot(&(covariance * by)).max(T::zero())
        };
        let roads = self.between_roads();
        let errors: SMatrix<T, 4, 4> = SMatrix::from_fn(|i, j| {
            let now = |i: usize| kpa(i, level_n_per_m[i] - lost_n_per_m[i]);
            kpa(i, T::one()) * kpa(j, T::one()) * covariance[(i, j)] + roads[(i, j)] * now(i) * now(j)
        });
        let variance = |weights: &SVector<T, 4>| weights.dot(&(errors * weights)).max(T::zero());
        let losses = core::array::from_fn(|i| {
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
            let share = |wheel: Corner| level[wheel.index()] / self.placard_kpa[wheel.index()];
            let other = [Corner::ALL[i].same_axle(), Corner::ALL[i].same_side()];
            let other = other.into_iter().find(|other| is_there(other.index())).map_or(T::zero(), share);
            let highest = level[i] + T::lit(2.0) * sds_kpa[i].unwrap_or(T::zero());
            let unharmed = T::lit(UNHARMED) * self.placard_kpa[i];
            Loss {
                level_kpa: level[i],
                is_whole: u8::from(level[i] >= unharmed * other && highest >= unharmed),
                lost_kpa,
                lost_sd_kpa,
                change_sd_kpa,
                excess_kpa: weights.dot(&lost),
                excess_sd_kpa: variance(&weights).sqrt(),
            }
        });
        (losses, errors)
    }
}
