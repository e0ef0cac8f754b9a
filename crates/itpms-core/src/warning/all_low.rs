//! All wheels together: a slow loss of all four is more certain in their mean than in any one of them. Against a calibration of an earlier
//! day it may as well be the car that has changed, as a whole or by axle, which is reported as what it is.

use crate::decision::{Probabilities, SURELY_LOW};
use crate::diagnosis::debounce::{DebounceTimes, Debouncer, Evidence};
use crate::memory::Blank;
use crate::model::{CarEstimate, Corner, Level, ONE_SIDED_95, Wheels};
use crate::real::Real;
use crate::warning::low::is_learning;
use crate::warning::{Cause, Limits};

/// The mean is fine again this much above its limit.
const FINE_ABOVE: f64 = 0.03;
/// Seconds in which something was learned of all, for and against.
const ALL_LOW: DebounceTimes = DebounceTimes { set_s: 2.0, clear_s: 20.0 };

const SHIFTED: DebounceTimes = DebounceTimes { set_s: 60.0, clear_s: 20.0 };

/// Remembers since when all wheels are low.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AllLow<T> {
    debouncer: Debouncer,
    shift: Debouncer,
    mean_share: T,
    sd_share: T,
    /// What shifted: which wheels, and their mean with its sd.
    shifted: Wheels,
    shifted_share: [T; 2],
}

impl<T: Real> AllLow<T> {
    pub(crate) fn new() -> Self {
        Self {
            debouncer: Debouncer::new(),
            shift: Debouncer::new(),
            mean_share: T::one(),
            sd_share: T::zero(),
            shifted: Wheels::NONE,
            shifted_share: [T::one(), T::zero()],
        }
    }

    pub(crate) fn debouncer(&self) -> &Debouncer {
        &self.debouncer
    }

    /// Why it is reported, while it is.
    pub(crate) fn cause(&self) -> Option<Cause<T>> {
        let (mean_share, sd_share) = (self.mean_share, self.sd_share);
        self.debouncer.is_active().then_some(Cause::AllLow { mean_share, sd_share })
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
        limits: &Limits<T>,
    ) {
        let Some(shares) = Shares::of(estimate, reference_kpa) else { return };
        let fine = shares.mean > limits.all_low_share + T::lit(FINE_ABOVE);
        if !shares.complete {
            if fine {
                self.debouncer.update(estimate.time_s, step_s, Evidence::Prepassed, ALL_LOW);
            }
            return;
        }
        (self.mean_share, self.sd_share) = (shares.mean, shares.sd);
        let evidence = if low.all_low() > T::lit(SURELY_LOW) {
            Evidence::Prefailed
        } else if fine {
            Evidence::Prepassed
        } else {
            Evidence::Undecided
        };
        self.debouncer.update(estimate.time_s, step_s, evidence, ALL_LOW);
        // What would be fine for one tire is fine for all; and a loss of one tire moves their mean, but not the other tires.
        let far = |shares: &Shares<T>| {
            let fine = T::one() - limits.low_clears_share;
            let off = (shares.mean - T::one()).abs();
            let least = (shares.lowest - T::one()).max(T::one() - shares.highest);
            shares.stored && least > fine && off > T::lit(ONE_SIDED_95) * shares.sd
        };
        let [front, rear] = [0, 1]
            .map(|axle| Shares::of_wheels(estimate, reference_kpa, |wheel| wheel.axle() == axle).filter(far));
        let (wheels, shifted) = match (&front, &rear) {
            (Some(front), None) => (&Corner::ALL[..2], Some(front)),
            (None, Some(rear)) => (&Corner::ALL[2..], Some(rear)),
            _ => (&Corner::ALL[..], Some(&shares).filter(|shares| far(shares))),
        };
        let evidence = if shifted.is_some() { Evidence::Prefailed } else { Evidence::Prepassed };
        if shifted.is_some() {
            // While it is reported it names all that have shifted since.
            let before = if self.shift.is_active() { self.shifted } else { Wheels::NONE };
            self.shifted = before | wheels.iter().copied().collect();
            let named = Shares::of_wheels(estimate, reference_kpa, |wheel| self.shifted.contains(wheel));
            self.shifted_share = named.map_or(self.shifted_share, |named| [named.mean, named.sd]);
        }
        self.shift.update(estimate.time_s, step_s, evidence, SHIFTED);
    }
}

/// Pressures over their references, of the wheels that are learned of.
struct Shares<T> {
    mean: T,
    /// Of the mean, with the errors' correlations.
    sd: T,
    lowest: T,
    highest: T,
    /// Whether these are all four.
    complete: bool,
    /// Whether their level rests on a calibration of an earlier day.
    stored: bool,
}

impl<T: Real> Shares<T> {
    /// `None` where nothing is learned of any wheel.
    fn of(estimate: &CarEstimate<T>, reference_kpa: [T; 4]) -> Option<Self> {
        Self::of_wheels(estimate, reference_kpa, |_| true)
    }

    /// The same of some wheels.
    fn of_wheels(
        estimate: &CarEstimate<T>,
        reference_kpa: [T; 4],
        of: impl Fn(Corner) -> bool,
    ) -> Option<Self> {
        let learned = |i: Corner| estimate.corners[i].as_ref().filter(|corner| of(i) && is_learning(corner));
        let share = Corner::ALL.map(|i| learned(i).map(|corner| corner.pressure_kpa / reference_kpa[i]));
        let sd = Corner::ALL
            .map(|i| learned(i).map_or(T::zero(), |corner| corner.pressure_sd_kpa / reference_kpa[i]));
        let mut variance = T::zero();
        for (i, row) in estimate.correlation.iter().enumerate() {
            for (j, correlation) in row.iter().enumerate() {
                variance += *correlation * sd[i] * sd[j];
            }
        }
        let any = |level| Corner::ALL.into_iter().filter_map(learned).any(|corner| corner.level == level);
        let known = || share.iter().flatten().copied();
        let highest = known().reduce(|highest, share| highest.max(share))?;
        let lowest = known().reduce(|lowest, share| lowest.min(share))?;
        let count = known().fold(T::zero(), |count, _| count + T::one());
        Some(Self {
            mean: known().fold(T::zero(), |sum, share| sum + share) / count,
            sd: variance.max(T::zero()).sqrt() / count,
            lowest,
            highest,
            complete: share.iter().all(Option::is_some),
            stored: any(Level::StoredCalibration),
        })
    }
}
