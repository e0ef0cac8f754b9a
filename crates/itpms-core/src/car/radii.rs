//! The radii of rolling wheels as a second witness of the tires' pressures (docs/math/two-witnesses.md). What accelerations tell of the
//! tires' stiffnesses is left as it was; every conclusion is joined with the radii anew, so that nothing is counted twice.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::considered::Considered;
use super::fusion::FusedEstimate;
use crate::model::{Level, RadiusDifferences, SEEN};
use crate::real::Real;

/// Radius over pressure on a grid, in standard deviations of its log.
const GRID: [f64; 5] = [-1.6, -0.8, 0.0, 0.8, 1.6];
/// Probability that radii have changed by something else, and by how much they do then, in thousandths: another load by a third, another
/// wheel.
const SOMETHING_ELSE: f64 = 0.02;
const SOMETHING_ELSE_SD: f64 = 2.0;
/// Share of the placard pressure below which a radius is not followed down.
const LEAST_PRESSURE: f64 = 0.3;

/// Four stiffnesses, or losses of stiffness, in N/m as accelerations tell them, with the pressures that they mean.
pub(super) struct Tires<'a, T: Real> {
    pub(super) covariance: &'a SMatrix<T, 4, 4>,
    /// Log of each pressure over that at the calibration of the radii, and its slope in 1/(N/m).
    pub(super) ln_pressure: SVector<T, 4>,
    pub(super) slope: SVector<T, 4>,
}

/// By how much the radii change the means of [`Tires`], and the covariance then.
pub(super) struct Joined<T: Real> {
    pub(super) step: SVector<T, 4>,
    pub(super) covariance: SMatrix<T, 4, 4>,
}

impl<T: Real> Tires<'_, T> {
    /// Joined with the radii; `changing`: the probability that a pressure changes just now, so that the radii of a moment ago are not
    /// those of now. `None` where there is no answer in numbers.
    pub(super) fn joined(&self, radii: &RadiusDifferences<T>, changing: T) -> Option<Joined<T>> {
        let seen = SMatrix::<T, 3, 4>::from_fn(|i, j| T::lit(SEEN[j][i]));
        let [a, b, c, d, e, f] = radii.covariance_1e6;
        let noise = Matrix3::new(a, b, d, b, c, e, d, e, f);
        let change = Vector3::from(radii.change_1e3);
        let expected = seen * self.ln_pressure;
        let by_stiffness = SMatrix::<T, 3, 4>::from_fn(|i, j| seen[(i, j)] * self.slope[j]);
        let gain = self.covariance * by_stiffness.transpose();
        let spread = by_stiffness * gain;

        let relative = radii.per_ln_pressure_relative_sd;
        let log_sd = (T::one() + relative * relative).ln_fast().sqrt();
        let doubt = changing.at_least(T::lit(SOMETHING_ELSE)).at_most(T::one());
        let mut total = GRID.iter().fold(T::zero(), |sum, x| sum + T::lit(-0.5 * x * x).exp_fast());
        let share = (T::one() - doubt) / total;
        // Where something else changed them nothing is learned.
        let other = T::lit(SOMETHING_ELSE_SD * SOMETHING_ELSE_SD);
        let mut weights = [T::zero(); GRID.len() + 1];
        let mut steps = [SVector::<T, 4>::zeros(); GRID.len()];
        let mut taken = [SMatrix::<T, 4, 4>::zeros(); GRID.len()];
        let beta = |x: f64| T::lit(1e3) * radii.per_ln_pressure * (T::lit(x) * log_sd).exp_fast();
        let (log, _) = likelihood(&(noise + Matrix3::identity() * other), &(change - expected * beta(0.0)))?;
        let mut logs = [log; GRID.len() + 1];
        let (mut best, places) = (log, logs.iter_mut().zip(&mut weights));
        let of_grid = GRID.iter().zip(&mut steps).zip(&mut taken);
        for (((x, step), taken), (log, weight)) in of_grid.zip(places) {
            let beta = beta(*x);
            let (found, inverse) =
                likelihood(&(spread * (beta * beta) + noise), &(change - expected * beta))?;
            let by = gain * inverse * beta;
            *step = by * (change - expected * beta);
            *taken = by * gain.transpose() * beta;
            (*log, *weight) = (found, share * T::lit(-0.5 * x * x).exp_fast());
            best = best.at_least(found);
        }
        if let Some(last) = weights.last_mut() {
            *last = doubt;
        }
        total = T::zero();
        for (weight, log) in weights.iter_mut().zip(logs) {
            *weight *= (log - best).exp_fast();
            total += *weight;
        }
        let mut joined = Joined { step: SVector::zeros(), covariance: *self.covariance };
        for ((weight, step), taken) in weights.iter().zip(&steps).zip(&taken) {
            let weight = *weight / total;
            joined.step += step * weight;
            joined.covariance += (step * step.transpose() - taken) * weight;
        }
        joined.covariance -= joined.step * joined.step.transpose();
        let is_one = |i: usize| joined.step[i].is_finite() && joined.covariance[(i, i)] > T::zero();
        (0..4).all(is_one).then_some(joined)
    }
}

