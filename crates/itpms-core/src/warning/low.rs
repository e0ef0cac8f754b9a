//! One wheel's pressure against its limits, and how long ago something was learned of it.

use crate::diagnosis::debounce::{DebounceTimes, Debouncer, Evidence};
use crate::memory::Blank;
use crate::model::{CornerEstimate, Level, ONE_SIDED_95, Validity};
use crate::real::Real;
use crate::warning::report::{Doubt, WheelState};
use crate::warning::{Basis, Limits, NOT_HEALTHY, Reading};

/// So many sds count double: a pressure that is far past its limit need not be waited for as long.
const VERY_CERTAIN: f64 = 3.0;
/// Seconds in which something was learned, for and against.
const LOW: DebounceTimes = DebounceTimes { set_s: 2.0, clear_s: 10.0 };
const OVER: DebounceTimes = DebounceTimes { set_s: 60.0, clear_s: 10.0 };
const FLAT: DebounceTimes = DebounceTimes { set_s: 5.0, clear_s: 10.0 };
/// No one inflates one tire of an axle by so much of its reference more than the other; a tire on its rim is harder than that.
const NOBODY_INFLATES: f64 = 0.5;
/// A tire that is lower than the other one of its side by less than this share of the reference goes with it, and then a
/// second counts for that much less: two tires hardly lose pressure alike within minutes, but the level of a side is what
/// an estimator is most easily wrong in. The same of two that seem hard as rims.
pub(crate) const ALONE: f64 = 0.06;
/// By how much less a second counts then.
const TOGETHER: f64 = 75.0;
/// Reported of a wheel of which nothing is known although the car drives.
const UNINFORMED: DebounceTimes = DebounceTimes { set_s: 0.0, clear_s: 1.0 };
/// Information gate above which something is being learned.
const LEARNING: f64 = 0.1;
/// Speed in m/s above which a car should learn something: 20 km/h.
const SHOULD_LEARN_M_S: f64 = 5.5;
/// Seconds of standing after which what a tire had when the car stopped is no longer what it has.
const STANDING_S: f64 = 30.0;
/// Seconds for which a corner has to have fitted before a warning stands whatever comes: the memory of what tells a misfit.
const FITTED_S: f64 = 20.0;
/// Seconds of learning after which what had been forgotten, as after a night, is known anew: not by its first frame.
const ANEW_S: f64 = 2.0;

/// What else is known when a wheel is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Around<T> {
    pub(crate) speed_m_s: T,
    /// Pressure over its reference.
    pub(crate) share: T,
    /// Pressure of the side's other tire over its reference, if there is one.
    pub(crate) other_share: Option<T>,
    /// Whether there is another tire on the side whose sensors say nothing, so that nothing is held against this one.
    pub(crate) other_is_silent: bool,
    /// By how much the tire's share of its reference is above that of the side's other tire, and the sd of that, if both are known.
    pub(crate) above_side: Option<[T; 2]>,
    /// By how much the tire's share of its reference is above the mean of the others', and the sd of that, if all are known.
    pub(crate) above_others: Option<[T; 2]>,
    /// The same above the other tire of its axle.
    pub(crate) above_partner: Option<[T; 2]>,
    /// What it has lost in this drive more than the others, as a share of its level, and the sd of that.
    pub(crate) lost: Option<[T; 2]>,
    /// Whether it has surely lost too much, and the other tire of its side less.
    pub(crate) lost_alone: bool,
    /// Whether what front and rear of the side disagree by may be the road's or a sensor's.
    pub(crate) doubted: bool,
}

impl<T: Real> Around<T> {
    /// Whether the tire is harder than an inflated one can be: overfull, and surely so seen from the other one of its axle.
    pub(crate) fn is_hard(&self, limits: &Limits<T>) -> bool {
        let over = self.share > limits.over_share;
        over && self.above_partner.is_some_and(|[above, sd]| {
            above > T::lit(NOBODY_INFLATES)
                && above - T::lit(ONE_SIDED_95) * sd > limits.over_share - T::one()
        })
    }

    /// Whether the tire is surely lower than the other one of its side, or has none.
    fn is_low_alone(&self) -> bool {
        !self.other_is_silent
            && self.other_share.is_none_or(|other| other - self.share > T::lit(ALONE))
            && self.above_side.is_none_or(|[above, sd]| above + T::lit(ONE_SIDED_95) * sd < T::zero())
    }

    /// Whether the side's other tire reads as overfull, too: its level is off and not two rims are on the road.
    pub(crate) fn is_side_over(&self, limits: &Limits<T>) -> bool {
        self.other_share.is_some_and(|other| other > limits.over_share)
    }
}

