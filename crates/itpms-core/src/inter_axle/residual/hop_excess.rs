//! Whether front and rear disagree near wheel hop more than beside it (docs/math/unknown-car.md, section 3). What makes their roads two
//! grows with frequency; a wheel that is more than a mass on a tire, such as one with a tuned damper, answers otherwise at its hop alone.

use nalgebra::SVector;

use crate::belief::measurement::BINS;
use crate::inter_axle::NEAR_HOP_BINS;
use crate::memory::Blank;
use crate::real::Real;

/// Memory in s, and seconds before anything is reported: the line of a wheel out of balance is found and taken off by then.
const MEMORY_S: f64 = 10.0;
const ENOUGH_S: f64 = 40.0;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct HopExcess<T> {
    log: T,
    seconds: T,
}

impl<T: Real> HopExcess<T> {
    /// Takes the incoherence of every bin (5, 10, ... 25 Hz) after another `seconds` of frames.
    pub(crate) fn take(&mut self, incoherence: &SVector<T, BINS>, seconds: T) {
        self.seconds += seconds;
        let [low, high] = NEAR_HOP_BINS;
        let hop = incoherence[low].max(incoherence[high]);
        let beside = (incoherence[low - 1] * incoherence[high + 1].max(incoherence[high + 2])).sqrt();
        let now = (hop / beside).ln();
        if now.is_finite() {
            let gain = seconds / T::lit(MEMORY_S).min(self.seconds);
            self.log += gain * (now - self.log);
        }
    }

    /// Incoherence at the hop over the geometric mean of that below and above it, once enough was seen.
    pub(crate) fn value(&self) -> Option<T> {
        (self.seconds >= T::lit(ENOUGH_S)).then(|| self.log.exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_road_beside_the_track_is_no_hop_and_a_tuned_mass_is() {
        let value = |incoherence: [f64; BINS]| {
            let mut excess = HopExcess::BLANK;
            assert_eq!(excess.value(), None);
            (0..500).for_each(|_| excess.take(&SVector::from(incoherence), 0.1));
            excess.value().unwrap()
        };
        // Grows with frequency: 0.14/√(0.02·0.2) = 2.2 at the most.
        assert!(value([0.02, 0.06, 0.14, 0.18, 0.2]) < 2.3);
        assert!((value([0.015, 0.06, 0.01, 0.002, 0.001]) - 0.06 / (0.015f64 * 0.002).sqrt()).abs() < 1e-6);
    }
}
