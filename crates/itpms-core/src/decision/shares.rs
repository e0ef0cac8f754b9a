//! Shares of their pressures that tires lack, as one Gaussian, held against every set of low tires (docs/math/decision.md, eq. 1-5).

use nalgebra::{Matrix4, Vector4};

use super::{DECISIVE, Probabilities, SETS, Tuning};
use crate::model::Corner;
use crate::real::Real;

/// Variance of a share of which nothing is known.
const UNKNOWN: f64 = 1e4;

/// Since when tires lack what they lack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Since {
    /// They have lost it in this drive.
    Beginning,
    /// It may have been before: they are held against the file, or a calibration of this drive.
    Ever,
    /// The same, against a calibration of an earlier day: the car as a whole or one of its axles may have changed since.
    EarlierDay,
}

impl Since {
    pub(crate) fn prior_of_one(self, tuning: &Tuning) -> f64 {
        if self == Self::Beginning { tuning.one_loses } else { tuning.one_is_low }
    }
}

/// The pressure that each tire lacks, as a share of its reference.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shares<T: Real> {
    lacking: Vector4<T>,
    covariance: Matrix4<T>,
}

impl<T: Real> Shares<T> {
    /// Of each tire what it lacks and the sd of that, if something is known of it, and the correlation of the errors.
    pub(crate) fn new(lacking: &[Option<[T; 2]>; 4], correlation: &[[T; 4]; 4]) -> Self {
        let nothing = [T::lit(f64::NAN); 2];
        let lacking = lacking.map(|lacking| lacking.unwrap_or(nothing));
        let known = |i: usize| lacking.get(i).copied().filter(|[less, sd]| (*less + *sd).is_finite());
        let covariance = Matrix4::from_fn(|i, j| match (known(i), known(j)) {
            (Some([_, a]), Some([_, b])) => correlation[i][j] * a * b,
            _ if i == j => T::lit(UNKNOWN),
            _ => T::zero(),
        });
        Self { lacking: Vector4::from_fn(|i, _| known(i).map_or(T::zero(), |[less, _]| less)), covariance }
    }

    /// How probable each set is; `loss`: the share of its pressure that a low tire has to be warned of.
    pub(crate) fn probabilities(&self, loss: T, since: Since, tuning: &Tuning) -> Option<Probabilities<T>> {
        let square = |sd: f64| T::lit(sd * sd);
        let mut weighed = Weighed::new();
        // The loss since the drive began accounts for the tires' warmth.
        let warmth = if since == Since::Beginning { T::zero() } else { square(tuning.warmth_sd) };
        let plain = self.covariance.map(|covariance| covariance + warmth);
        self.weigh(&plain, loss, since, T::zero(), tuning, &mut weighed)?;
        let mut another = Weighed::new();
        if since == Since::EarlierDay {
            let (common, axle) = (square(tuning.changed_sd), square(tuning.changed_axle_sd));
            let covariance = Matrix4::from_fn(|i, j| {
                let same = Corner::ALL[i].axle() == Corner::ALL[j].axle();
                plain[(i, j)] + common + if same { axle } else { -axle }
            });
            self.weigh(&covariance, loss, since, T::lit(tuning.changed).ln_fast(), tuning, &mut another)?;
        }
        let none = T::lit(f64::NEG_INFINITY);
        let unexplained = self.odd(&plain, since, tuning, None)?;
        let mut rims = [none; 4];
        for (tire, log) in rims.iter_mut().enumerate() {
            // Against the other tire of the axle: a level that is not known well is common to both.
            if self.lacking[tire] - self.lacking[tire ^ 1] < T::lit(-tuning.nobody_inflates) {
                *log = self.odd(&plain, since, tuning, Some(tire))?;
            }
        }
        weighed.add_all(&another);
        let (found, all) = Probabilities::of(&weighed.log, unexplained, &rims);
        // A deficit that the tires of another car do not have belongs to the car; an unexplained one may belong to it entirely.
        let sum = |logs: &[T]| logs.iter().fold(T::zero(), |sum, &log| sum + (log - all).exp_fast());
        let changed = if since == Since::EarlierDay { sum(&another.log) } else { T::zero() };
        let odd = found.on_rim.iter().fold(sum(&[unexplained]), |sum, &rim| sum + rim);
        let doubt = Vector4::from_fn(|i, _| {
            let off = self.lacking[i] - another.lacking[i];
            (changed * (off * off) + odd * (self.lacking[i] * self.lacking[i]))
                .sqrt()
                .copysign(self.lacking[i])
        });
        let least = T::lit(DECISIVE) * loss;
        let lacks = weighed.lacking.data.0[0].map(|lacking| lacking > least);
        Some(Probabilities { lacks, doubt: doubt.data.0[0], ..found })
    }