/// Log likelihood of a residual of this covariance, and the inverse.
fn likelihood<T: Real>(covariance: &Matrix3<T>, residual: &Vector3<T>) -> Option<(T, Matrix3<T>)> {
    let determinant = covariance.determinant();
    let inverse = covariance.try_inverse().filter(|_| determinant > T::zero())?;
    Some((T::lit(-0.5) * (residual.dot(&(inverse * residual)) + determinant.ln_fast()), inverse))
}

impl<T: Real> Considered<T> {
    /// Joins what accelerations tell of four tires, with the part of it that rests on the vehicle file, with the radii.
    #[inline(never)]
    pub(super) fn join_radii(
        &self,
        radii: &RadiusDifferences<T>,
        level: Level,
        fused: &mut FusedEstimate<T>,
        by_file: &mut SMatrix<T, 4, 4>,
    ) {
        if !self.per_kpa.iter().all(|per_kpa| *per_kpa > T::zero()) {
            return;
        }
        let all = fused.covariance + *by_file;
        let least = |of: T, placard: T| of.at_least(placard * T::lit(LEAST_PRESSURE));
        let pressure = SVector::<T, 4>::from_fn(|i, _| {
            let change = (fused.stiffness_n_per_m[i] - self.placard_n_per_m[i]) / self.per_kpa[i];
            least(self.placard_kpa[i] + change, self.placard_kpa[i])
        });
        let tires = Tires {
            covariance: &all,
            ln_pressure: SVector::from_fn(|i, _| (pressure[i] / self.placard_kpa[i]).ln_fast()),
            slope: SVector::from_fn(|i, _| T::one() / (pressure[i] * self.per_kpa[i])),
        };
        let Some(joined) = tires.joined(radii, fused.changing) else { return };
        let left = SVector::<T, 4>::from_fn(|i, _| (joined.covariance[(i, i)] / all[(i, i)]).sqrt());
        fused.stiffness_n_per_m += joined.step;
        fused.covariance = SMatrix::from_fn(|i, j| fused.covariance[(i, j)] * left[i] * left[j]);
        *by_file = joined.covariance - fused.covariance;
        // Losses that are counted from the calibration on are what the radii have seen since then, too.
        let Some(losses) = fused.losses.as_mut().filter(|_| level == Level::Calibration) else { return };
        let kpa = |i: usize, n_per_m: T| n_per_m / self.per_kpa[i];
        let before = SVector::<T, 4>::from_fn(|i, _| {
            let above = kpa(i, losses.level_n_per_m[i] - self.placard_n_per_m[i]);
            least(self.placard_kpa[i] + above, self.placard_kpa[i])
        });
        let now = SVector::<T, 4>::from_fn(|i, _| {
            least(before[i] - kpa(i, losses.lost_n_per_m[i]), self.placard_kpa[i])
        });
        let tires = Tires {
            covariance: &losses.covariance,
            ln_pressure: SVector::from_fn(|i, _| (now[i] / before[i]).ln_fast()),
            slope: SVector::from_fn(|i, _| -T::one() / (now[i] * self.per_kpa[i])),
        };
        if let Some(joined) = tires.joined(radii, fused.changing) {
            losses.lost_n_per_m += joined.step;
            losses.covariance = joined.covariance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// 240 kPa at 714 N/m per kPa, and 12 kPa of sd each, 8 of them in common.
    const PER_KPA: f64 = 714.0;
    const PRESSURE_KPA: f64 = 240.0;

    fn covariance() -> SMatrix<f64, 4, 4> {
        let (own, common) = (80f64 * PER_KPA * PER_KPA, 64.0 * PER_KPA * PER_KPA);
        SMatrix::from_fn(|i, j| common + if i == j { own } else { 0.0 })
    }

    fn tires<'a>(covariance: &'a SMatrix<f64, 4, 4>, kpa: &SVector<f64, 4>) -> Tires<'a, f64> {
        Tires {
            covariance,
            ln_pressure: kpa.map(|kpa| (kpa / PRESSURE_KPA).ln()),
            slope: kpa.map(|kpa| 1.0 / (kpa * PER_KPA)),
        }
    }

