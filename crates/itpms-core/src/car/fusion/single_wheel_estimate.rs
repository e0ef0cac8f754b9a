//! A corner's own estimate from its road's spectrum, and how far that counts where front and rear hardly share a
//! road (docs/math/shared-road.md, section 6). Knows nothing of frames and hypotheses.

use super::FusedEstimate;
use crate::inter_axle::residual::noise::within;
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Lasting incoherence at which a corner's own suspicion counts half, how much of it is usual, and the chance per second that
/// the wheel begins to move if it is sure.
const LOST: f64 = 0.1;
const USUALLY_SUSPECTED: f64 = 0.3;
const BEGIN_SUSPECTED: f64 = 4.0;
/// Lasting incoherence at which a corner that finds its pressure moving is believed as much as the shared road, and the chances of a
/// change from which on, and at which fully, it counts.
const LEFT: f64 = 0.06;
const NOTICED: f64 = 0.1;
const BELIEVED: f64 = 0.5;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::car) struct SingleWheelEstimate<T> {
    /// Probability that its pressure is changing; NaN where it is not estimated.
    pub(in crate::car) changing: T,
    pub(in crate::car) stiffness_n_per_m: T,
    pub(in crate::car) sd_n_per_m: T,
}

impl<T: Real> SingleWheelEstimate<T> {
    /// Chance per second that the pressure begins to move because the corner's own spectrum looks like it: where front and
    /// rear share the road, their frames tell sooner and surer, and where they part for seconds only, as in a bend, a hole that
    /// each of them meets by itself looks like a leak.
    pub(in crate::car) fn onset_rate(&self, incoherence: T) -> T {
        let surely = (self.changing - T::lit(USUALLY_SUSPECTED)).max(T::zero());
        // NaN suspects nothing.
        (T::lit(BEGIN_SUSPECTED) * surely * (T::one() - within(incoherence, LOST))).max(T::zero())
    }

    /// How far the corner is to be believed instead of the shared road, 0 to 1, at an incoherence that has lasted.
    fn share(&self, incoherence: T) -> T {
        let noticed = (self.changing - T::lit(NOTICED)) / T::lit(BELIEVED - NOTICED);
        let share = noticed.max(T::zero()).min(T::one()) * (T::one() - within(incoherence, LEFT));
        if share.is_finite() && self.stiffness_n_per_m.is_finite() && self.sd_n_per_m.is_finite() {
            share
        } else {
            T::zero()
        }
    }

    /// Mixes what the corner finds into a belief, less the bias of its spectrum in N/m, which is known up to a variance: both
    /// may be right, so the sd holds how far they are apart.
    pub(in crate::car) fn blend(
        &self,
        belief: &mut FusedEstimate<T>,
        corner: Corner,
        incoherence: T,
        bias: impl FnOnce() -> (T, T),
    ) {
        let share = self.share(incoherence);
        if !(share > T::zero()) {
            return;
        }
        let (bias, corner) = (bias(), corner.index());
        let (others, residual) =
            (T::one() - share, self.stiffness_n_per_m - bias.0 - belief.stiffness_n_per_m[corner]);
        let own_variance = self.sd_n_per_m * self.sd_n_per_m + bias.1;
        let variance = others * belief.covariance[(corner, corner)]
            + share * own_variance
            + share * others * residual * residual;
        belief.stiffness_n_per_m[corner] += share * residual;
        belief.covariance.row_mut(corner).scale_mut(others);
        belief.covariance.column_mut(corner).scale_mut(others);
        belief.covariance[(corner, corner)] = variance;
        belief.changing = belief.changing.max(share * self.changing);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};

    use super::*;

    fn belief() -> FusedEstimate<f64> {
        // Four tires known up to 2 kN/m, half of it common to all.
        let covariance = SMatrix::from_fn(|i, j| if i == j { 4e6 } else { 2e6 });
        FusedEstimate {
            stiffness_n_per_m: SVector::repeat(230e3),
            covariance,
            changing: 0.2,
            learned_s: 60.0,
            losses: None,
        }
    }

    fn low(changing: f64) -> SingleWheelEstimate<f64> {
        SingleWheelEstimate { changing, stiffness_n_per_m: 190e3, sd_n_per_m: 6e3 }
    }

    #[test]
    fn half_believed_is_the_mean_of_both_and_as_unsure_as_they_are_apart() {
        let mut mixed = belief();
        // A spectrum that reads 4 kN/m too much, up to 3 kN/m.
        low(0.8).blend(&mut mixed, Corner::FrontRight, LEFT, || (4e3, 9e6));
        // Either of two Gaussians: 230 ± 2 and 186 ± √45 kN/m.
        let moments = |p: f64| (p * 230e3 + (1.0 - p) * 186e3, p * 4e6 + (1.0 - p) * 45e6);
        let (mean, within) = moments(0.5);
        let between = 0.5 * (230e3 - mean) * (230e3 - mean) + 0.5 * (186e3 - mean) * (186e3 - mean);
        assert!((mixed.stiffness_n_per_m[1] - mean).abs() < 1e-6);
        assert!((mixed.covariance[(1, 1)] - within - between).abs() < 1e-3);
        // What the others know together is shared only as far as the shared road is believed.
        assert_eq!([mixed.covariance[(1, 0)], mixed.covariance[(2, 1)]], [1e6; 2]);
        assert_eq!([mixed.covariance[(0, 0)], mixed.covariance[(3, 2)]], [4e6, 2e6]);
        assert_eq!([mixed.stiffness_n_per_m[0], mixed.changing], [230e3, 0.4]);
        assert!(mixed.covariance.cholesky().is_some());
    }

    #[test]
    fn on_one_road_and_at_rest_the_shared_road_is_believed() {
        // 40 kN/m apart, and hardly moved, however sure the corner is: (0.001/0.06)² of that.
        let mut shared = belief();
        low(1.0).blend(&mut shared, Corner::FrontLeft, 1e-3, || (0.0, 0.0));
        assert!((shared.stiffness_n_per_m[0] - 230e3).abs() < 12.0);
        for incoherence in [1e-3, 0.1, 2.0, f64::NAN] {
            let mut resting = belief();
            low(NOTICED).blend(&mut resting, Corner::FrontLeft, incoherence, || (0.0, 0.0));
            assert_eq!(resting, belief());
        }
    }

    #[test]
    fn a_corner_is_suspicious_where_roads_have_parted_for_long() {
        // Surely moving: 4 (1 - 0.3) per second, half of it where a tenth is not shared, a hundredth of a hundredth on one road.
        assert!((low(1.0).onset_rate(1e3) - 2.8).abs() < 1e-6);
        assert!((low(1.0).onset_rate(LOST) - 1.4).abs() < 1e-12);
        assert!(low(1.0).onset_rate(1e-3) < 3e-4);
        assert_eq!(low(USUALLY_SUSPECTED).onset_rate(1.0), 0.0);
    }

    #[test]
    fn what_is_no_number_is_left_out() {
        let nan = f64::NAN;
        let strange = [
            SingleWheelEstimate::BLANK,
            SingleWheelEstimate { changing: nan, ..low(1.0) },
            SingleWheelEstimate { stiffness_n_per_m: nan, ..low(1.0) },
            SingleWheelEstimate { sd_n_per_m: f64::INFINITY, ..low(1.0) },
        ];
        for alone in strange {
            let mut blended = belief();
            alone.blend(&mut blended, Corner::RearLeft, 0.2, || (0.0, 0.0));
            assert_eq!(blended, belief());
            assert_eq!(alone.onset_rate(nan), 0.0);
        }
    }
}