/// What is remembered of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WheelWatch {
    pub(crate) low: Debouncer,
    pub(crate) over: Debouncer,
    pub(crate) flat: Debouncer,
    pub(crate) uninformed: Debouncer,
    pub(crate) informed_s: f64,
    /// Until when that is known; minus infinity before anything was.
    known_until_s: f64,
    /// Seconds in which something was learned since all that had been known was forgotten.
    anew_s: f64,
    /// Seconds of driving since something was last learned.
    pub(crate) driven_s: f64,
    /// Seconds for which it has stood since then, and all in which something was learned.
    stood_s: f64,
    fitted_s: f64,
    /// Whether the tire seems hard as a rim and the other one of its side overfull, which is no pressure.
    pub(crate) side_is_off: bool,
}

impl WheelWatch {
    pub(crate) fn new() -> Self {
        Self {
            low: Debouncer::new(),
            over: Debouncer::new(),
            flat: Debouncer::new(),
            uninformed: Debouncer::new(),
            informed_s: f64::NEG_INFINITY,
            known_until_s: f64::NEG_INFINITY,
            anew_s: 0.0,
            driven_s: 0.0,
            stood_s: 0.0,
            fitted_s: 0.0,
            side_is_off: false,
        }
    }

    /// Takes what was estimated over the last `step_s` seconds.
    pub(crate) fn update<T: Real>(
        &mut self,
        step_s: f64,
        estimate: &CornerEstimate<T>,
        reference_kpa: T,
        around: &Around<T>,
        limits: &Limits<T>,
    ) {
        let time_s = estimate.time_s;
        let learning = is_learning(estimate);
        if learning {
            let forgotten = self.is_forgotten(time_s);
            (self.driven_s, self.stood_s) = (0.0, 0.0);
            self.fitted_s += step_s;
            self.anew_s = if forgotten { self.anew_s + step_s } else { 0.0 };
            if !forgotten || self.anew_s >= ANEW_S {
                self.informed_s = time_s;
            }
        } else if around.speed_m_s > T::lit(SHOULD_LEARN_M_S) {
            self.driven_s += step_s;
        } else if around.speed_m_s < T::lit(SHOULD_LEARN_M_S) {
            self.stood_s += step_s;
        }
        let shown_s = if self.stood_s < STANDING_S { limits.no_information_s } else { 0.0 };
        self.known_until_s = self.informed_s + shown_s;
        let silent = self.driven_s >= limits.no_information_s;
        let uninformed = if silent { Evidence::Prefailed } else { Evidence::Prepassed };
        self.uninformed.update(time_s, step_s, uninformed, UNINFORMED);
        // What was seen of a corner that has never fitted for long was no tire.
        if estimate.validity == Validity::Misfit && self.fitted_s < FITTED_S {
            (self.low, self.over) = (Debouncer::new(), Debouncer::new());
        }
        if !learning {
            return;
        }
        let (p, sd) = (estimate.pressure_kpa, estimate.pressure_sd_kpa);
        let low_kpa = limits.low_share * reference_kpa;
        let alone = around.is_low_alone() || around.lost_alone;
        let deficits = deficits(estimate, reference_kpa, around, limits);
        let short = |sds: f64| {
            let limit = T::one() - limits.low_share;
            deficits.iter().flatten().any(|[less, sd]| *less - T::lit(sds) * *sd > limit)
        };
        let low = if short(ONE_SIDED_95) {
            if around.doubted { Evidence::NoData } else { Evidence::Prefailed }
        } else if p - T::lit(ONE_SIDED_95) * sd > low_kpa || p > limits.low_clears_share * reference_kpa {
            Evidence::Prepassed
        } else {
            Evidence::Undecided
        };
        let certainty = if short(VERY_CERTAIN) { 2.0 } else { 1.0 };
        let weight = match low {
            Evidence::Prefailed if alone => certainty,
            Evidence::Prefailed => certainty / TOGETHER,
            _ => 1.0,
        };
        self.low.update(time_s, weight * step_s, low, LOW);
        let over = if p - T::lit(ONE_SIDED_95) * sd > limits.over_share * reference_kpa {
            Evidence::Prefailed
        } else if p < limits.over_clears_share * reference_kpa {
            Evidence::Prepassed
        } else {
            Evidence::Undecided
        };
        self.over.update(time_s, step_s, over, OVER);
        let flat = match around.above_partner {
            Some(_) if around.is_hard(limits) => Evidence::Prefailed,
            Some([above, _]) if above < limits.over_clears_share - T::one() => Evidence::Prepassed,
            _ => Evidence::Undecided,
        };
        self.side_is_off = around.is_hard(limits) && around.is_side_over(limits);
        let weight = if self.side_is_off { 1.0 / TOGETHER } else { 1.0 };
        self.flat.update(time_s, weight * step_s, flat, FLAT);
    }

