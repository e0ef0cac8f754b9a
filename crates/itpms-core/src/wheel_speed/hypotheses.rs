//! Which tires are low: sixteen hypotheses against what is believed of the radii (`docs/math/wheel-speed.md`, eq. 9-11, 20).

use super::config::WheelSpeedConfig;
use crate::decision::{self, LOSS, Probabilities, SETS, Since};
use crate::memory::Blank;
use crate::model::SEEN;
use crate::real::Real;
use crate::torsion::TorsionEvidence;
use crate::wheel_speed::Tuning;

/// Priors and low tires are the [decision](crate::decision)'s.
pub(super) const DECISION: decision::Tuning = decision::Tuning::DEFAULT;
/// A loss of a fifth of the pressure, as `-ln 0.8`.
const FIFTH: f64 = 0.223_143_55;
/// The sets of low tires, each of some nearly flat, and one that is empty.
const HYPOTHESES: usize = 2 * SETS - 1 + 4;
/// A symmetric matrix of three: 00, 10, 11, 20, 21, 22.
pub(super) type Triangle<T> = [T; 6];

/// How probable each hypothesis is, and what follows for each wheel.
#[derive(Debug, Clone, Copy, Blank)]
pub(super) struct Decision<T> {
    /// Of the sets of low tires.
    pub sets: Probabilities<T>,
    /// Change of each radius in thousandths, its sd.
    pub change: [T; 4],
    pub change_sd: [T; 4],
}

impl<T: Real> Decision<T> {
    /// From the changes of the three ratios of radii `since` then with their covariance, in thousandths, the evidence of tooth
    /// pulses alone, and the prior of the `unexplained` hypothesis over that of one wheel.
    pub(super) fn of(
        change: &[T; 3],
        covariance: &Triangle<T>,
        since: Since,
        torsion: &TorsionEvidence<T>,
        unexplained: T,
        config: &WheelSpeedConfig<T>,
    ) -> Self {
        let (tuning, fifth) = (config.tuning(), T::lit(FIFTH) * config.per_ln_1e3());
        let one = T::lit(since.prior_of_one(&DECISION));
        let unexplained_sd = tuning.unexplained_sd.map(T::lit);
        let unexplained = left_unexplained(change, covariance, unexplained_sd, unexplained * one)
            + torsion.log_likelihood(0);
        let mut all = [(T::zero(), [T::zero(); 4], [T::zero(); 4]); HYPOTHESES];
        let (mut best, priors) = (unexplained, log_priors::<T>(since));
        for (number, (log, mean, variance)) in all.iter_mut().enumerate() {
            let (set, hypothesis) = Hypothesis::numbered(number, since, fifth, tuning);
            let likelihood;
            (likelihood, *mean, *variance) = hypothesis.against(change, covariance);
            *log = likelihood + torsion.log_likelihood(set) + priors[set % SETS];
            if number != set {
                *log += T::lit(DECISION.nearly_flat).ln_fast();
            }
            best = best.at_least(*log);
        }
        let mut decision = Self::BLANK;
        let mut unexplained = (unexplained - best).exp_fast();
        let mut total = unexplained;
        for (log, ..) in &mut all {
            *log = (*log - best).exp_fast();
            total += *log;
        }
        unexplained /= total;
        let mut of_set = [T::zero(); SETS];
        for (number, (probability, mean, _)) in all.iter_mut().enumerate() {
            *probability /= total;
            let (set, _) = Hypothesis::<T>::numbered(number, since, fifth, tuning);
            if let Some(sum) = of_set.get_mut(set) {
                *sum += *probability;
            }
            for (change, mean) in decision.change.iter_mut().zip(mean) {
                *change += *probability * *mean;
            }
        }
        decision.sets = Probabilities::known(of_set);
        for (i, (center, sd)) in decision.change.iter().zip(&mut decision.change_sd).enumerate() {
            let spread = |(p, mean, variance): &(T, [T; 4], [T; 4])| {
                *p * (variance[i] + (mean[i] - *center) * (mean[i] - *center))
            };
            // An unexplained change may be this wheel's, too.
            let by_none = unexplained * unexplained_sd[0] * unexplained_sd[0];
            *sd = all.iter().map(spread).fold(by_none, |sum, v| sum + v).at_least(T::zero()).sqrt();
        }
        decision
    }
}

