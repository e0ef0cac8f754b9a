//! Present estimate of the tires from the fused belief (docs/math/shared-road.md).

use nalgebra::{SMatrix, SVector};

use super::Fusion;
use crate::belief::LEAST_COMPLIANCE;
use crate::belief::state::COUPLING;
use crate::model::Corner;
use crate::real::Real;

/// Share by which a tire's sd grows while it surely changes: hypotheses are few, leaks are not.
const CHANGING_SD: f64 = 0.5;
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::car) struct FusedEstimate<T: Real> {
    /// Stiffnesses in N/m, in the order of the corners.
    pub(in crate::car) stiffness_n_per_m: SVector<T, 4>,
    /// Their covariance in (N/m)², as far as the signals tell; what the vehicle file leaves open is not in it.
    pub(in crate::car) covariance: SMatrix<T, 4, 4>,
    /// Probability that a pressure is changing.
    pub(in crate::car) changing: T,
    /// Seconds of shared road that it rests on.
    pub(in crate::car) learned_s: T,
    /// Loss in this drive, if that is counted.
    pub(in crate::car) losses: Option<FusedLosses<T>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::car) struct FusedLosses<T: Real> {
    pub(in crate::car) level_n_per_m: SVector<T, 4>,
    /// What of them was lost since then, its covariance in (N/m)², and that of losses (rows) with the stiffnesses now.
    pub(in crate::car) lost_n_per_m: SVector<T, 4>,
    pub(in crate::car) covariance: SMatrix<T, 4, 4>,
    pub(in crate::car) by_stiffness: SMatrix<T, 4, 4>,
}

impl<T: Real> Fusion<T> {
    /// Share of a rear wheel's unsprung mass that moves with the other one.
    pub(in crate::car) fn axle_coupling(&self) -> T {
        self.belief.most_likely().mean[COUPLING]
    }

    /// Present belief; in the middle of a frame, the one before it.
    pub(in crate::car) fn estimate(&mut self) -> FusedEstimate<T> {
        if self.is_at_rest() {
            self.belief.refresh(&mut self.tires);
        }
        let age_s = self.inter_axle.travel().time_s() - self.tires.time_s();
        let age_s = if age_s > 0.0 { T::lit(age_s.min(1.0)) } else { T::zero() };
        // What is believed of a front tire is as old as the road under the rear wheel.
        let delay_s = self.inter_axle.delay_s();
        let ages = [age_s + delay_s[0], age_s + delay_s[1], age_s, age_s];
        let (mean, covariance) = self.tires.after(&ages);
        let floor = T::lit(LEAST_COMPLIANCE);
        let placard_n_per_m = &self.belief.scale().placard_n_per_m;
        let stiffness = SVector::<T, 4>::from_fn(|i, _| placard_n_per_m[i] / (T::one() + mean[i]).max(floor));
        let (changing_tires, changing) = (self.tires.changing, self.tires.any_changes);
        let by = SVector::<T, 4>::from_fn(|i, _| {
            (T::one() + T::lit(CHANGING_SD) * changing_tires[i]) * stiffness[i]
                / (T::one() + mean[i]).max(floor)
        });
        let mut estimate = FusedEstimate {
            stiffness_n_per_m: stiffness,
            covariance: SMatrix::from_fn(|i, j| by[i] * by[j] * covariance[(i, j)]),
            changing,
            learned_s: T::lit(self.learned_s()),
            losses: self.tires.losses_after(&ages).map(|(lost, [covariance, by_compliance])| {
                let level = |i: usize| placard_n_per_m[i] / (T::one() + mean[i] - lost[i]).max(floor);
                let level_n_per_m = SVector::<T, 4>::from_fn(|i, _| level(i));
                FusedLosses {
                    level_n_per_m,
                    lost_n_per_m: level_n_per_m - stiffness,
                    covariance: SMatrix::from_fn(|i, j| by[i] * by[j] * covariance[(i, j)]),
                    by_stiffness: SMatrix::from_fn(|i, j| -by[i] * by[j] * by_compliance[(i, j)]),
                }
            }),
        };
        for corner in Corner::ALL {
            let incoherence = self.inter_axle.pairs[corner.side()].lasting_incoherence();
            let bias = || self.spectral_bias(corner);
            self.single_wheel[corner].blend(&mut estimate, corner, incoherence, bias);
        }
        estimate
    }
}
