//! Whether the axles have just stopped sharing a road: in a bend the rear wheels leave the front ones' track within a second,
//! and until the estimator has noticed, what they disagree by looks like a leak.

use crate::diagnosis::Tuning;
use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::LASTING_S;

/// Usual incoherence of a side.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DecorrelationDetector<T> {
    usual: Option<T>,
}

impl<T: Real> DecorrelationDetector<T> {
    pub(crate) fn new() -> Self {
        Self { usual: None }
    }

    /// Takes the incoherence after `step_s` seconds, NaN if no road is shared; true while the tracks part.
    pub(crate) fn update(&mut self, step_s: f64, incoherence: T, tuning: &Tuning) -> bool {
        if !incoherence.is_finite() {
            return false;
        }
        let before = self.usual.unwrap_or(incoherence);
        let parting =
            incoherence > T::lit(tuning.parting) && incoherence > T::lit(tuning.parting_over_usual) * before;
        let grown = before + (incoherence - before) * T::lit((step_s / LASTING_S).min(1.0));
        self.usual = Some(grown.min(incoherence));
        parting
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(parting: &mut DecorrelationDetector<f64>, seconds: f64, incoherence: f64) -> usize {
        (0..(seconds * 10.0) as usize).filter(|_| parting.update(0.1, incoherence, &Tuning::DEFAULT)).count()
    }

    #[test]
    fn tracks_part_for_some_seconds_and_then_that_is_usual() {
        let mut parting = DecorrelationDetector::new();
        assert_eq!(run(&mut parting, 30.0, 0.004), 0);
        // Usual is 1 - 0.996 exp(-t / 20 s), a fifth after 4.4 s.
        assert!((40..50).contains(&run(&mut parting, 30.0, 1.0)));
        // Together again, and apart again.
        assert_eq!(run(&mut parting, 1.0, 0.004), 0);
        assert!((40..50).contains(&run(&mut parting, 30.0, 1.0)));
    }

    #[test]
    fn what_a_puncture_does_is_no_parting() {
        // Largest rises seen at punctures: from 0.001 to 0.01 on a shared road, from 0.034 to 0.13 where wheels leave the ground.
        for (before, after) in [(0.001, 0.01), (0.034, 0.13), (0.05, 0.08)] {
            let mut parting = DecorrelationDetector::new();
            run(&mut parting, 30.0, before);
            assert_eq!(run(&mut parting, 10.0, after), 0);
        }
    }

    #[test]
    fn a_road_that_is_not_shared_or_not_known_is_no_parting() {
        let mut parting = DecorrelationDetector::new();
        assert_eq!(run(&mut parting, 10.0, f64::NAN), 0);
        // The first thing seen is what is usual.
        assert_eq!(run(&mut parting, 10.0, 1.0), 0);
        assert_eq!(run(&mut parting, 10.0, f64::NAN), 0);
        assert_eq!(run(&mut parting, 10.0, 1.0), 0);
    }
}
