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

/// Four stiffnesses in N/m as accelerations tell them, with the pressures that they mean.
struct Tires<'a, T: Real> {
    covariance: &'a SMatrix<T, 4, 4>,
    /// Log of each pressure over that at the calibration of the radii, and its slope in 1/(N/m).
    ln_pressure: SVector<T, 4>,
    slope: SVector<T, 4>,
}

/// What is sought: the stiffnesses themselves, or what of them was lost.
struct Sought<'a, T: Real> {
    covariance: &'a SMatrix<T, 4, 4>,
    /// Its covariance (rows) with the stiffnesses.
    by_stiffness: &'a SMatrix<T, 4, 4>,
}

/// The step of the [`Sought`] means by the radii, and the covariance after it.
struct Joined<T: Real> {
    step: SVector<T, 4>,
    covariance: SMatrix<T, 4, 4>,
}

impl<T: Real> Tires<'_, T> {
    /// What is sought of these tires, joined with the radii; `changing`: the probability that a pressure changes just now, so that the radii of a moment ago are not
    /// those of now. `None` where there is no answer in numbers.
    fn joined(&self, sought: &Sought<'_, T>, radii: &RadiusDifferences<T>, changing: T) -> Option<Joined<T>> {
        let seen = SMatrix::<T, 3, 4>::from_fn(|i, j| T::lit(SEEN[j][i]));
        let [a, b, c, d, e, f] = radii.covariance_1e6;
        let noise = Matrix3::new(a, b, d, b, c, e, d, e, f);
        let change = Vector3::from(radii.change_1e3);
        let expected = seen * self.ln_pressure;
        let by_stiffness = SMatrix::<T, 3, 4>::from_fn(|i, j| seen[(i, j)] * self.slope[j]);
        let gain = sought.by_stiffness * by_stiffness.transpose();
        let spread = by_stiffness * self.covariance * by_stiffness.transpose();

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
        let mut joined = Joined { step: SVector::zeros(), covariance: *sought.covariance };
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
        let signals = fused.covariance;
        let all = signals + *by_file;
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
        let sought = Sought { covariance: &all, by_stiffness: &all };
        let Some(joined) = tires.joined(&sought, radii, fused.changing) else { return };
        let left = SVector::<T, 4>::from_fn(|i, _| (joined.covariance[(i, i)] / all[(i, i)]).sqrt());
        fused.stiffness_n_per_m += joined.step;
        fused.covariance = SMatrix::from_fn(|i, j| fused.covariance[(i, j)] * left[i] * left[j]);
        *by_file = joined.covariance - fused.covariance;
        // Losses are counted since a calibration of this drive or a stop after it, the radii's change since the calibration: the former is
        // part of the latter, as far as a loss and the present stiffness err alike.
        let Some(losses) = fused.losses.as_mut().filter(|_| level == Level::Calibration) else { return };
        let tires = Tires { covariance: &signals, ..tires };
        let sought = Sought { covariance: &losses.covariance, by_stiffness: &losses.by_stiffness };
        if let Some(joined) = tires.joined(&sought, radii, fused.changing) {
            losses.lost_n_per_m += joined.step;
            losses.covariance = joined.covariance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::car::fusion::FusedLosses;
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

    fn joined(tires: &Tires<'_, f64>, radii: &RadiusDifferences<f64>, changing: f64) -> Option<Joined<f64>> {
        tires.joined(
            &Sought { covariance: tires.covariance, by_stiffness: tires.covariance },
            radii,
            changing,
        )
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
        let found = joined(&tires(&before, &kpa), &radii(change, 1e-6), 0.0).unwrap();
        let by = SMatrix::<f64, 3, 4>::from_fn(|i, j| 7.0 * SEEN[j][i] / (kpa[j] * PER_KPA));
        let noise = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)).try_inverse().unwrap();
        let information = before.try_inverse().unwrap() + by.transpose() * noise * by;
        let after = information.try_inverse().unwrap();
        let expected =
            SMatrix::<f64, 3, 4>::from_fn(|i, j| 7.0 * SEEN[j][i]) * kpa.map(|kpa| (kpa / PRESSURE_KPA).ln());
        let step = after * by.transpose() * noise * (Vector3::from(change) - expected);
        assert!((found.covariance - after).norm() < 2e-4 * after.norm());
        assert!((found.step - step).norm() < 2e-3 * step.norm(), "{} {step}", found.step);
        // What all four do alike is not seen: along (p_i), nothing changes.
        let alike = by * kpa;
        assert!(alike.norm() < 1e-15 && after.trace() < 0.7 * before.trace());
    }

    #[test]
    fn radii_that_no_pressure_explains_change_nothing() {
        let before = covariance();
        let kpa = SVector::repeat(PRESSURE_KPA);
        // Other wheels on the rear axle.
        let found = joined(&tires(&before, &kpa), &radii([0.0, 9.0, 14.0], 0.6), 0.0).unwrap();
        assert!(found.step.norm() < 0.5 * PER_KPA, "{}", found.step);
        // A pressure that changes just now is not yet in them.
        let found = joined(&tires(&before, &kpa), &radii([-0.5, 0.0, -0.2], 0.6), 1.0).unwrap();
        assert!(found.step.norm() < 1e-9 && (found.covariance - before).norm() < 1e-6);
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
            let estimated = SVector::<f64, 4>::repeat(PRESSURE_KPA);
            let truth = estimated - error / PER_KPA;
            let beta = 7.0 * (random.normal() * 1.36f64.ln().sqrt()).exp();
            let ln_pressure = truth.map(|kpa| (kpa / PRESSURE_KPA).ln());
            let seen = SMatrix::<f64, 3, 4>::from_fn(|i, j| beta * SEEN[j][i]) * ln_pressure;
            let noise = [0.02f64, 0.03, 0.04].map(|variance| variance.sqrt() * random.normal());
            let change = core::array::from_fn(|i| seen[i] + noise[i]);
            let found = joined(&tires(&before, &estimated), &radii(change, 0.6), 0.0).unwrap();
            // The difference of two tires: what radii see.
            let difference = |x: &SVector<f64, 4>| x[0] - x[1];
            let off = difference(&(found.step / PER_KPA + estimated - truth));
            let c = &found.covariance;
            let variance = (c[(0, 0)] + c[(1, 1)] - 2.0 * c[(0, 1)]) / (PER_KPA * PER_KPA);
            within += usize::from(off * off < 1.96f64.powi(2) * variance);
            closer += off * off;
            further += difference(&(estimated - truth)).powi(2);
        }
        let share = within as f64 / DRAWS as f64;
        assert!((0.93..=0.97).contains(&share), "{share}");
        assert!(closer < 0.5 * further, "{}", closer / further);
    }

    /// A tire loses a fifth, the car stands for so long that losses are counted anew, then it loses a tenth. Radii have seen both since
    /// the calibration, and only the second is a loss; what they change of it is what a filter over levels and losses finds.
    #[test]
    fn what_was_lost_before_a_stop_is_no_loss_after_it() {
        const PLACARD_N_PER_M: f64 = PER_KPA * PRESSURE_KPA + 60_880.0;
        let considered = Considered {
            coupling: 0.0,
            relative: SMatrix::zeros(),
            placard_n_per_m: SVector::repeat(PLACARD_N_PER_M),
            per_kpa: SVector::repeat(PER_KPA),
            placard_kpa: SVector::repeat(PRESSURE_KPA),
        };
        let level = SVector::from([0.8 * PRESSURE_KPA, PRESSURE_KPA, PRESSURE_KPA, PRESSURE_KPA]);
        let lost = SVector::from([0.08 * PRESSURE_KPA, 0.0, 0.0, 0.0]);
        let truth = level - lost;
        let seen = SMatrix::<f64, 3, 4>::from_fn(|i, j| 7.0 * SEEN[j][i]);
        let radii = radii((seen * truth.map(|kpa| (kpa / PRESSURE_KPA).ln())).into(), 1e-6);
        // Of levels and losses, to 6 and 5 kPa each when the stop ended, the present pressures were measured to 4 kPa.
        let variance = |kpa: f64| SMatrix::<f64, 4, 4>::identity() * (kpa * PER_KPA).powi(2);
        let (of_level, of_loss) = (variance(6.0), variance(5.0));
        let kept = (variance(4.0) + of_level + of_loss).try_inverse().unwrap();
        let of_both = SMatrix::<f64, 8, 8>::from_fn(|i, j| {
            let prior = match (i < 4, i == j) {
                (_, false) => 0.0,
                (true, _) => of_level[(0, 0)],
                (false, _) => of_loss[(0, 0)],
            };
            // A stiffness is its level less its loss.
            let with = |of: usize| if of < 4 { of_level[(0, 0)] } else { -of_loss[(0, 0)] };
            prior - with(i) * kept[(i % 4, j % 4)] * with(j)
        });
        let block = |i: usize, j: usize| of_both.fixed_view::<4, 4>(i, j).into_owned();
        let (levels, losses, cross) = (block(0, 0), block(4, 4), block(4, 0));
        for off_kpa in [0.0, 5.0] {
            let off = SVector::from([off_kpa, 0.0, 0.0, 0.0]);
            let n_per_m =
                |kpa: SVector<f64, 4>| kpa.map(|kpa| PLACARD_N_PER_M + PER_KPA * (kpa - PRESSURE_KPA));
            let mut fused = FusedEstimate {
                stiffness_n_per_m: n_per_m(truth + off),
                covariance: levels + losses - cross - cross.transpose(),
                changing: 0.0,
                learned_s: 100.0,
                losses: Some(FusedLosses {
                    level_n_per_m: n_per_m(level),
                    lost_n_per_m: (lost - off) * PER_KPA,
                    covariance: losses,
                    by_stiffness: cross - losses,
                }),
            };
            considered.join_radii(&radii, Level::Calibration, &mut fused, &mut SMatrix::zeros());
            let found = fused.losses.unwrap();
            // The same by the state of eight: H of levels and losses.
            let slope = (truth + off).map(|kpa| 1.0 / (kpa * PER_KPA));
            let of_level = SMatrix::<f64, 3, 4>::from_fn(|i, j| seen[(i, j)] * slope[j]);
            let by =
                SMatrix::<f64, 3, 8>::from_fn(
                    |i, j| {
                        if j < 4 { of_level[(i, j)] } else { -of_level[(i, j - 4)] }
                    },
                );
            let noise = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04));
            let gain =
                of_both * by.transpose() * (by * of_both * by.transpose() + noise).try_inverse().unwrap();
            let residual =
                Vector3::from(radii.change_1e3) - seen * (truth + off).map(|kpa| (kpa / PRESSURE_KPA).ln());
            let step = (gain * residual).fixed_rows::<4>(4).into_owned();
            let after = of_both - gain * by * of_both;
            // But for the chance that something else changed the radii.
            let error = found.lost_n_per_m - (lost - off) * PER_KPA - step;
            assert!(error.norm() < 0.02 * step.norm() + 1e-6, "{off_kpa}: {error} {step}");
            let expected = after.fixed_view::<4, 4>(4, 4).into_owned();
            assert!((found.covariance - expected).norm() < 0.02 * expected.norm());
            // It comes nearer to what was lost.
            let kpa = found.lost_n_per_m[0] / PER_KPA;
            let left_kpa = lost[0] - kpa;
            assert!(left_kpa > -1e-6 && left_kpa <= 0.9 * off_kpa + 1e-6, "{off_kpa}: {kpa}");
        }
    }
}
