//! All wheels together: a slow loss of all four is more certain in their mean than in any one of them. Against a calibration of an earlier
//! day it may as well be the car that has changed, as a whole or by axle, which is reported as what it is.

use crate::decision::Probabilities;
use crate::diagnosis::debounce::{Debouncer, Evidence};
use crate::memory::Blank;
use crate::model::{CarEstimate, Corner, Level, ONE_SIDED_95, Wheels};
use crate::real::Real;
use crate::warning::all_tires::weighted_share;
use crate::warning::low::is_learning;
use crate::warning::{Cause, Rules};

/// Remembers since when all wheels are low.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AllLow<T> {
    debouncer: Debouncer,
    shift: Debouncer,
    mean_share: T,
    sd_share: T,
    probability: T,
    /// The shift: which wheels, and their mean with its sd.
    shifted: Wheels,
    shifted_share: [T; 2],
}

impl<T: Real> AllLow<T> {
    pub(crate) fn new() -> Self {
        let (debouncer, shift) = (Debouncer::new(), Debouncer::new());
        Self { debouncer, shift, mean_share: T::one(), shifted_share: [T::one(), T::zero()], ..Self::BLANK }
    }

    pub(crate) fn debouncer(&self) -> &Debouncer {
        &self.debouncer
    }

    /// Why it is reported, while it is.
    pub(crate) fn cause(&self) -> Option<Cause<T>> {
        let Self { mean_share, sd_share, probability, .. } = *self;
        self.debouncer.is_active().then_some(Cause::AllLow { mean_share, sd_share, probability })
    }

    pub(crate) fn shift(&self) -> &Debouncer {
        &self.shift
    }

    /// Why a shift is reported, and of which wheels, while it is.
    pub(crate) fn shift_cause(&self) -> Option<(Wheels, Cause<T>)> {
        let [mean_share, sd_share] = self.shifted_share;
        self.shift.is_active().then_some((self.shifted, Cause::CommonShift { mean_share, sd_share }))
    }

    /// Takes what was estimated over the last `step_s` seconds. It takes all four wheels and something learned of each to say it;
    /// to take it back, those that are learned of will do.
    pub(crate) fn update(
        &mut self,
        step_s: f64,
        estimate: &CarEstimate<T>,
        reference_kpa: [T; 4],
        low: &Probabilities<T>,
        &Rules { limits, decision, tuning }: &Rules<'_, T>,
    ) {
        let Some(shares) = Shares::of(estimate, reference_kpa, Wheels::ALL) else { return };
        let fine = shares.mean > limits.all_low_share + T::lit(tuning.all_fine_above);
        if !shares.complete {
            if fine {
                self.debouncer.update(estimate.time_s, step_s, Evidence::Prepassed, tuning.all_low);
            }
            return;
        }
        (self.mean_share, self.sd_share, self.probability) = (shares.mean, shares.sd, low.all_low());
        let evidence = if self.probability > T::lit(decision.surely_low) {
            Evidence::Prefailed
        } else if fine {
            Evidence::Prepassed
        } else {
            Evidence::Undecided
        };
        self.debouncer.update(estimate.time_s, step_s, evidence, tuning.all_low);
        // What would be fine for one tire is fine for all; and a loss of one tire moves their mean, but not the other tires.
        let far = |shares: &Shares<T>| {
            let fine = T::one() - limits.low_clears_share;
            let off = (shares.mean - T::one()).abs();
            let least = (shares.lowest - T::one()).max(T::one() - shares.highest);
            shares.stored && least > fine && off > T::lit(ONE_SIDED_95) * shares.sd
        };
        let axles =
            [Corner::FrontLeft, Corner::RearLeft].map(|left| Wheels::from(left) | left.same_axle().into());
        let of = |wheels| Shares::of(estimate, reference_kpa, wheels);
        let shifted = match axles.map(|wheels| Some((wheels, of(wheels).filter(far)?))) {
            [one, None] | [None, one] if one.is_some() => one,
            _ => Some((Wheels::ALL, shares)).filter(|(_, shares)| far(shares)),
        };
        let evidence = if shifted.is_some() { Evidence::Prefailed } else { Evidence::Prepassed };
        if let Some((wheels, _)) = shifted {
            // While it is reported it names all that have shifted since.
            let before = if self.shift.is_active() { self.shifted } else { Wheels::NONE };
            self.shifted = before | wheels;
            self.shifted_share = of(self.shifted).map_or(self.shifted_share, |named| [named.mean, named.sd]);
        }
        self.shift.update(estimate.time_s, step_s, evidence, tuning.shifted);
    }
}

/// Pressures over their references, of the wheels that are learned of.
struct Shares<T> {
    mean: T,
    /// Of the mean, with the errors' correlations.
    sd: T,
    lowest: T,
    highest: T,
    complete: bool,
    /// Whether their level rests on a calibration of an earlier day.
    stored: bool,
}

impl<T: Real> Shares<T> {
    /// Of these wheels; `None` where nothing is learned of any.
    fn of(estimate: &CarEstimate<T>, reference_kpa: [T; 4], wheels: Wheels) -> Option<Self> {
        let learned = |i: &Corner| estimate.corners[*i].as_ref().is_some_and(is_learning);
        let learned: Wheels = wheels.iter().filter(learned).collect();
        let one = learned.iter().fold(T::zero(), |count, _| count + T::one()).recip();
        let weights = Corner::ALL.map(|i| if learned.contains(i) { one } else { T::zero() });
        let [mean, sd] = weighted_share(estimate, weights, reference_kpa)?;
        let tires = || learned.iter().filter_map(|i| Some((i, estimate.corners[i].as_ref()?)));
        let share = || tires().map(|(i, tire)| tire.pressure_kpa / reference_kpa[i]);
        Some(Self {
            mean,
            sd,
            lowest: share().reduce(T::at_most)?,
            highest: share().reduce(T::at_least)?,
            complete: learned == Wheels::ALL,
            stored: tires().any(|(_, tire)| tire.level == Level::StoredCalibration),
        })
    }
}
