//! What the shared road, and words of the spectra, say of the tires now (docs/math/shared-road.md).

use nalgebra::{SMatrix, SVector};

use crate::belief::tire_scale::LEAST_COMPLIANCE;
use crate::inter_axle::SharedRoad;
use crate::real::Real;

/// Share by which a tire's sd grows while it surely moves: modes are few, leaks are not.
const MOVING_SD: f64 = 0.5;
/// Sd of the tires' stiffness in the vehicle file, of all alike and of each by itself, as a share: what nobody can learn before
/// a reset.
const FILE_SD: [f64; 2] = [0.015, 0.005];

/// See the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CarBelief<T: Real> {
    /// Stiffnesses in N/m, in the order of the corners.
    pub(crate) stiffness_n_per_m: SVector<T, 4>,
    pub(crate) covariance: SMatrix<T, 4, 4>,
    /// Probability that a pressure is changing.
    pub(crate) changing: T,
    /// Seconds of shared road that it rests on.
    pub(crate) learned_s: T,
}

impl<T: Real> SharedRoad<T> {
    /// What is believed now.
    pub(crate) fn belief(&self) -> CarBelief<T> {
        let age_s = self.newest_s - self.believed_s;
        let age_s = if age_s > 0.0 { T::lit(age_s.min(1.0)) } else { T::zero() };
        // What is believed of a front tire is as old as the road under the rear wheel.
        let ages = [age_s + self.delay_s[0], age_s + self.delay_s[1], age_s, age_s];
        let (mean, mut covariance) = self.bank.tires(&ages);
        let [all, each] = if self.calibrated { [T::zero(); 2] } else { FILE_SD.map(|sd| T::lit(sd * sd)) };
        covariance += SMatrix::from_fn(|i, j| if i == j { all + each } else { all });
        let floor = T::lit(LEAST_COMPLIANCE);
        let stiffness =
            SVector::<T, 4>::from_fn(|i, _| self.scale.placard_n_per_m[i] / (T::one() + mean[i]).max(floor));
        let changing = self.bank.changing_tires();
        let by = SVector::<T, 4>::from_fn(|i, _| {
            (T::one() + T::lit(MOVING_SD) * changing[i]) * stiffness[i] / (T::one() + mean[i]).max(floor)
        });
        let mut belief = CarBelief {
            stiffness_n_per_m: stiffness,
            covariance: SMatrix::from_fn(|i, j| by[i] * by[j] * covariance[(i, j)]),
            changing: self.bank.changing(),
            learned_s: T::lit(self.seconds_learned()),
        };
        for (i, alone) in self.alone.iter().enumerate() {
            let (bias, variance) = self.pseudo_measurement_bias(i);
            let file = (all + each) * alone.stiffness_n_per_m * alone.stiffness_n_per_m;
            alone.blend(&mut belief, i, self.pairs[i % 2].lasting_incoherence(), (bias, variance + file));
        }
        belief
    }
}
