//! Errors of the tires' stiffnesses by the vehicle file, whatever the signals (docs/math/unknown-car.md, section 4): all masses, forces and
//! stiffnesses of a wheel times one factor give the same accelerations over the same road. So that factor is never learned; its
//! uncertainty is carried along (a Schmidt-Kalman filter's *considered* parameter).

use nalgebra::{SMatrix, SVector};

use crate::memory::Blank;
use crate::model::{CarConfig, Corner, CornerConfig};
use crate::real::Real;

/// Errors of the tires' levels after a calibration, as shares of their stiffness, by the shapes in which errors come (all alike, left against right, front
/// against rear, diagonals): tires are set to 3 kPa, and roads differ.
const CALIBRATED_SDS: [f64; 4] = [0.0125, 0.004, 0.0015, 0.002];
/// Share of what the vehicle file leaves open of all tires' mean that another road than the calibration's shows again: a car that differs from its file
/// in more than one factor reads one road otherwise than another, all tires alike (measured on simulated cars; docs/math/unknown-car.md, section 4).
const ROAD_DEPENDENT: f64 = 0.2;
/// What a car may change besides between a calibration and a later day: load, speed and road, warmth and wear of tires and dampers.
const BETWEEN_DAYS_SDS: [f64; 4] = [0.03, 0.016, 0.008, 0.0045];

/// Covariance of tires' errors that come in these shapes.
fn covariance_of_shapes<T: Real>([all, sides, axles, diagonals]: [f64; 4]) -> SMatrix<T, 4, 4> {
    let [all, sides, axles, diagonals] =
        [all * all, sides * sides, axles * axles, diagonals * diagonals].map(T::lit);
    SMatrix::from_fn(|i, j| match (i % 2 == j % 2, i / 2 == j / 2) {
        (true, true) => all + sides + axles + diagonals,
        (true, false) => all + sides - axles - diagonals,
        (false, true) => all - sides + axles - diagonals,
        (false, false) => all - sides - axles + diagonals,
    })
}

/// Covariance of the factors of the four corners, and the stiffnesses at placard pressure. See the [module](self).
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Considered<T: Real> {
    pub(super) relative: SMatrix<T, 4, 4>,
    /// By how much a rear axle couples its wheels. Where its struts stand and how its mass is spread is in no file: of all tires' stiffness
    /// that leaves open as much again.
    pub(super) coupling: T,
    pub(super) placard_n_per_m: SVector<T, 4>,
    /// Stiffness per pressure in N/m per kPa, and the placard pressures in kPa; zero for corners that are not there.
    pub(super) per_kpa: SVector<T, 4>,
    pub(super) placard_kpa: SVector<T, 4>,
}

impl<T: Real> Considered<T> {
    /// In place; whatever was there is forgotten.
    #[inline(never)]
    pub(super) fn configure(&mut self, config: &CarConfig<T>) {
        let corner = |i: usize| config.corners[i].as_ref();
        self.relative = SMatrix::from_fn(|i, j| {
            let (Some(a), Some(b)) = (corner(i), corner(j)) else { return T::zero() };
            let (a, b) = (&a.uncertainty, &b.uncertainty);
            let common = a.common_mass_relative_sd() * b.common_mass_relative_sd()
                + a.common_tire_relative_sd() * b.common_tire_relative_sd();
            let axle = if Corner::ALL[i].axle() == Corner::ALL[j].axle() {
                a.axle_mass_relative_sd() * b.axle_mass_relative_sd()
            } else {
                T::zero()
            };
            let own = if i == j { a.own_tire_relative_sd() * b.own_tire_relative_sd() } else { T::zero() };
            (common + axle + own) * a.tire_relative_sd_factor() * b.tire_relative_sd_factor()
        });
        let placard = |i: usize| corner(i).map_or(T::one(), |c| c.tire.stiffness_n_per_m(c.placard_kpa));
        let of = |value: &dyn Fn(&CornerConfig<T>) -> T| {
            SVector::from_fn(|i, _| corner(i).map_or(T::zero(), value))
        };
        self.coupling = T::zero();
        self.placard_n_per_m = SVector::from_fn(|i, _| placard(i));
        self.per_kpa = of(&|c| c.tire.stiffness_per_kpa());
        self.placard_kpa = of(&|c| c.placard_kpa);
    }

    /// Standard deviation in kPa of the mean of all tires at placard pressure.
    pub(super) fn mean_sd_kpa(&self) -> T {
        let covariance = self.uncalibrated(&self.placard_n_per_m);
        let (mut sum, mut count) = (T::zero(), T::zero());
        for i in (0..4).filter(|&i| self.per_kpa[i] > T::zero()) {
            count += T::one();
            for j in (0..4).filter(|&j| self.per_kpa[j] > T::zero()) {
                sum += covariance[(i, j)] / (self.per_kpa[i] * self.per_kpa[j]);
            }
        }
        sum.max(T::zero()).sqrt() / count.max(T::one())
    }