    /// Weighs every set of low tires, and of tires that are nearly flat.
    fn weigh(
        &self,
        covariance: &Matrix4<T>,
        loss: T,
        since: Since,
        log: T,
        tuning: &Tuning,
        weighed: &mut Weighed<T>,
    ) -> Option<()> {
        let flat = log + T::lit(tuning.nearly_flat).ln_fast();
        let priors: [T; SETS] = tuning.log_priors(since.prior_of_one(tuning));
        for (kind, log) in [(tuning.low, log), (tuning.flat, flat)] {
            let [mean, sd] = kind.map(|losses| T::lit(losses) * loss);
            let fine = T::lit(tuning.fine_sd * tuning.fine_sd);
            self.likelihoods(covariance, mean, [sd * sd, fine], |set, likelihood, lacking| {
                // What is not low is not nearly flat either, and what is has lost and not gained air.
                let has_lost = |i: usize| set & (1 << i) == 0 || lacking[i] > T::zero();
                if (set > 0 || kind == tuning.low) && (0..4).all(has_lost) {
                    weighed.add(set, log + likelihood + priors[set % SETS], lacking);
                }
            })?;
        }
        Some(())
    }

    /// Log-likelihood of every set, without constants, and what its tires lack, if low tires lack `mean` with this variance and fine ones nothing with theirs. A low tire has that
    /// variance in place of a fine one's: one number on the diagonal, so each set's inverse is that of the set without its first tire,
    /// less a product.
    fn likelihoods(
        &self,
        covariance: &Matrix4<T>,
        mean: T,
        [variance, fine]: [T; 2],
        mut each: impl FnMut(usize, T, Vector4<T>),
    ) -> Option<()> {
        let plain = (covariance + Matrix4::from_diagonal_element(fine)).cholesky()?;
        let diagonal = plain.l_dirty().diagonal();
        let mut inverse = [Matrix4::<T>::zeros(); SETS];
        let mut half_log_determinant = [T::zero(); SETS];
        inverse[0] = plain.inverse();
        half_log_determinant[0] = diagonal.iter().fold(T::zero(), |sum, x| sum + x.ln_fast());
        for set in 0..SETS {
            if set > 0 {
                let (tire, without, more) = (set.trailing_zeros() as usize, set & (set - 1), variance - fine);
                let before = inverse[without];
                let column = before.column(tire);
                let grown = T::one() + more * column[tire];
                if !(grown > T::zero()) {
                    return None;
                }
                inverse[set] = before - column * column.transpose() * (more / grown);
                half_log_determinant[set] = half_log_determinant[without] + T::lit(0.5) * grown.ln_fast();
            }
            let is_low = |i: usize| set & (1 << i) != 0;
            let expected = Vector4::from_fn(|i, _| if is_low(i) { mean } else { T::zero() });
            let off = self.lacking - expected;
            let weighted = inverse[set] * off;
            let lacking =
                Vector4::from_fn(|i, _| expected[i] + weighted[i] * if is_low(i) { variance } else { fine });
            each(set, T::lit(-0.5) * off.dot(&weighted) - half_log_determinant[set], lacking);
        }
        Some(())
    }

    /// Log-likelihood, with its prior, of pressures that no set explains, or beside a tire on its rim.
    fn odd(&self, covariance: &Matrix4<T>, since: Since, tuning: &Tuning, rim: Option<usize>) -> Option<T> {
        let [mean, sd, beside] = tuning.rim.map(T::lit);
        let by_itself = |i: usize| match rim {
            Some(tire) if tire == i => sd,
            Some(_) => beside,
            None => T::lit(tuning.unexplained_sd),
        };
        let own = Vector4::from_fn(|i, _| by_itself(i) * by_itself(i));
        let root = (covariance + Matrix4::from_diagonal(&own)).cholesky()?;
        let half_log_determinant =
            root.l_dirty().diagonal().iter().fold(T::zero(), |sum, x| sum + x.ln_fast());
        let off = Vector4::from_fn(|i, _| self.lacking[i] - if rim == Some(i) { mean } else { T::zero() });
        let prior = if rim.is_some() { tuning.nearly_flat } else { tuning.unexplained };
        Some(
            T::lit(-0.5) * off.dot(&root.solve(&off)) - half_log_determinant
                + T::lit(prior * since.prior_of_one(tuning)).ln_fast(),
        )
    }
}

