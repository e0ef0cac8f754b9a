//! Whether a corner's body moves as the vehicle file says, and what was found of it on the way (docs/math/unknown-car.md, section 3).

use crate::memory::Blank;
use crate::model::Level;
use crate::model::uncertainty::ONE_SIDED_95;
use crate::real::Real;

/// Share of the body's motion, 5 to 16 Hz, that does not go with the wheel's: from the first on nothing is believed, below the second
/// it is again. Cars that fit have 0.26 to 0.36 on any road, of which pitch and roll are the most; real sensors in wrong places 0.5 to 1.
const MOST_INCOHERENT: [f64; 2] = [0.45, 0.42];
/// The same of the residual of the body's equation of motion over four corners, 5 to 20 Hz: 0.03 at most where it fits,
/// 0.18 to 0.3 where a body twists at 22 Hz, whose tires are read well, 0.7 and more where one sensor stands for all
/// corners. From the first on there is more doubt, from the second on nothing is believed.
const PARTLY_UNEXPLAINED: [f64; 2] = [0.25, 0.22];
const MOST_UNEXPLAINED: [f64; 2] = [0.6, 0.55];
/// The same of the axles' disagreement near wheel hop over that beside it: 2.5 at most where wheels are masses on tires, 10 where one
/// axle has tuned dampers.
const MOST_HOP_EXCESS: [f64; 2] = [5.0, 4.0];
/// The same of how far the wheels' answers to their road are from the quarter car's: 0.1 to 0.45 in cars that differ from their files as typical
/// ones do, 0.57 to 1 where the sensors of an axle have another gain, another low pass or a mount that rings.
const MOST_RESPONSE_ERROR: [f64; 2] = [0.55, 0.48];

/// Bins over which the two shares are averaged, 2.5 Hz apart: 5 to 16 Hz (below, pitch and roll move a corner with the others' wheels; above, bushings
/// decide), and 5 to 20 Hz.
pub(crate) const COHERENCE_BINS: core::ops::Range<usize> = 1..6;
pub(crate) const UNEXPLAINED_BINS: core::ops::Range<usize> = 1..8;

/// How well body and wheel of a corner go together.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyFit<T> {
    /// Share of the body's acceleration, 5 to 16 Hz, that does not go with the wheel's: one less their coherence; `None` as long as
    /// too little was seen.
    pub incoherence: Option<T>,
    /// Share of the body's acceleration, 5 to 20 Hz, that springs, dampers, anti-roll bars and friction of all four corners leave
    /// unexplained; `None` as long as too little was seen, and where corners are missing.
    pub unexplained: Option<T>,
    /// How much more front and rear disagree about their road near wheel hop than beside it; `None` as long as too little was shared.
    pub hop_excess: Option<T>,
    /// How far the accelerations of the side's wheels are from what the quarter car makes of the road that both share, as a share of that (rms
    /// from 5 to 25 Hz, the farther axle); `None` as long as too little was shared.
    pub response_error: Option<T>,
    /// Whether front and rear of neither side have met the same road, though the car drove at a known speed.
    pub is_apart: bool,
    /// Number of independent averages behind both shares: by so much are they uncertain.
    pub averages: T,
    /// Friction of the strut in N, as the body's motion tells it.
    pub friction_n: T,
}

/// How well front and rear of a side go together on their road: the fields of [`BodyFit`]; blank without another corner on the side.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
pub(crate) struct AxleFit<T> {
    pub(crate) hop_excess: Option<T>,
    pub(crate) response_error: Option<T>,
    pub(crate) is_apart: bool,
}

/// The misfit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Misfit {
    /// Body and wheel of the corner move each for itself.
    #[blank]
    Incoherent,
    /// The four struts' forces do not accelerate the body as it moves.
    Unexplained,
    /// Front and rear answer the road differently near wheel hop.
    Hop,
    /// The wheels do not answer the road that front and rear share as a mass on a tire does, whatever the pressure.
    Response,
    /// Front and rear do not meet the same road.
    Apart,
    /// The four struts' forces explain most of how the body moves, not all.
    PartlyUnexplained,
}

impl Misfit {
    /// Whether nothing is to be believed, or how much more doubt there is: a relative standard deviation of the stiffness. A calibration
    /// has set the level whatever the car is; what is left are 5 to 8 kPa of it and 10 to 20 of a change by a fifth.
    pub(crate) fn doubt(self, level: Level) -> Option<f64> {
        match (self, level) {
            (Self::Incoherent | Self::Unexplained | Self::Response | Self::Apart, _)
            | (Self::Hop, Level::VehicleFile) => None,
            (Self::PartlyUnexplained, Level::VehicleFile) => Some(0.08),
            (Self::Hop | Self::PartlyUnexplained, _) => Some(0.035),
        }
    }
}