    /// Mean placard pressure in kPa of the corners that are there.
    pub(super) fn mean_placard_kpa(&self) -> T {
        let count = self.placard_kpa.iter().filter(|&&kpa| kpa > T::zero()).count();
        self.placard_kpa.sum() / T::lit(count.max(1) as f64)
    }

    /// Covariance in (N/m)² of stiffnesses of which only the vehicle file is known.
    pub(super) fn uncalibrated(&self, stiffness_n_per_m: &SVector<T, 4>) -> SMatrix<T, 4, 4> {
        let k = stiffness_n_per_m;
        let coupling = self.coupling * self.coupling;
        SMatrix::from_fn(|i, j| (self.relative[(i, j)] + coupling) * k[i] * k[j])
    }

    /// Covariance of what another road makes of the tires after a calibration, as shares of their stiffnesses.
    pub(super) fn between_roads(&self) -> SMatrix<T, 4, 4> {
        let count = T::lit(self.per_kpa.iter().filter(|&&there| there > T::zero()).count().max(1) as f64);
        let mean = self.relative.sum() / (count * count) + self.coupling * self.coupling;
        covariance_of_shapes(CALIBRATED_SDS).add_scalar(T::lit(ROAD_DEPENDENT * ROAD_DEPENDENT) * mean)
    }

    /// The same once a calibration has set them: a factor is an error of the change since then, not of the level.
    pub(super) fn calibrated(&self, stiffness_n_per_m: &SVector<T, 4>) -> SMatrix<T, 4, 4> {
        let change = stiffness_n_per_m - self.placard_n_per_m;
        let (k, roads) = (stiffness_n_per_m, self.between_roads());
        SMatrix::from_fn(|i, j| self.relative[(i, j)] * change[i] * change[j] + roads[(i, j)] * k[i] * k[j])
    }

