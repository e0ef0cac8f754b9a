//! One wheel's pressure against its limits, and how long ago something was learned of it.

use crate::conditioning::pauses::ENOUGH_S;
use crate::diagnosis::debounce::{AT_ONCE, Debouncer, Evidence};
use crate::memory::Blank;
use crate::model::{CornerEstimate, Level, ONE_SIDED_95, OUTLIER_SD, Validity};
use crate::real::Real;
use crate::warning::report::{Doubt, WheelState};
use crate::warning::{Basis, Reading, Rules, Tuning};

/// Information gate above which something is being learned.
const LEARNING: f64 = 0.1;

/// Further information about a wheel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Around<T> {
    pub(crate) speed_m_s: T,
    /// Whether there is another tire on the side whose sensors say nothing, so that nothing is held against this one.
    pub(crate) other_is_silent: bool,
    /// Probability that it has too little air.
    pub(crate) low: T,
    /// And that it is on its rim.
    pub(crate) on_rim: T,
    /// Whether what front and rear of the side disagree by may be the road's or a sensor's.
    pub(crate) doubted: bool,
}

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
        }
    }

    /// Takes what was estimated over the last `step_s` seconds.
    pub(crate) fn update<T: Real>(
        &mut self,
        step_s: f64,
        estimate: &CornerEstimate<T>,
        reference_kpa: T,
        around: &Around<T>,
        &Rules { limits, decision, tuning }: &Rules<'_, T>,
    ) {
        let time_s = estimate.time_s;
        let learning = is_learning(estimate);
        if learning {
            let forgotten = self.is_forgotten(time_s);
            (self.driven_s, self.stood_s) = (0.0, 0.0);
            self.fitted_s = (self.fitted_s + step_s).min(2.0 * tuning.fitted_s);
            self.anew_s = if forgotten { self.anew_s + step_s } else { 0.0 };
            if !forgotten || self.anew_s >= ENOUGH_S {
                self.informed_s = time_s;
            }
        } else if around.speed_m_s > T::lit(tuning.should_learn_m_s) {
            self.driven_s += step_s;
        } else if around.speed_m_s < T::lit(tuning.should_learn_m_s) {
            self.stood_s += step_s;
        }
        let shown_s = if self.stood_s < tuning.standing_s { limits.no_information_s } else { 0.0 };
        self.known_until_s = self.informed_s + shown_s;
        let silent = self.driven_s >= limits.no_information_s;
        let uninformed = if silent { Evidence::Prefailed } else { Evidence::Prepassed };
        self.uninformed.update(time_s, step_s, uninformed, AT_ONCE);
        // The readings of a corner that has never fitted for long, or no longer does, were no tire's.
        if estimate.validity == Validity::Misfit {
            if around.speed_m_s > T::lit(tuning.should_learn_m_s) {
                self.fitted_s = (self.fitted_s - step_s).max(0.0);
            }
            if self.is_unfit(estimate, tuning) {
                (self.low, self.over) = (Debouncer::new(), Debouncer::new());
            }
        }
        if !learning {
            return;
        }
        let (p, sd) = (estimate.pressure_kpa, estimate.pressure_sd_kpa);
        let probable = |probability: T, doubted: bool| {
            if probability > T::lit(decision.surely_low) {
                if doubted { Evidence::NoData } else { Evidence::Prefailed }
            } else if probability < T::lit(decision.hardly_low) {
                Evidence::Prepassed
            } else {
                Evidence::Undecided
            }
        };
        let low = probable(around.low, around.doubted);
        let weight = match low {
            Evidence::Prefailed if around.other_is_silent => 1.0 / tuning.alone,
            Evidence::Prefailed if around.low > T::lit(1.0 - decision.beyond_doubt) => 2.0,
            _ => 1.0,
        };
        self.low.update(time_s, weight * step_s, low, tuning.low);
        let over = if p - T::lit(ONE_SIDED_95) * sd > limits.over_share * reference_kpa {
            Evidence::Prefailed
        } else if p < limits.over_clears_share * reference_kpa {
            Evidence::Prepassed
        } else {
            Evidence::Undecided
        };
        self.over.update(time_s, step_s, over, tuning.over);
        self.flat.update(time_s, step_s, probable(around.on_rim, false), tuning.low);
    }

    /// Whether the corner does not fit, and has not for longer than before: nothing that was seen of it was a tire.
    pub(crate) fn is_unfit<T: Real>(&self, estimate: &CornerEstimate<T>, tuning: &Tuning) -> bool {
        estimate.validity == Validity::Misfit && self.fitted_s < tuning.fitted_s
    }

    /// A sensor of the side's other wheel is wrong, and seems to have been since then: what was held against it says nothing.
    pub(crate) fn retract_beside(&mut self, fault_since_s: f64, tuning: &Tuning) {
        for verdict in [&mut self.low, &mut self.over] {
            if verdict.is_suspected() && verdict.since_s() > fault_since_s - tuning.beside_a_fault_s {
                *verdict = Debouncer::new();
            }
        }
    }

    /// Whether what was learned of the wheel is too long ago to be shown: no one has looked at a tire since the car stopped.
    pub(crate) fn is_forgotten(&self, time_s: f64) -> bool {
        !(time_s < self.known_until_s) && self.known_until_s != f64::NEG_INFINITY
    }

    /// Why nothing is known of it then.
    pub(crate) fn forgotten(&self, tuning: &Tuning) -> Doubt {
        if self.stood_s < tuning.standing_s { Doubt::NoInformation } else { Doubt::Standing }
    }

    /// The wheel's state if nothing is to be reported of it: fine, or why that is not known; `low`: the probability that it has too little air.
    pub(crate) fn quiet_state<T: Real>(
        &self,
        estimate: &CornerEstimate<T>,
        reference_kpa: T,
        low: T,
        rules: &Rules<'_, T>,
    ) -> WheelState {
        let reaches = estimate.pressure_kpa - T::lit(ONE_SIDED_95) * estimate.pressure_sd_kpa;
        match estimate.validity {
            Validity::Starting => WheelState::Unknown(Doubt::Starting),
            Validity::NoInformation => WheelState::Unknown(Doubt::NoInformation),
            Validity::BadSignal | Validity::Diverged => WheelState::Unknown(Doubt::Suspicion),
            Validity::Misfit => WheelState::Unknown(Doubt::Misfit),
            Validity::Valid if !(estimate.time_s < self.known_until_s) => {
                WheelState::Unknown(self.forgotten(rules.tuning))
            }
            Validity::Valid => {
                let is_fine = reaches > rules.limits.low_share * reference_kpa
                    && low < T::lit(rules.decision.surely_not_low);
                if is_fine { WheelState::Fine } else { WheelState::Unknown(Doubt::Uncertain) }
            }
        }
    }
}