/// Which radii, in thousandths, are expected where these tires are low.
struct Hypothesis<T> {
    mean: [T; 4],
    variance: [T; 4],
}

impl<T: Real> Hypothesis<T> {
    /// The sixteen sets of low tires by their bits, then each nearly flat, then each tire empty; with the set that it belongs to.
    fn numbered(number: usize, since: Since, fifth: T, tuning: &Tuning) -> (usize, Self) {
        let [low, sd] = DECISION.low;
        let (set, expected) = match number.checked_sub(SETS) {
            // The sd of its share over the share left, in losses of a fifth of the `ln`.
            None => (number, [low, sd * LOSS / (1.0 - low * LOSS) / FIFTH]),
            Some(before) if before + 1 < SETS => (before + 1, DECISION.flat),
            Some(before) => (1 << ((before + 1) % SETS), tuning.empty),
        };
        (set, Self::of(set, fine_sd(since, tuning), expected, fifth))
    }

    fn of(set: usize, fine_sd: f64, [mean, sd]: [f64; 2], fifth: T) -> Self {
        let low = |i: usize| set & (1 << i) != 0;
        let sd = T::lit(sd) * fifth;
        Self {
            mean: core::array::from_fn(|i| if low(i) { T::lit(-mean) * fifth } else { T::zero() }),
            variance: core::array::from_fn(|i| if low(i) { sd * sd } else { T::lit(fine_sd * fine_sd) }),
        }
    }

    /// Log likelihood without constants, and the radii if it holds.
    fn against(&self, change: &[T; 3], covariance: &Triangle<T>) -> (T, [T; 4], [T; 4]) {
        let mut expected = *covariance;
        let mut residual = *change;
        for ((seen, mean), variance) in SEEN.iter().zip(&self.mean).zip(&self.variance) {
            let seen = seen.map(T::lit);
            add_square(&mut expected, &seen, *variance);
            for (residual, seen) in residual.iter_mut().zip(seen) {
                *residual -= seen * *mean;
            }
        }
        let Some((inverse, determinant)) = inverse(&expected) else {
            return (T::zero(), self.mean, self.variance);
        };
        let weighted = times(&inverse, &residual);
        let mut mean = self.mean;
        let mut variance = self.variance;
        for ((seen, mean), variance) in SEEN.iter().zip(&mut mean).zip(&mut variance) {
            let seen = seen.map(T::lit);
            *mean += *variance * dot(&seen, &weighted);
            *variance -= *variance * *variance * dot(&seen, &times(&inverse, &seen));
        }
        (T::lit(-0.5) * (dot(&residual, &weighted) + determinant.ln_fast()), mean, variance)
    }
}

/// How far radii of tires that are not low move by themselves since then, in thousandths.
fn fine_sd(since: Since, tuning: &Tuning) -> f64 {
    let [driving, ever] = tuning.fine_sd;
    if since == Since::Beginning { driving } else { ever }
}

/// Logs of the priors of the sets against none.
fn log_priors<T: Real>(since: Since) -> [T; SETS] {
    let one = since.prior_of_one(&DECISION);
    let mut priors: [T; SETS] = DECISION.log_priors(one);
    if since == Since::Beginning {
        // Both tires of an axle are two accidents, while the slip of another road moves one axle against the other, too.
        [priors[0b0011], priors[0b1100]] = [T::lit(one * one).ln_fast(); 2];
    }
    priors
}

/// Log-likelihood ratio that makes a wheel [surely low](decision::Tuning::surely_low).
fn to_be_found<T: Real>(since: Since) -> T {
    T::lit(DECISION.surely_low / (1.0 - DECISION.surely_low) / since.prior_of_one(&DECISION)).ln_fast()
}

