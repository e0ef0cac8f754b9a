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
    pub(crate) moving: T,
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
        let (mean, mut covariance) = self.modes.tires(&ages);
        let [all, each] = if self.told { [T::zero(); 2] } else { FILE_SD.map(|sd| T::lit(sd * sd)) };
        covariance += SMatrix::from_fn(|i, j| if i == j { all + each } else { all });
        let floor = T::lit(LEAST_COMPLIANCE);
        let stiffness =
            SVector::<T, 4>::from_fn(|i, _| self.scale.placard_n_per_m[i] / (T::one() + mean[i]).max(floor));
        let moving = self.modes.moving_tires();
        let by = SVector::<T, 4>::from_fn(|i, _| {
            (T::one() + T::lit(MOVING_SD) * moving[i]) * stiffness[i] / (T::one() + mean[i]).max(floor)
        });
        let mut belief = CarBelief {
            stiffness_n_per_m: stiffness,
            covariance: SMatrix::from_fn(|i, j| by[i] * by[j] * covariance[(i, j)]),
            moving: self.modes.moving(),
            learned_s: T::lit(self.seconds_learned()),
        };
        for (i, alone) in self.alone.iter().enumerate() {
            let (bias, variance) = self.word_bias(i);
            let file = (all + each) * alone.stiffness_n_per_m * alone.stiffness_n_per_m;
            alone.mix_into(&mut belief, i, self.tracks[i % 2].lasting_incoherence(), (bias, variance + file));
        }
        belief
    }
}