/// Whether there is a pressure and something new is being learned of it.
pub(crate) fn is_learning<T: Real>(estimate: &CornerEstimate<T>) -> bool {
    estimate.validity.is_valid() && estimate.diagnostics.gate > T::lit(LEARNING)
}

pub(crate) fn reading<T: Real>(
    estimate: &CornerEstimate<T>,
    limit_share: T,
    reference_kpa: T,
    probability: Option<T>,
) -> Reading<T> {
    let limit_kpa = limit_share * reference_kpa;
    // Where its own level does not say so, it was the others that did.
    let far = (estimate.pressure_kpa - limit_kpa).abs() > T::lit(ONE_SIDED_95) * estimate.pressure_sd_kpa;
    let reaches_kpa = estimate.pressure_kpa + T::lit(OUTLIER_SD) * estimate.pressure_sd_kpa;
    let by_file = estimate.level == Level::VehicleFile;
    let far = far && !(by_file && estimate.pressure_kpa < limit_kpa && !(reaches_kpa < reference_kpa));
    Reading {
        pressure_kpa: estimate.pressure_kpa,
        sd_kpa: estimate.pressure_sd_kpa,
        limit_kpa,
        reference_kpa,
        basis: if far { estimate.level.into() } else { Basis::OtherTires },
        probability,
    }
}