    fn radii(change_1e3: [f64; 3], relative_sd: f64) -> RadiusDifferences<f64> {
        RadiusDifferences {
            change_1e3,
            covariance_1e6: [0.02, 0.0, 0.03, 0.0, 0.0, 0.04],
            per_ln_pressure: 0.007,
            per_ln_pressure_relative_sd: relative_sd,
        }
    }

    /// The same by information, which adds up: `(A^-1 + H' C^-1 H)^-1`.
    #[test]
    fn of_a_tire_known_well_it_is_the_sum_of_informations() {
        let before = covariance();
        let kpa = SVector::from([236.0, 243.0, 240.0, 238.0]);
        let change = [-0.25, 0.1, -0.05];
        let joined = tires(&before, &kpa).joined(&radii(change, 1e-6), 0.0).unwrap();
        let by = SMatrix::<f64, 3, 4>::from_fn(|i, j| 7.0 * SEEN[j][i] / (kpa[j] * PER_KPA));
        let noise = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)).try_inverse().unwrap();
        let information = before.try_inverse().unwrap() + by.transpose() * noise * by;
        let after = information.try_inverse().unwrap();
        let expected =
            SMatrix::<f64, 3, 4>::from_fn(|i, j| 7.0 * SEEN[j][i]) * kpa.map(|kpa| (kpa / PRESSURE_KPA).ln());
        let step = after * by.transpose() * noise * (Vector3::from(change) - expected);
        assert!((joined.covariance - after).norm() < 2e-4 * after.norm());
        assert!((joined.step - step).norm() < 2e-3 * step.norm(), "{} {step}", joined.step);
        // What all four do alike is not seen: along (p_i), nothing changes.
        let alike = by * kpa;
        assert!(alike.norm() < 1e-15 && after.trace() < 0.7 * before.trace());
    }

    #[test]
    fn radii_that_no_pressure_explains_change_nothing() {
        let before = covariance();
        let kpa = SVector::repeat(PRESSURE_KPA);
        // Other wheels on the rear axle.
        let joined = tires(&before, &kpa).joined(&radii([0.0, 9.0, 14.0], 0.6), 0.0).unwrap();
        assert!(joined.step.norm() < 0.5 * PER_KPA, "{}", joined.step);
        // A pressure that changes just now is not yet in them.
        let joined = tires(&before, &kpa).joined(&radii([-0.5, 0.0, -0.2], 0.6), 1.0).unwrap();
        assert!(joined.step.norm() < 1e-9 && (joined.covariance - before).norm() < 1e-6);
    }

    /// Pressures, and radii over pressure, as they are believed to be: the sd is that of the errors, and smaller than before.
    #[test]
    fn its_sd_is_that_of_its_errors() {
        let mut random = Random(7);
        let before = covariance();
        let root = before.cholesky().unwrap().l();
        let (mut within, mut closer, mut further) = (0, 0.0, 0.0);
        const DRAWS: usize = 4000;
        for _ in 0..DRAWS {
            let error = root * SVector::<f64, 4>::from_fn(|_, _| random.normal());
            let told = SVector::<f64, 4>::repeat(PRESSURE_KPA);
            let truth = told - error / PER_KPA;
            let beta = 7.0 * (random.normal() * 1.36f64.ln().sqrt()).exp();
            let ln_pressure = truth.map(|kpa| (kpa / PRESSURE_KPA).ln());
            let seen = SMatrix::<f64, 3, 4>::from_fn(|i, j| beta * SEEN[j][i]) * ln_pressure;
            let noise = [0.02f64, 0.03, 0.04].map(|variance| variance.sqrt() * random.normal());
            let change = core::array::from_fn(|i| seen[i] + noise[i]);
            let joined = tires(&before, &told).joined(&radii(change, 0.6), 0.0).unwrap();
            // The difference of two tires: what radii see.
            let difference = |x: &SVector<f64, 4>| x[0] - x[1];
            let off = difference(&(joined.step / PER_KPA + told - truth));
            let c = &joined.covariance;
            let variance = (c[(0, 0)] + c[(1, 1)] - 2.0 * c[(0, 1)]) / (PER_KPA * PER_KPA);
            within += usize::from(off * off < 1.96f64.powi(2) * variance);
            closer += off * off;
            further += difference(&(told - truth)).powi(2);
        }
        let share = within as f64 / DRAWS as f64;
        assert!((0.93..=0.97).contains(&share), "{share}");
        assert!(closer < 0.5 * further, "{}", closer / further);
    }
}
