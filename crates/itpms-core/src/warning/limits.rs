//! The limits that a regulation or an engineer sets.

use crate::decision::DECISIVE;
use crate::memory::Blank;
use crate::model::{ParameterError, positive};
use crate::real::Real;

crate::labelled! {
    /// A rule that names a loss of pressure.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum Regulation {
        /// UN R141 (5.3): 20 % below the warm reference.
        #[default]
        UnR141 = "un-r141",
        /// FMVSS 138 (S4.2): 25 % below the placard.
        Fmvss138 = "fmvss-138",
    }
}

impl Regulation {
    /// The name in print.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::UnR141 => "UN R141",
            Self::Fmvss138 => "FMVSS 138",
        }
    }
}

/// How far a calibration may move the reference, as shares of the configured one. A tire at its placard pressure that has not warmed
/// up, as in rain, stays 5 % above the limit of a fifth's loss at the largest; 20 K are 1.1.
const WARM_SPAN: [f64; 2] = [0.97, 1.08];
const PLACARD_SPAN: [f64; 2] = [1.0, 1.0];

/// When to say what. Shares are of a wheel's reference pressure.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits<T> {
    /// Below this share a wheel is low: between the fine pressure and the loss that must be warned of.
    pub low_share: T,
    /// Above this share it is no longer.
    pub low_clears_share: T,
    /// Below this share the mean of all wheels is low.
    pub all_low_share: T,
    /// Above this share a wheel is overfull.
    pub over_share: T,
    /// Below this share it is no longer.
    pub over_clears_share: T,
    /// Rate in kPa per minute from which a fall is a fast leak.
    pub fast_leak_kpa_per_min: T,
    /// Least and largest share of the given reference that a calibration may make of it: a rule that counts from the warm pressure
    /// leaves room, one that counts from the placard's leaves none.
    pub reference_span: [T; 2],
    /// Seconds of driving without information that are reported.
    pub no_information_s: f64,
}

impl<T: Real> Limits<T> {
    /// Limits for a loss (a share of the warm reference) that must be warned of.
    ///
    /// # Errors
    /// The loss must be a share above 0 and at most a half.
    pub fn for_loss(loss_share: T) -> Result<Self, ParameterError> {
        let loss = positive("loss_share", loss_share)?;
        if !(loss <= T::lit(0.5)) {
            return Err(ParameterError {
                name: "loss_share",
                value: loss.to_f64(),
                expected: "a share of at most 0.5",
            });
        }
        Ok(Self::scaled_to(loss, WARM_SPAN))
    }

    /// A limit that is no number, or out of order, would silence the monitor.
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let [least, largest] = self.reference_span;
        let shares = [
            ("low_share", self.low_share, T::zero(), T::one()),
            ("all_low_share", self.all_low_share, T::zero(), T::one()),
            ("low_clears_share", self.low_clears_share, self.low_share, T::one()),
            ("over_share", self.over_share, T::one(), T::lit(10.0)),
            ("over_clears_share", self.over_clears_share, self.low_clears_share, self.over_share),
            ("reference_span's least share", least, T::zero(), largest),
            ("reference_span's largest share", largest, least, T::lit(10.0)),
        ];
        for (name, share, from, to) in shares {
            if !(share > T::zero() && share >= from && share <= to) {
                let expected = "a share of the reference, in order with the others";
                return Err(ParameterError { name, value: share.to_f64(), expected });
            }
        }
        positive("fast_leak_kpa_per_min", self.fast_leak_kpa_per_min)?;
        positive("no_information_s", self.no_information_s)?;
        Ok(())
    }

    /// The loss that has to be warned of.
    pub(crate) fn loss_share(&self) -> T {
        (T::one() - self.low_share) / T::lit(DECISIVE)
    }

    /// Six tenths of the loss decide: 0.88 for a fifth.
    fn scaled_to(loss: T, [least, largest]: [f64; 2]) -> Self {
        Self {
            low_share: T::one() - T::lit(DECISIVE) * loss,
            low_clears_share: T::one() - T::lit(0.4) * loss,
            all_low_share: T::one() - T::lit(DECISIVE) * loss,
            over_share: T::lit(1.25),
            over_clears_share: T::lit(1.2),
            fast_leak_kpa_per_min: T::lit(3.0),
            reference_span: [T::lit(least), T::lit(largest)],
            no_information_s: 600.0,
        }
    }
}

impl<T: Real> From<Regulation> for Limits<T> {
    fn from(regulation: Regulation) -> Self {
        match regulation {
            Regulation::UnR141 => Self::scaled_to(T::lit(0.2), WARM_SPAN),
            Regulation::Fmvss138 => Self::scaled_to(T::lit(0.25), PLACARD_SPAN),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_follow_the_loss() {
        let r141 = Limits::<f64>::from(Regulation::UnR141);
        let us = Limits::<f64>::from(Regulation::Fmvss138);
        assert!((r141.low_share - 0.88).abs() < 1e-12 && (us.low_share - 0.85).abs() < 1e-12);
        assert_eq!(Limits::for_loss(0.2), Ok(r141));
        for bad in [0.0, -0.1, 0.6, f64::NAN] {
            assert_eq!(Limits::for_loss(bad).unwrap_err().name, "loss_share");
        }
    }

    #[test]
    fn no_limit_is_a_number_that_says_nothing() {
        let good = Limits::<f64>::from(Regulation::UnR141);
        for rule in Regulation::ALL {
            assert_eq!(Limits::<f64>::from(rule).check(), Ok(()));
        }
        assert_eq!(Limits::<f32>::for_loss(0.5).unwrap().check(), Ok(()));
        let changes: [fn(&mut Limits<f64>, f64); 9] = [
            |limits, value| limits.low_share = value,
            |limits, value| limits.low_clears_share = value,
            |limits, value| limits.all_low_share = value,
            |limits, value| limits.over_share = value,
            |limits, value| limits.over_clears_share = value,
            |limits, value| limits.fast_leak_kpa_per_min = value,
            |limits, value| limits.reference_span[0] = value,
            |limits, value| limits.reference_span[1] = value,
            |limits, value| limits.no_information_s = value,
        ];
        for (place, change) in changes.into_iter().enumerate() {
            for value in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
                let mut limits = good;
                change(&mut limits, value);
                assert!(limits.check().is_err(), "{place} {value}");
            }
        }
        // Hysteresis the wrong way round.
        assert!(Limits { low_clears_share: 0.8, ..good }.check().is_err());
        assert!(Limits { over_clears_share: 1.3, ..good }.check().is_err());
    }
}
