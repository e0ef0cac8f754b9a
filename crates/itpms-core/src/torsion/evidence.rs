//! Evidence by the pulses of four wheels about which tires are low (`docs/math/wheel-speed.md`, eq. 18-21). Asked by radius analysis, for each
//! of the sixteen sets of low tires.

use super::SCALE_SD;
use crate::decision::{LOSS, Tuning};
use crate::memory::Blank;
use crate::real::Real;

/// By how much the pressure of a tire that is not low differs by itself, as a share of it.
const FINE_SD: f64 = 0.0286;
/// Lasting uncertainty of a wheel in kPa, however much is driven: by itself, and what all four have in common (load, slip stiffness, road).
const OWN_SD_KPA: f64 = 4.4;
const COMMON_SD_KPA: f64 = 6.7;

/// By how much the pressures have changed since the calibration, as the pieces alone say.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TorsionEvidence<T> {
    /// Changes against what the pressures should be, in kPa, in the order of [`Corner::ALL`](crate::model::Corner::ALL).
    pub change_kpa: [T; 4],
    /// Their information in 1/kPa², without what stays unknown however much is driven; zero where nothing was seen.
    pub information: [T; 4],
    /// Reference pressures in kPa.
    pub reference_kpa: [T; 4],
}

struct Wheel<T> {
    /// Its information, by the variance that the hypothesis adds.
    information: T,
    /// By how much more that variance is than what was seen, plus one: its `ln` is the determinant's part.
    wider: T,
    /// Where the wheel lies from what is expected, in kPa.
    away_kpa: T,
    expected_kpa: T,
}

impl<T: Real> TorsionEvidence<T> {
    /// Log likelihood of a set of low tires, bit `i` for wheel `i`; without what all sets have in common (eq. 20).
    pub(crate) fn log_likelihood(&self, number: usize) -> T {
        let (mut square, mut sum, mut all, mut determinant) = (T::zero(), T::zero(), T::zero(), T::zero());
        for wheel in self.wheels(number) {
            square += wheel.information * wheel.away_kpa * wheel.away_kpa;
            sum += wheel.information * wheel.away_kpa;
            all += wheel.information;
            determinant += wheel.wider.ln_fast();
        }
        let common = T::lit(COMMON_SD_KPA * COMMON_SD_KPA);
        let shared = T::one() + common * all;
        T::lit(-0.5) * (square - common * sum * sum / shared + determinant + shared.ln_fast())
    }

    /// By how much, as a squared distance, the losses of a set of tires would stand out from none.
    pub(crate) fn distance(&self, number: usize) -> T {
        let (mut square, mut sum, mut all) = (T::zero(), T::zero(), T::zero());
        for (fine, low) in self.wheels(0).zip(self.wheels(number)) {
            let pull = fine.information * low.expected_kpa;
            square += pull * low.expected_kpa;
            sum += pull;
            all += fine.information;
        }
        let common = T::lit(COMMON_SD_KPA * COMMON_SD_KPA);
        square - common * sum * sum / (T::one() + common * all)
    }

    /// The `ln` of a wheel's pressure over its reference, and its variance; `None` where nothing was seen.
    pub(crate) fn ln_pressure(&self, wheel: usize) -> Option<(T, T)> {
        let (change_kpa, information) = (*self.change_kpa.get(wheel)?, *self.information.get(wheel)?);
        let reference_kpa = *self.reference_kpa.get(wheel)?;
        if !(information > T::zero() && reference_kpa > T::zero()) {
            return None;
        }
        let left = (T::one() + change_kpa / reference_kpa).at_least(T::lit(0.2));
        let kpa = left * reference_kpa;
        Some((left.ln_fast(), level_variance_kpa2(change_kpa, information) / (kpa * kpa)))
    }

    fn wheels(&self, number: usize) -> impl Iterator<Item = Wheel<T>> + '_ {
        let [lost, lost_sd] = Tuning::DEFAULT.low.map(|losses| losses * LOSS);
        let seen = self.change_kpa.iter().zip(&self.information).zip(&self.reference_kpa);
        seen.enumerate().map(move |(i, ((change_kpa, information), reference_kpa))| {
            let (mean, sd) = if number & (1 << i) != 0 { (-lost, lost_sd) } else { (0.0, FINE_SD) };
            let (expected_kpa, sd_kpa) = (T::lit(mean) * *reference_kpa, T::lit(sd) * *reference_kpa);
            let wider = T::one() + *information * (sd_kpa * sd_kpa + T::lit(OWN_SD_KPA * OWN_SD_KPA));
            Wheel {
                information: *information / wider,
                wider,
                away_kpa: *change_kpa - expected_kpa,
                expected_kpa,
            }
        })
    }
}

/// Variance in kPa² of a wheel that stays however much is driven.
pub(super) const LEVEL_VARIANCE_KPA2: f64 = OWN_SD_KPA * OWN_SD_KPA + COMMON_SD_KPA * COMMON_SD_KPA;

/// Variance in kPa² of a change that pieces show with this information: theirs, what stays unknown of a wheel, and the Hz per kPa.
pub(crate) fn level_variance_kpa2<T: Real>(change_kpa: T, information: T) -> T {
    let scale_kpa = T::lit(SCALE_SD) * change_kpa;
    T::one() / information + T::lit(LEVEL_VARIANCE_KPA2) + scale_kpa * scale_kpa
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix4, Vector4};

    use super::*;

    /// The normal density of eq. 19 from its full covariance.
    fn density(seen: &TorsionEvidence<f64>, low: [bool; 4]) -> f64 {
        let own = |i: usize| {
            let sd = seen.reference_kpa[i] * if low[i] { 0.084 } else { 0.0286 };
            1.0 / seen.information[i] + 4.4 * 4.4 + sd * sd
        };
        let covariance = Matrix4::from_fn(|i, j| 6.7 * 6.7 + if i == j { own(i) } else { 0.0 });
        let mean = Vector4::from_fn(|i, _| if low[i] { -0.25 * seen.reference_kpa[i] } else { 0.0 });
        let away = Vector4::from(seen.change_kpa) - mean;
        let square = away.dot(&(covariance.try_inverse().unwrap() * away));
        -0.5 * (square + covariance.determinant().ln())
    }

    #[test]
    fn a_set_is_as_likely_as_the_normal_distribution_says() {
        let seen = TorsionEvidence {
            change_kpa: [-40.0, 5.0, -3.0, -70.0],
            information: [0.02, 0.01, 0.004, 0.03],
            reference_kpa: [240.0, 240.0, 260.0, 220.0],
        };
        let low = |number: usize| [0, 1, 2, 3].map(|i| number & (1 << i) != 0);
        let none = density(&seen, low(0));
        for number in 0..16 {
            let ours = seen.log_likelihood(number) - seen.log_likelihood(0);
            let apart = ours - (density(&seen, low(number)) - none);
            // The logarithm's approximation is good to 1e-6.
            assert!(apart.abs() < 1e-4, "{number:04b}: {ours} {apart}");
        }
    }

    #[test]
    fn nothing_seen_says_nothing() {
        let nothing = TorsionEvidence { reference_kpa: [240.0; 4], ..TorsionEvidence::<f32>::BLANK };
        assert!((0..16).all(|number| nothing.log_likelihood(number).abs() < 1e-6));
        assert_eq!((nothing.distance(15), nothing.ln_pressure(0)), (0.0, None));
    }
}