impl core::fmt::Display for Misfit {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Incoherent => {
                "body and wheel move each for itself: look where both sensors sit, which way they point and whether their clocks agree"
            }
            Self::Hop => {
                "front and rear wheels do not respond near wheel hop as a mass on a tire does: look for tuned dampers, loose parts and the unsprung masses in the vehicle file"
            }
            Self::Response => {
                "front and rear wheels do not answer their common road as masses on tires do, whatever the pressures: look at the wheel sensors' scales, filters and mounts, and whether the speed is late"
            }
            Self::Apart => {
                "front and rear do not meet the same road: look whether corners are exchanged, at the wheelbase, at the speed's unit, and whether all sensors have one clock, or drive on a rougher road"
            }
            Self::PartlyUnexplained => {
                "the struts' forces do not explain all of how the body moves: a body that bends, sensors on soft mounts, or masses in the vehicle file that are far off"
            }
            Self::Unexplained => {
                "the struts' forces do not explain how the body moves: look at the body sensors' places and mounts, and at the masses in the vehicle file"
            }
        })
    }
}

impl<T: Real> BodyFit<T> {
    /// Whether body and wheel surely go together well enough for a pressure, be it one of more doubt: also where the shares are as large as so few averages allow. Of `K` averages a coherence
    /// `γ²` is estimated with a standard deviation of `(1 - γ²) √(2 γ² / K)`, a share of a power with `√(2 / K)` of it, both over the root of the
    /// number of bins (Bendat and Piersol, *Random Data*, chapter 9).
    pub(crate) fn is_surely_usable(&self, level: Level) -> bool {
        if !(self.averages > T::zero()) {
            return false;
        }
        let upper = |share: T, squared_spread: T, bins: usize| {
            share
                * (T::one()
                    + T::lit(ONE_SIDED_95)
                        * (squared_spread / (self.averages * T::whole(bins as u32))).sqrt())
        };
        let two = T::lit(2.0);
        let incoherence =
            |share: T| upper(share, two * (T::one() - share).max(T::zero()), COHERENCE_BINS.len());
        let largest = Self {
            incoherence: self.incoherence.map(incoherence),
            unexplained: self.unexplained.map(|share| upper(share, two, UNEXPLAINED_BINS.len())),
            ..*self
        };
        largest.misfit(None).is_none_or(|misfit| misfit.doubt(level).is_some())
    }

    /// The misfit, given that of `before`.
    pub(crate) fn misfit(&self, before: Option<Misfit>) -> Option<Misfit> {
        let over = |value: Option<T>, [most, again]: [f64; 2], misfit: Misfit| {
            let limit = if before == Some(misfit) { again } else { most };
            // NaN fits nothing.
            value.is_some_and(|value| !(value < T::lit(limit))).then_some(misfit)
        };
        // The body equation of a whole car knows what the other wheels do to a corner; coherence does not.
        // A body that bends is hardly explained either, but its corners go with their wheels.
        let incoherent = || over(self.incoherence, MOST_INCOHERENT, Misfit::Incoherent);
        match self.unexplained {
            Some(_) => over(self.unexplained, MOST_UNEXPLAINED, Misfit::Unexplained)
                .filter(|_| incoherent().is_some()),
            None => incoherent(),
        }
        .or_else(|| self.is_apart.then_some(Misfit::Apart))
        .or_else(|| over(self.response_error, MOST_RESPONSE_ERROR, Misfit::Response))
        .or_else(|| over(self.hop_excess, MOST_HOP_EXCESS, Misfit::Hop))
        .or_else(|| over(self.unexplained, PARTLY_UNEXPLAINED, Misfit::PartlyUnexplained))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_detected_until_it_clearly_does() {
        let fit = |incoherence: f64| BodyFit { incoherence: Some(incoherence), ..BodyFit::BLANK };
        assert_eq!(fit(0.36).misfit(None), None);
        assert_eq!(fit(0.5).misfit(None), Some(Misfit::Incoherent));
        assert_eq!(fit(0.43).misfit(None), None);
        assert_eq!(fit(0.43).misfit(Some(Misfit::Incoherent)), Some(Misfit::Incoherent));
        assert_eq!(fit(f64::NAN).misfit(None), Some(Misfit::Incoherent));
        let body = |share: f64| BodyFit { unexplained: Some(share), ..fit(0.5) };
        assert_eq!(body(0.8).misfit(None), Some(Misfit::Unexplained));
        assert_eq!(body(0.4).misfit(None), Some(Misfit::PartlyUnexplained));
        // Where the whole body is explained, what the other wheels do to a corner is no misfit.
        assert_eq!(body(0.02).misfit(None), None);
        let hop = BodyFit { hop_excess: Some(9.0), ..fit(0.3) };
        assert_eq!(hop.misfit(None), Some(Misfit::Hop));
        // Nothing is believed of wheels that are no masses on tires, or never on one road, calibrated or not.
        let response = BodyFit { response_error: Some(0.6), ..hop };
        assert_eq!(response.misfit(None), Some(Misfit::Response));
        let apart = BodyFit { is_apart: true, ..response };
        assert_eq!(apart.misfit(None), Some(Misfit::Apart));
        for misfit in [Misfit::Response, Misfit::Apart] {
            assert_eq!(misfit.doubt(Level::Calibration), None);
        }
        assert_eq!(BodyFit::<f64>::BLANK.misfit(None), None);
    }
}