/// Log of the probability of every set, and what the tires lack by the likeliest way.
struct Weighed<T: Real> {
    log: [T; SETS],
    best: T,
    lacking: Vector4<T>,
}

impl<T: Real> Weighed<T> {
    fn new() -> Self {
        let none = T::lit(f64::NEG_INFINITY);
        Self { log: [none; SETS], best: none, lacking: Vector4::zeros() }
    }

    /// Adds a way in which a set may be low.
    fn add(&mut self, set: usize, log: T, lacking: Vector4<T>) {
        if log > self.best {
            (self.best, self.lacking) = (log, lacking);
        }
        if let Some(sum) = self.log.get_mut(set) {
            *sum = log_sum(*sum, log);
        }
    }

    fn add_all(&mut self, other: &Self) {
        if !(other.best > T::lit(f64::NEG_INFINITY)) {
            return;
        }
        (0..SETS).for_each(|set| self.log[set] = log_sum(self.log[set], other.log[set]));
        if other.best > self.best {
            (self.best, self.lacking) = (other.best, other.lacking);
        }
    }
}

/// `ln(exp(one) + exp(other))`.
fn log_sum<T: Real>(one: T, other: T) -> T {
    let most = one.at_least(other);
    if most == T::lit(f64::NEG_INFINITY) {
        return most;
    }
    most + ((one - most).exp_fast() + (other - most).exp_fast()).ln_fast()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [[f64; 4]; 4] =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

    fn shares(lacking: [f64; 4], sd: f64, correlation: f64) -> Shares<f64> {
        let correlation =
            core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { correlation }));
        Shares::new(&lacking.map(|less| Some([less, sd])), &correlation)
    }

    fn weighed(shares: &Shares<f64>, since: Since) -> Probabilities<f64> {
        shares.probabilities(0.2, since, &Tuning::DEFAULT).unwrap()
    }

    /// Against the density written out: determinant and inverse of each set's own covariance.
    #[test]
    fn likelihoods_are_those_of_the_density() {
        let shares = shares([0.1, 0.22, -0.04, 0.3], 0.06, 0.7);
        let mut log = [0.0; SETS];
        shares
            .likelihoods(&shares.covariance, 0.25, [0.084 * 0.084, 0.013 * 0.013], |set, found, _| {
                log[set] = found
            })
            .unwrap();
        for (set, log) in log.into_iter().enumerate() {
            let is_low = |i: usize| set & (1 << i) != 0;
            let covariance = Matrix4::from_fn(|i, j| {
                let own = if is_low(i) { 0.084 * 0.084 } else { 0.013 * 0.013 };
                0.0036 * if i == j { 1.0 } else { 0.7 } + if i == j { own } else { 0.0 }
            });
            let off = Vector4::new(0.1, 0.22, -0.04, 0.3)
                - Vector4::from_fn(|i, _| if is_low(i) { 0.25 } else { 0.0 });
            let expected = -0.5
                * (off.dot(&(covariance.try_inverse().unwrap() * off)) + f64::ln(covariance.determinant()));
            assert!((log - expected).abs() < 1e-9, "{set:04b}: {log} {expected}");
        }
    }

    #[test]
    fn every_set_is_named_that_is_known_well() {
        for set in 0..SETS {
            let lacking = core::array::from_fn(|i| if set & (1 << i) == 0 { 0.0 } else { 0.22 });
            let found = weighed(&shares(lacking, 0.02, 0.3), Since::Beginning);
            for tire in Corner::ALL {
                let low = set & (1 << tire.index()) != 0;
                assert_eq!(found.low(tire) > 0.99, low, "{set:04b} {tire:?}");
            }
            assert_eq!(found.all_low() > 0.99, set + 1 == SETS);
        }
    }

    /// A level that is not known to a fifth says nothing of all four, and of one against the others what their differences say.
    #[test]
    fn what_all_are_wrong_by_alike_cancels_between_tires() {
        let all = weighed(&shares([0.22; 4], 0.1, 0.95), Since::Beginning);
        assert!(all.any_low() < 0.5, "{all:?}");
        let one = weighed(&shares([0.02, 0.02, 0.3, 0.02], 0.1, 0.95), Since::Beginning);
        assert!(one.low(Corner::RearLeft) > 0.99 && one.low(Corner::FrontLeft) < 0.01, "{one:?}");
    }

    /// After a night all four reading low is more likely another car; one of them against the others is still that one.
    #[test]
    fn a_car_that_has_changed_hides_no_single_tire() {
        let found = |lacking| weighed(&shares(lacking, 0.03, 0.3), Since::EarlierDay);
        assert!(found([0.18; 4]).all_low() < 0.5);
        assert!(found([0.15, 0.15, 0.0, 0.0]).any_low() < 0.5);
        let one = found([0.15, 0.4, 0.15, 0.15]);
        assert!(one.low(Corner::FrontRight) > 0.99 && one.low(Corner::FrontLeft) < 0.5, "{one:?}");
    }

    /// Against the densities written out: of tires as they should be on the car as it was, and on another one.
    #[test]
    fn a_level_that_may_be_another_cars_is_known_less_well() {
        let density = |lacking: f64, changed: bool| {
            let covariance = Matrix4::from_fn(|i, j| {
                let (one, same_axle) = (f64::from(i == j), i / 2 == j / 2);
                let another = 0.04 + if same_axle { 0.01 } else { -0.01 };
                0.0016 * (0.9 + 0.1 * one)
                    + 0.018 * 0.018
                    + 0.013 * 0.013 * one
                    + if changed { another } else { 0.0 }
            });
            let off = Vector4::repeat(lacking);
            let square = off.dot(&(covariance.try_inverse().unwrap() * off));
            (-0.5 * square).exp() / covariance.determinant().sqrt()
        };
        for lacking in [-0.28, -0.16, -0.12, -0.06, 0.02] {
            let found = weighed(&shares([lacking; 4], 0.04, 0.9), Since::EarlierDay);
            let (same, another) = (density(lacking, false), Tuning::DEFAULT.changed * density(lacking, true));
            let expected = (another / (same + another)).sqrt() * lacking;
            for tire in Corner::ALL {
                let doubt = found.doubt(tire);
                assert!(
                    (doubt - expected).abs() < 0.1 * expected.abs() + 0.001,
                    "{lacking}: {doubt} {expected}"
                );
            }
            let today = weighed(&shares([lacking; 4], 0.04, 0.9), Since::Ever);
            assert!(lacking < -0.1 || today.doubt(Corner::FrontLeft).abs() < 0.002);
        }
    }

    /// One tire reads as a rim; two of a side do not, nor does one that is harder than its pressure explains by one sd.
    #[test]
    fn a_rim_reads_hard_and_hides_what_is_beside_it() {
        let on_rim = |lacking, sd| {
            let found = weighed(&shares(lacking, sd, 0.3), Since::Ever);
            assert!(Corner::ALL.iter().all(|tire| found.low(*tire) < 0.02), "{found:?}");
            Corner::ALL.map(|tire| found.on_rim(tire))
        };
        assert!(on_rim([0.0, -0.9, 0.1, 0.0], 0.05)[1] > 0.99);
        assert!(on_rim([-0.9, 0.0, -0.9, 0.0], 0.05).iter().all(|p| *p < 0.6));
        assert!(on_rim([0.0, -0.4, 0.0, 0.0], 0.05).iter().all(|p| *p == 0.0));
        assert!(on_rim([0.0, -0.6, 0.0, 0.0], 0.3).iter().all(|p| *p < 0.5));
    }

    #[test]
    fn a_tire_of_which_nothing_is_known_is_as_likely_low_as_ever() {
        let known = [Some([0.0, 0.02]), None, Some([0.25, 0.02]), Some([f64::NAN, 0.02])];
        let found = weighed(&Shares::new(&known, &NONE), Since::Beginning);
        assert!(found.low(Corner::RearLeft) > 0.99 && found.low(Corner::FrontLeft) < 0.01);
        assert!(found.low(Corner::FrontRight) < 0.3 && found.low(Corner::RearRight) < 0.3, "{found:?}");
    }
}