/// Log likelihood without constants, and prior, of ratios that no set of losses leaves.
fn left_unexplained<T: Real>(change: &[T; 3], covariance: &Triangle<T>, sd: [T; 3], prior: T) -> T {
    let [front, rear, axles] = sd.map(|sd| sd * sd);
    let mut expected = *covariance;
    for (entry, variance) in expected.iter_mut().zip([front, T::zero(), rear, T::zero(), T::zero(), axles]) {
        *entry += variance;
    }
    let Some((inverse, determinant)) = inverse(&expected) else { return T::lit(-1e30) };
    let square = dot(change, &times(&inverse, change));
    T::lit(-0.5) * (square + determinant.ln_fast()) + prior.ln_fast()
}

/// The smallest loss of this wheel alone that would be found, as `-ln` of the share of the pressure that it leaves: its squared distance
/// from no loss is what prior and threshold ask for.
pub(super) fn least_found<T: Real>(
    wheel: usize,
    covariance: &Triangle<T>,
    since: Since,
    torsion: &TorsionEvidence<T>,
    config: &WheelSpeedConfig<T>,
) -> T {
    let (mut noise, per_ln) = (*covariance, config.per_ln_1e3());
    add_radii(&mut noise, fine_sd(since, config.tuning()));
    let step = SEEN.get(wheel).map_or([T::zero(); 3], |seen| seen.map(|x| T::lit(x) * per_ln));
    let radii = inverse(&noise).map_or(T::zero(), |(inverse, _)| dot(&step, &times(&inverse, &step)));
    let tested_ln = DECISION.low[0] * FIFTH;
    let pulses = torsion.distance(1 << wheel) * T::lit(1.0 / (tested_ln * tested_ln));
    (T::lit(2.0) * to_be_found(since) / (radii + pulses)).sqrt()
}

/// Whether a loss of all four alike would be found: radii say nothing of it, and its prior is half of one wheel's.
pub(super) fn all_would_be_found<T: Real>(torsion: &TorsionEvidence<T>) -> bool {
    torsion.distance(SETS - 1)
        > T::lit(2.0) * (to_be_found::<T>(Since::Beginning) + T::lit(core::f64::consts::LN_2))
}

/// Adds what each radius does by itself to the three ratios.
pub(super) fn add_radii<T: Real>(covariance: &mut Triangle<T>, sd: f64) {
    for seen in SEEN {
        add_square(covariance, &seen.map(T::lit), T::lit(sd * sd));
    }
}

/// Adds this part of the covariance that unknown loads give the three ratios since the calibration.
pub(super) fn add_load<T: Real>(covariance: &mut Triangle<T>, config: &WheelSpeedConfig<T>, part: f64) {
    let (load, tuning) = (&config.load, config.tuning());
    let per_load = T::lit(tuning.per_load);
    let rear_axle = [T::zero(), T::zero(), -per_load * load.rear_axle];
    let rear_left_right = [T::zero(), T::lit(2.0) * per_load * load.rear_left_right, T::zero()];
    let passengers = tuning.passenger.map(|x| T::lit(x) * load.front_passengers);
    for shape in [rear_axle, rear_left_right, passengers] {
        add_square(covariance, &shape, T::lit(part));
    }
}

/// Rows and columns of its numbers.
pub(super) const PLACES: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

pub(super) fn add_square<T: Real>(triangle: &mut Triangle<T>, x: &[T; 3], variance: T) {
    for (entry, (row, column)) in triangle.iter_mut().zip(PLACES) {
        *entry += variance * x[row] * x[column];
    }
}