    /// Whether what was learned of the wheel is too long ago to be shown: no one has looked at a tire since the car stopped.
    pub(crate) fn is_forgotten(&self, time_s: f64) -> bool {
        !(time_s < self.known_until_s) && self.known_until_s != f64::NEG_INFINITY
    }

    /// Why nothing is known of it then.
    pub(crate) fn forgotten(&self) -> Doubt {
        if self.stood_s < STANDING_S { Doubt::NoInformation } else { Doubt::Standing }
    }

    /// The wheel's state if nothing is to be reported of it: fine, or why that is not known.
    pub(crate) fn quiet_state<T: Real>(
        &self,
        estimate: &CornerEstimate<T>,
        reference_kpa: T,
        limits: &Limits<T>,
    ) -> WheelState {
        let reaches = estimate.pressure_kpa - T::lit(ONE_SIDED_95) * estimate.pressure_sd_kpa;
        match estimate.validity {
            Validity::Starting => WheelState::Unknown(Doubt::Starting),
            Validity::NoInformation => WheelState::Unknown(Doubt::NoInformation),
            Validity::BadSignal | Validity::Diverged => WheelState::Unknown(Doubt::Suspicion),
            Validity::Misfit => WheelState::Unknown(Doubt::Misfit),
            Validity::Valid if !(estimate.time_s < self.known_until_s) => {
                WheelState::Unknown(self.forgotten())
            }
            Validity::Valid if reaches > limits.low_share * reference_kpa => WheelState::Fine,
            Validity::Valid => WheelState::Unknown(Doubt::Uncertain),
        }
    }
}

/// Whether there is a pressure and something new is being learned of it.
pub(crate) fn is_learning<T: Real>(estimate: &CornerEstimate<T>) -> bool {
    estimate.validity.is_valid() && estimate.diagnostics.gate > T::lit(LEARNING)
}

/// Whether a level that rests on the vehicle file may be that of a healthy tire all the same.
fn may_be_healthy<T: Real>(estimate: &CornerEstimate<T>, reference_kpa: T) -> bool {
    let reaches_kpa = estimate.pressure_kpa + T::lit(NOT_HEALTHY) * estimate.pressure_sd_kpa;
    estimate.level == Level::VehicleFile && !(reaches_kpa < reference_kpa)
}

/// By how much a tire has less than it should, as a share of that, and the sd of it, for each thing that it can be held against: its level,
/// the others, its axle's other tire, itself earlier in this drive. What all tires are wrong by alike cancels in the second, what an axle's
/// are in the third, and whatever is constant in the last. A car changes between two days as a whole or by axle (tires, wheels, dampers,
/// load), so against a calibration of an earlier day only the last two say that it is the tire.
fn deficits<T: Real>(
    estimate: &CornerEstimate<T>,
    reference_kpa: T,
    around: &Around<T>,
    limits: &Limits<T>,
) -> [Option<[T; 2]>; 4] {
    let share = estimate.pressure_kpa / reference_kpa;
    let may_have_changed = estimate.level == Level::StoredCalibration && around.above_partner.is_some();
    let level_decides = !may_have_changed && !may_be_healthy(estimate, reference_kpa);
    let level = [T::one() - share, estimate.pressure_sd_kpa / reference_kpa];
    let level = level_decides.then_some(level);
    // A side of which both are lower than the other one is not.
    let lower = |above: Option<[T; 2]>| {
        let [above, sd] = above.filter(|_| around.is_low_alone() && share < limits.low_share)?;
        Some([-above, sd])
    };
    let others = around.above_others.filter(|_| !may_have_changed);
    [level, lower(others), lower(around.above_partner), around.lost]
}

/// The estimate against a limit.
pub(crate) fn reading<T: Real>(estimate: &CornerEstimate<T>, limit_share: T, reference_kpa: T) -> Reading<T> {
    let limit_kpa = limit_share * reference_kpa;
    // Where its own level does not say so, it was the others that did.
    let far = (estimate.pressure_kpa - limit_kpa).abs() > T::lit(ONE_SIDED_95) * estimate.pressure_sd_kpa;
    let far = far && !(estimate.pressure_kpa < limit_kpa && may_be_healthy(estimate, reference_kpa));
    Reading {
        pressure_kpa: estimate.pressure_kpa,
        sd_kpa: estimate.pressure_sd_kpa,
        limit_kpa,
        reference_kpa,
        basis: if far { estimate.level.into() } else { Basis::OtherTires },
    }
}
