//! Which tires are low: sixteen hypotheses against what is believed of the radii (`docs/math/wheel-speed.md`, eq. 9-11, 20).

use super::config::LoadUncertainty;
use crate::memory::Blank;
use crate::model::{Corner, SEEN, Wheels};
use crate::real::Real;
use crate::torsion::TorsionEvidence;

/// Which tires are low.
const HYPOTHESES: usize = 16;
/// How far radii of tires that are not low move by themselves, in thousandths.
const FINE_SD: f64 = 0.2;
/// What is expected of a low tire, and its sd, in losses of a fifth.
const LOW_MEAN: f64 = -1.25;
const LOW_SD: f64 = 0.5;
/// Prior of one wheel against none.
const ONE_LOW: f64 = 1e-3;
/// And of two tires of an axle or a side, of all four, and of any others, over that of one.
const PAIR_LOW: f64 = 0.3;
const ALL_LOW: f64 = 0.5;
const OTHERS_LOW: f64 = 0.05;
const AXLES_AND_SIDES: [usize; 4] = [0b0011, 0b1100, 0b0101, 0b1010];
/// `ln (1 / ONE_LOW) + ln 99`: what has to speak for a wheel until its probability is 0.99.
const TO_BE_FOUND: f64 = 11.5;
/// Radius per load, in thousandths: -6.4e-4 of it for a tenth more.
const RADIUS_PER_LOAD: f64 = -6.4;
/// What a front passenger does to the three ratios, in thousandths.
const PASSENGER: [f64; 3] = [-0.3, -0.2, 0.2];

/// A symmetric matrix of three: 00, 10, 11, 20, 21, 22.
pub(super) type Triangle<T> = [T; 6];

/// How probable each hypothesis is, and what follows for each wheel.
#[derive(Debug, Clone, Copy, Blank)]
pub(super) struct Decision<T> {
    /// Bit `i` of the index: wheel `i` is low.
    pub probability: [T; HYPOTHESES],
    /// Change of each radius in thousandths, its sd.
    pub change: [T; 4],
    pub change_sd: [T; 4],
    /// Whether a loss of a quarter of each wheel would be found.
    pub informed: [bool; 4],
}

impl<T: Real> Decision<T> {
    /// The changes of the three ratios of radii with their covariance, in thousandths, and that of the offsets which a calibration taught;
    /// `fifth`: by what a loss of a fifth changes a radius; what tooth pulses say, by themselves.
    pub(super) fn of(
        change: &[T; 3],
        covariance: &Triangle<T>,
        offsets: &Triangle<T>,
        fifth: T,
        torsion: &TorsionEvidence<T>,
    ) -> Self {
        let mut decision = Self { probability: [T::zero(); HYPOTHESES], ..crate::memory::Blank::BLANK };
        let mut posterior = [([T::zero(); 4], [T::zero(); 4]); HYPOTHESES];
        let mut best = T::lit(-1e30);
        for (number, (log, posterior)) in decision.probability.iter_mut().zip(&mut posterior).enumerate() {
            let (likelihood, mean, variance) = Hypothesis::of(number, fifth).against(change, covariance);
            *log = likelihood + torsion.log_likelihood(number) + prior(number);
            *posterior = (mean, variance);
            best = best.at_least(*log);
        }
        let mut total = T::zero();
        for log in &mut decision.probability {
            *log = (*log - best).exp_fast();
            total += *log;
        }
        for (probability, (mean, _)) in decision.probability.iter_mut().zip(&posterior) {
            *probability /= total;
            for (change, mean) in decision.change.iter_mut().zip(mean) {
                *change += *probability * *mean;
            }
        }
        for i in 0..4 {
            let spread = |(p, (mean, variance)): (&T, &([T; 4], [T; 4]))| {
                *p * (variance[i] + (mean[i] - decision.change[i]) * (mean[i] - decision.change[i]))
            };
            let variance =
                decision.probability.iter().zip(&posterior).map(spread).fold(T::zero(), |sum, v| sum + v);
            decision.change_sd[i] = variance.at_least(T::zero()).sqrt();
            // That radii have not moved is believed without any sample; what moves one stands out from how well its offset is known.
            decision.informed[i] =
                [covariance, offsets].iter().all(|known| found_if_low(i, known, fifth, torsion));
        }
        decision
    }

    /// Probability that this wheel is low.
    pub(super) fn low(&self, wheel: usize) -> T {
        self.sum(|number| number & (1 << wheel) != 0)
    }