pub(super) fn dot<T: Real>(x: &[T; 3], y: &[T; 3]) -> T {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

pub(super) fn times<T: Real>([a, b, c, d, e, f]: &Triangle<T>, x: &[T; 3]) -> [T; 3] {
    [dot(&[*a, *b, *d], x), dot(&[*b, *c, *e], x), dot(&[*d, *e, *f], x)]
}

/// Inverse and determinant, of a positive matrix.
pub(super) fn inverse<T: Real>(&[a, b, c, d, e, f]: &Triangle<T>) -> Option<(Triangle<T>, T)> {
    let (aa, ba, da) = (c * f - e * e, d * e - b * f, b * e - c * d);
    let determinant = a * aa + b * ba + d * da;
    if !(determinant > T::zero() && determinant.is_finite()) {
        return None;
    }
    let (ca, ea, fa) = (a * f - d * d, b * d - a * e, a * c - b * b);
    let by = T::one() / determinant;
    Some(([aa * by, ba * by, ca * by, da * by, ea * by, fa * by], determinant))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Corner;
    use crate::wheel_speed::tests::config;

    const NO_PULSES: TorsionEvidence<f64> = <TorsionEvidence<f64> as crate::memory::Blank>::BLANK;
    /// Known to a ten-thousandth.
    const SHARP: Triangle<f64> = [0.01, 0.0, 0.01, 0.0, 0.0, 0.01];

    /// A loss of a fifth is 1.56 at .007.
    fn decided(
        change: &[f64; 3],
        covariance: &Triangle<f64>,
        pulses: &TorsionEvidence<f64>,
    ) -> Decision<f64> {
        Decision::of(change, covariance, Since::Ever, pulses, DECISION.unexplained, &config())
    }

    /// The ratios of these radii.
    fn seen(radius: [f64; 4]) -> [f64; 3] {
        core::array::from_fn(|ratio| radius.iter().zip(SEEN).map(|(radius, seen)| radius * seen[ratio]).sum())
    }

    #[test]
    fn an_inverse_is_one() {
        let matrix = [4.0, 1.0, 3.0, -0.5, 0.7, 2.0];
        let (inverse, determinant) = inverse(&matrix).unwrap();
        for (i, unit) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].iter().enumerate() {
            let back = times(&matrix, &times(&inverse, unit));
            assert!((0..3).all(|k| (back[k] - f64::from(u8::from(k == i))).abs() < 1e-12));
        }
        // 4 (3·2 - 0.7²) - 1 (1·2 + 0.5·0.7) - 0.5 (0.7 + 0.5·3)
        assert!((determinant - (4.0 * 5.51 - 2.35 - 0.5 * 2.2)).abs() < 1e-12);
    }

    #[test]
    fn every_pattern_is_named_by_its_ratios_but_all_four() {
        for number in 1..15usize {
            let radius = core::array::from_fn(|i| if number & (1 << i) == 0 { 0.0 } else { -2.0 });
            let decision = decided(&seen(radius), &SHARP, &NO_PULSES);
            let most = decision.sets.of_set().iter().copied().fold(0.0, f64::max);
            assert_eq!(decision.sets.of_set()[number], most, "{number:04b}");
            // Three at once are so rare that the unexplained hypothesis is not much less probable.
            let sure = if number.count_ones() == 3 { 0.7 } else { 0.9 };
            for (wheel, radius) in radius.iter().enumerate() {
                let low = number & (1 << wheel) != 0;
                let probability = decision.sets.low(Corner::ALL[wheel]);
                assert_eq!(probability > sure, low, "{number:04b} {wheel}: {probability}");
                assert!((decision.change[wheel] - radius).abs() < 3.0 * decision.change_sd[wheel]);
            }
        }
        let decision = decided(&[0.0; 3], &SHARP, &NO_PULSES);
        assert!(decision.sets.of_set()[0] > 0.99);
    }

    /// 2 % of a radius at .007 are 94 % of the pressure. A driven axle that slips, unequally left and right, is no set of losses, while what no
    /// loss explains is as frequent as one.
    #[test]
    fn an_empty_tire_is_named_at_once_and_a_slipping_axle_is_none() {
        for wheel in 0..4 {
            let radius = core::array::from_fn(|i| if i == wheel { -20.0 } else { 0.0 });
            let decision = Decision::of(&seen(radius), &SHARP, Since::Ever, &NO_PULSES, 1.0, &config());
            assert!(decision.sets.low(Corner::ALL[wheel]) > 0.99, "{wheel}: {:?}", decision.sets);
            assert!((decision.change[wheel] + 20.0).abs() < 3.0 * decision.change_sd[wheel]);
        }
        let slips = Decision::of(&[3.0, 0.0, 8.0], &SHARP, Since::Ever, &NO_PULSES, 1.0, &config());
        assert!(slips.sets.any_low() < 0.5, "{:?}", slips.sets);
    }

    /// With radii of tires that stray by .2 each a ratio of two has .08 by itself: with as much again a front tire's `2 ln(99 / .025)` are
    /// `x² (1 / .16 + .25 / (4 + .04))` with `x = 7 ln`.
    #[test]
    fn the_least_loss_that_is_found_is_where_prior_and_threshold_meet() {
        let covariance = [0.08, 0.0, 0.08, 0.0, 0.0, 4.0];
        let expected = (2.0 * (99.0 / 0.025f64).ln() / (1.0 / 0.16 + 0.25 / 4.04f64)).sqrt() / 7.0;
        let found = least_found(0, &covariance, Since::Ever, &NO_PULSES, &config());
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        // A finding there has as good as reached the threshold, whatever size is expected.
        let at = |loss: f64| {
            let change = seen([-7.0 * loss, 0.0, 0.0, 0.0]);
            decided(&change, &covariance, &NO_PULSES).sets.low(Corner::ALL[0])
        };
        assert!(at(0.9 * found) < 0.99 && at(1.1 * found) > 0.99, "{} {}", at(0.9 * found), at(1.1 * found));
    }

    #[test]
    fn loads_of_unknown_size_hide_a_rear_tire_and_not_a_front_one() {
        let mut covariance = SHARP;
        add_load(&mut covariance, &config(), 1.0);
        // A fifth of 6.4e-3 per load between the axles, twice 3 % of it between the rear wheels; the passenger's part is in 20 and 21, too.
        assert!((covariance[5] - (0.01 + 1.28 * 1.28 + 0.04)).abs() < 1e-12);
        assert!((covariance[2] - (0.01 + 0.384 * 0.384 + 0.04)).abs() < 1e-12);
        let low = |wheel: usize| {
            let radius = core::array::from_fn(|i| if i == wheel { -2.0 } else { 0.0 });
            decided(&seen(radius), &covariance, &NO_PULSES).sets.low(Corner::ALL[wheel])
        };
        assert!(low(0) > 0.99 && low(0) > low(3), "{} {}", low(0), low(3));
    }

    #[test]
    fn all_four_are_named_by_their_pulses_and_an_axle_after_a_stop_by_both() {
        let pulses = |kpa: [f64; 4]| TorsionEvidence {
            change_kpa: kpa,
            information: [1.0 / 50.0; 4],
            reference_kpa: [240.0; 4],
        };
        let alike = decided(&[0.0; 3], &SHARP, &pulses([-56.0; 4]));
        assert!((0..4).all(|wheel| alike.sets.low(Corner::ALL[wheel]) > 0.99), "{:?}", alike.sets);
        // A tenth of the pressure, as of a cold morning, is nothing.
        let cold = decided(&[0.0; 3], &SHARP, &pulses([-24.0; 4]));
        assert!(cold.sets.of_set()[0] > 0.99, "{:?}", cold.sets.of_set());
        // With loads of unknown size the radii of an axle say little: a larger load may have done it.
        let mut covariance = SHARP;
        add_load(&mut covariance, &config(), 1.0);
        let change = seen([0.0, 0.0, -2.0, -2.0]);
        let (without, with) = (
            decided(&change, &covariance, &NO_PULSES),
            decided(&change, &covariance, &pulses([0.0, 0.0, -58.0, -58.0])),
        );
        let [fl, _, rl, rr] = Corner::ALL.map(|corner| with.sets.low(corner));
        assert!(without.sets.low(Corner::ALL[2]) < 0.5 && rl > 0.99 && rr > 0.99 && fl < 0.01);
    }
}