    /// The same where that was on an earlier day: never worse than the vehicle file.
    pub(super) fn stored(&self, stiffness_n_per_m: &SVector<T, 4>) -> SMatrix<T, 4, 4> {
        let k = stiffness_n_per_m;
        let by_file = self.uncalibrated(k);
        let (calibrated, days) = (self.calibrated(k), covariance_of_shapes::<T>(BETWEEN_DAYS_SDS));
        let stored: SMatrix<T, 4, 4> =
            SMatrix::from_fn(|i, j| calibrated[(i, j)] + days[(i, j)] * k[i] * k[j]);
        let total = |of: &SMatrix<T, 4, 4>| (0..4).fold(T::zero(), |sum, i| sum + of[(i, i)]);
        if total(&by_file) < total(&stored) { by_file } else { stored }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::configured;
    use crate::model::{Confidence, ParameterUncertainty};

    fn typical() -> Considered<f64> {
        let corner = CornerConfig {
            uncertainty: ParameterUncertainty::of(Confidence::Typical),
            ..CornerConfig::<f64>::paper()
        };
        let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
        configured(|considered: &mut Considered<f64>| considered.configure(&config))
    }

    #[test]
    fn a_percent_of_unsprung_mass_is_327_kpa_per_percent() {
        // Mass 5 %, tire 3 %: 5.83 % of 241.3 kPa + 60880/713.91 kPa = 326.6 kPa.
        let stiffness = SVector::repeat(713.91 * 241.3 + 60_880.0);
        let covariance = typical().uncalibrated(&stiffness);
        let sd_kpa = covariance[(0, 0)].sqrt() / 713.91;
        assert!((sd_kpa - 326.6 * (0.05f64.powi(2) + 0.03f64.powi(2)).sqrt()).abs() < 0.1, "{sd_kpa}");
        // Left and right of an axle differ by their tires alone: 0.8 of 3 % each.
        let difference = covariance[(0, 0)] + covariance[(1, 1)] - 2.0 * covariance[(0, 1)];
        assert!((difference.sqrt() / 713.91 - 326.6 * 0.024 * 2f64.sqrt()).abs() < 0.1);
        // Front and rear by their masses, too: 0.6 of 5 % each.
        let axles = covariance[(0, 0)] + covariance[(2, 2)] - 2.0 * covariance[(0, 2)];
        assert!(
            (axles.sqrt() / 713.91 - 326.6 * (2.0 * (0.03f64.powi(2) + 0.024f64.powi(2))).sqrt()).abs() < 0.1
        );
        assert!(covariance.cholesky().is_some());
        // The mean of all four: 4 % and half of 3 % of mass twice, 1.8 % and a quarter of 2.4 % of tires four times.
        let mean =
            (0.04f64.powi(2) + 0.03f64.powi(2) / 2.0 + 0.018f64.powi(2) + 0.024f64.powi(2) / 4.0).sqrt();
        assert!((typical().mean_sd_kpa() - 326.6 * mean).abs() < 0.1);
    }

    /// A fifth of what the typical file leaves open of the mean, of which each tire's own is a quarter of its variance and an axle's a half.
    fn road_dependent() -> f64 {
        0.04 * (0.04f64.powi(2) + 0.03f64.powi(2) / 2.0 + 0.018f64.powi(2) + 0.024f64.powi(2) / 4.0)
    }

    #[test]
    fn a_ratio_that_is_known_counts_for_mass_and_tire() {
        let stiffness = SVector::repeat(713.91 * 241.3 + 60_880.0);
        let rough = ParameterUncertainty {
            stiffness_over_mass_relative_sd: Some(0.02),
            ..ParameterUncertainty::of(Confidence::Rough)
        };
        let corner = CornerConfig { uncertainty: rough, ..CornerConfig::<f64>::paper() };
        let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
        let considered = configured(|considered: &mut Considered<f64>| considered.configure(&config));
        let covariance = considered.uncalibrated(&stiffness);
        // 2 % of 326.6 kPa, whatever mass and tire are known to; what the wheels have in common stays.
        assert!((covariance[(0, 0)].sqrt() / 713.91 - 6.532).abs() < 1e-3);
        let common = (0.8f64.powi(2) * 0.01 + 0.0064 - 0.024f64.powi(2)) / (0.01 + 0.0064);
        assert!((covariance[(0, 3)] / covariance[(0, 0)] - common).abs() < 1e-9);
    }

    /// Of each tire the root of all squares; of two that stand diagonally the mean and the diagonals' less sides and axles; where the file knows more, it counts.
    #[test]
    fn a_stored_level_is_as_sure_as_another_day_allows() {
        let placard = 713.91 * 241.3 + 60_880.0;
        let stiffness = SVector::repeat(placard);
        let covariance = typical().stored(&stiffness) / (placard * placard);
        let [mean, side, axle, warp] = [(0.0125, 0.03), (0.004, 0.016), (0.0015, 0.008), (0.002, 0.0045)]
            .map(|(a, b): (f64, f64)| a * a + b * b);
        let mean = mean + road_dependent();
        assert!((covariance[(2, 2)] - (mean + side + axle + warp)).abs() < 1e-12);
        assert!((covariance[(0, 3)] - (mean - side - axle + warp)).abs() < 1e-12);
        assert!((covariance[(0, 2)] - (mean + side - axle - warp)).abs() < 1e-12);
        // Left against right by the side alone.
        let sides = SVector::<f64, 4>::new(0.25, -0.25, 0.25, -0.25);
        assert!((sides.dot(&(covariance * sides)) - side).abs() < 1e-12);
        let measured = ParameterUncertainty::of(Confidence::Measured);
        let corner = CornerConfig { uncertainty: measured, ..CornerConfig::<f64>::paper() };
        let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
        let considered = configured(|considered: &mut Considered<f64>| considered.configure(&config));
        let stored = considered.stored(&stiffness);
        assert!(stored.trace() <= considered.uncalibrated(&stiffness).trace());
        assert!(stored.cholesky().is_some());
    }

    /// A live axle's fifth of 326.6 kPa beside what the file leaves open, the same for all four; a fifth of it on another road than the calibration's.
    #[test]
    fn an_axle_that_couples_its_wheels_leaves_the_level_open() {
        let stiffness = SVector::repeat(713.91 * 241.3 + 60_880.0);
        let coupled = Considered { coupling: 0.2, ..typical() };
        let more = |of: &dyn Fn(&Considered<f64>) -> SMatrix<f64, 4, 4>| of(&coupled) - of(&typical());
        let by_file = more(&|considered| considered.uncalibrated(&stiffness));
        let calibrated = more(&|considered| considered.calibrated(&stiffness));
        for i in 0..16 {
            assert!((by_file[i].sqrt() / 713.91 - 0.2 * 326.6).abs() < 0.01);
            assert!((calibrated[i].sqrt() / 713.91 - 0.04 * 326.6).abs() < 0.01);
        }
    }

    #[test]
    fn a_calibrated_change_is_wrong_by_the_factor_alone() {
        let placard = 713.91 * 241.3 + 60_880.0;
        let mut stiffness = SVector::repeat(placard);
        let considered = typical();
        let level = considered.calibrated(&stiffness)[(1, 1)].sqrt();
        let shapes = 0.0125f64.powi(2) + 0.004f64.powi(2) + 0.0015f64.powi(2) + 0.002f64.powi(2);
        let left = (shapes + road_dependent()).sqrt();
        assert!((level / placard - left).abs() < 1e-12);
        // 48 kPa down: 5.83 % of them.
        stiffness[1] -= 48.0 * 713.91;
        let lost = considered.calibrated(&stiffness)[(1, 1)] - (left * stiffness[1]).powi(2);
        assert!((lost.sqrt() / 713.91 - 48.0 * 0.058_31).abs() < 0.01);
    }
}