    /// Probability that some are low, and all of them among these.
    pub(super) fn among(&self, wheels: Wheels) -> T {
        let bits =
            Corner::ALL.iter().filter(|c| wheels.contains(**c)).fold(0, |bits, c| bits | 1 << c.index());
        self.sum(|number| number != 0 && number & !bits == 0)
    }

    fn sum(&self, is: impl Fn(usize) -> bool) -> T {
        let counted = self.probability.iter().enumerate().filter(|(number, _)| is(*number));
        counted.fold(T::zero(), |sum, (_, p)| sum + *p)
    }
}

/// Which radii, in thousandths, are expected where these tires are low.
struct Hypothesis<T> {
    mean: [T; 4],
    variance: [T; 4],
}

impl<T: Real> Hypothesis<T> {
    fn of(number: usize, fifth: T) -> Self {
        let low = |i: usize| number & (1 << i) != 0;
        let sd = T::lit(LOW_SD) * fifth;
        Self {
            mean: core::array::from_fn(|i| if low(i) { T::lit(LOW_MEAN) * fifth } else { T::zero() }),
            variance: core::array::from_fn(|i| if low(i) { sd * sd } else { T::lit(FINE_SD * FINE_SD) }),
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

/// Whether a loss of a quarter of this wheel alone would be found: it stands out by more than the prior and the threshold ask for.
fn found_if_low<T: Real>(
    wheel: usize,
    covariance: &Triangle<T>,
    fifth: T,
    torsion: &TorsionEvidence<T>,
) -> bool {
    let mut noise = *covariance;
    for seen in SEEN {
        add_square(&mut noise, &seen.map(T::lit), T::lit(FINE_SD * FINE_SD));
    }
    let step = SEEN.get(wheel).map_or([T::zero(); 3], |seen| seen.map(|x| T::lit(x * LOW_MEAN) * fifth));
    inverse(&noise).is_some_and(|(inverse, _)| {
        dot(&step, &times(&inverse, &step)) + torsion.distance(1 << wheel) > T::lit(2.0 * TO_BE_FOUND)
    })
}

/// Whether a loss of all four alike would be found: radii say nothing of it, and its prior is half of one wheel's.
pub(super) fn all_would_be_found<T: Real>(torsion: &TorsionEvidence<T>) -> bool {
    torsion.distance(HYPOTHESES - 1) > T::lit(2.0 * (TO_BE_FOUND + core::f64::consts::LN_2))
}

/// Log of how probable it is before any sample, against none.
fn prior<T: Real>(number: usize) -> T {
    let is_pair = AXLES_AND_SIDES.contains(&number);
    let share = match number.count_ones() {
        0 => return T::zero(),
        1 => 1.0,
        2 if is_pair => PAIR_LOW,
        4 => ALL_LOW,
        _ => OTHERS_LOW,
    };
    T::lit(share * ONE_LOW).ln_fast()
}

/// Adds what loads may have done to the three ratios since the calibration.
pub(super) fn add_load<T: Real>(covariance: &mut Triangle<T>, load: &LoadUncertainty<T>) {
    let per_load = T::lit(RADIUS_PER_LOAD);
    let rear_axle = [T::zero(), T::zero(), -per_load * load.rear_axle];
    let rear_left_right = [T::zero(), T::lit(2.0) * per_load * load.rear_left_right, T::zero()];
    let passengers = PASSENGER.map(|x| T::lit(x) * load.front_passengers);
    for shape in [rear_axle, rear_left_right, passengers] {
        add_square(covariance, &shape, T::one());
    }
}

/// What the three ratios see of four radii: their change and its covariance.
pub(super) fn seen<T: Real>(
    radius: &[T; 4],
    covariance: impl Fn(usize, usize) -> T,
) -> ([T; 3], Triangle<T>) {
    let mut change = [T::zero(); 3];
    let mut triangle = [T::zero(); 6];
    for (i, (a, radius)) in SEEN.iter().zip(radius).enumerate() {
        for (change, a) in change.iter_mut().zip(a) {
            *change += T::lit(*a) * *radius;
        }
        for (j, b) in SEEN.iter().enumerate() {
            let shared = covariance(i, j);
            for (entry, (row, column)) in triangle.iter_mut().zip(PLACES) {
                *entry += T::lit(a[row] * b[column]) * shared;
            }
        }
    }
    (change, triangle)
}

/// Rows and columns of its numbers.
pub(super) const PLACES: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

fn add_square<T: Real>(triangle: &mut Triangle<T>, x: &[T; 3], variance: T) {
    for (entry, (row, column)) in triangle.iter_mut().zip(PLACES) {
        *entry += variance * x[row] * x[column];
    }
}

fn dot<T: Real>(x: &[T; 3], y: &[T; 3]) -> T {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

fn times<T: Real>([a, b, c, d, e, f]: &Triangle<T>, x: &[T; 3]) -> [T; 3] {
    [dot(&[*a, *b, *d], x), dot(&[*b, *c, *e], x), dot(&[*d, *e, *f], x)]
}

/// Inverse and determinant, of a positive matrix.
fn inverse<T: Real>(&[a, b, c, d, e, f]: &Triangle<T>) -> Option<(Triangle<T>, T)> {
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

    const NO_PULSES: TorsionEvidence<f64> = <TorsionEvidence<f64> as crate::memory::Blank>::BLANK;
    /// Known to a ten-thousandth.
    const SHARP: Triangle<f64> = [0.01, 0.0, 0.01, 0.0, 0.0, 0.01];

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
            let (change, _) = seen(&radius, |_, _| 0.0);
            let decision = Decision::of(&change, &SHARP, &SHARP, 1.6, &NO_PULSES);
            for (wheel, radius) in radius.iter().enumerate() {
                let low = number & (1 << wheel) != 0;
                assert_eq!(decision.low(wheel) > 0.9, low, "{number:04b} {wheel}: {}", decision.low(wheel));
                assert!((decision.change[wheel] - radius).abs() < 3.0 * decision.change_sd[wheel]);
            }
        }
        let decision = Decision::of(&[0.0; 3], &SHARP, &SHARP, 1.6, &NO_PULSES);
        assert!(decision.probability[0] > 0.99 && decision.informed == [true; 4]);
    }

    /// A quarter is -1.95 of a front tire: 48 of its squared distance where only tires of their own stray (twice .04), 23 with as much again.
    #[test]
    fn what_a_calibration_did_not_teach_is_not_informed() {
        let informed = |variance: f64| {
            let offsets = [variance, 0.0, variance, 0.0, 0.0, 4.0];
            Decision::of(&[0.0; 3], &[1e-4; 6], &offsets, 1.56, &NO_PULSES).informed
        };
        assert_eq!(informed(0.07), [true; 4]);
        assert_eq!(informed(0.1), [false; 4]);
    }

    #[test]
    fn loads_of_unknown_size_hide_a_rear_tire_and_not_a_front_one() {
        let mut covariance = SHARP;
        add_load(&mut covariance, &LoadUncertainty::unknown());
        // A fifth of 6.4e-3 per load between the axles, twice 3 % of it between the rear wheels; the passenger's part is in 20 and 21, too.
        assert!((covariance[5] - (0.01 + 1.28 * 1.28 + 0.04)).abs() < 1e-12);
        assert!((covariance[2] - (0.01 + 0.384 * 0.384 + 0.04)).abs() < 1e-12);
        let low = |wheel: usize| {
            let radius = core::array::from_fn(|i| if i == wheel { -2.0 } else { 0.0 });
            Decision::of(&seen(&radius, |_, _| 0.0).0, &covariance, &SHARP, 1.6, &NO_PULSES).low(wheel)
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
        let alike = Decision::of(&[0.0; 3], &SHARP, &SHARP, 1.6, &pulses([-56.0; 4]));
        assert!((0..4).all(|wheel| alike.low(wheel) > 0.99), "{:?}", alike.probability);
        // A tenth of the pressure, as of a cold morning, is nothing.
        let cold = Decision::of(&[0.0; 3], &SHARP, &SHARP, 1.6, &pulses([-24.0; 4]));
        assert!(cold.probability[0] > 0.99, "{:?}", cold.probability);
        // With loads of unknown size the radii of an axle say little: a larger load may have done it.
        let mut covariance = SHARP;
        add_load(&mut covariance, &LoadUncertainty::unknown());
        let rear = [0.0, 0.0, -2.0, -2.0];
        let change = seen(&rear, |_, _| 0.0).0;
        let (without, with) = (
            Decision::of(&change, &covariance, &SHARP, 1.6, &NO_PULSES),
            Decision::of(&change, &covariance, &SHARP, 1.6, &pulses([0.0, 0.0, -58.0, -58.0])),
        );
        assert!(without.low(2) < 0.5 && with.low(2) > 0.99 && with.low(3) > 0.99 && with.low(0) < 0.01);
    }
}
