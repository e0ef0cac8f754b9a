//! Readings of the road's spectra during a calibration: whether the driver has set them.

use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CalibrationReading<T> {
    /// One over the variances in kPa², and that times how much more than the placard's pressure was read, in kPa.
    weight: [T; 4],
    excess: [T; 4],
}

impl<T: Real> CalibrationReading<T> {
    /// Takes by how much a corner's spectrum reads more than the placard's pressure, with its variance, in kPa.
    pub(super) fn take(&mut self, corner: Corner, excess_kpa: T, variance_kpa2: T) {
        let weight = T::one() / variance_kpa2;
        if weight > T::zero() && weight.is_finite() && excess_kpa.is_finite() {
            self.weight[corner] += weight;
            self.excess[corner] += weight * excess_kpa;
        }
    }

    /// The mean over the corners that were observed, and its standard deviation as far as the spectra tell, in kPa.
    pub(super) fn mean_kpa(&self) -> Option<(T, T)> {
        let (mut count, mut mean, mut variance) = (T::zero(), T::zero(), T::zero());
        for (&weight, &excess) in self.weight.iter().zip(&self.excess) {
            if weight > T::zero() {
                count += T::one();
                mean += excess / weight;
                variance += T::one() / weight;
            }
        }
        (count > T::zero()).then(|| (mean / count, variance.sqrt() / count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_are_weighed_by_their_variances_and_corners_alike() {
        let mut reading = CalibrationReading::<f64>::BLANK;
        assert_eq!(reading.mean_kpa(), None);
        reading.take(Corner::FrontLeft, -40.0, 100.0);
        reading.take(Corner::FrontLeft, -60.0, 300.0);
        reading.take(Corner::RearRight, -20.0, 75.0);
        reading.take(Corner::FrontRight, f64::NAN, 10.0);
        reading.take(Corner::FrontRight, 5.0, 0.0);
        // Of the first corner -45 ± √75, of the fourth -20 ± √75.
        let (mean, sd) = reading.mean_kpa().unwrap();
        assert!((mean + 32.5).abs() < 1e-9 && (sd - 150f64.sqrt() / 2.0).abs() < 1e-9, "{mean} {sd}");
    }
}
