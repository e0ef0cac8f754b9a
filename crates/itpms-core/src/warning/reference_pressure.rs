//! Reference pressure of a tire: the pressure that was given, and what a warm tire had more at the end of the last calibration,
//! for as long as it can be taken to be as warm again.
//!
//! Called by the monitor. Where the temperature of the air is known, the reference follows the tires' temperature. Else it knows only for how long
//! the car has been driven and has stood; wherever it
//! has to guess, it takes the tire to be cold, because a reference that is too low warns later and never wrongly.
//! Derivation and limits: docs/math/monitor.md, section 1; docs/math/cold-pressure.md, section 4; docs/reset.md.

use crate::cold_pressure::ColdTires;
use crate::conditioning::pauses::PAUSE_S;
use crate::memory::Blank;
use crate::model::{CarEstimate, ParameterError, positive};
use crate::real::Real;
use crate::warning::Tuning;
use crate::warning::low::is_learning;

/// Pressure of one tire at the end of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Taken<T> {
    /// Seconds that were learned from, the mean pressure in kPa and the mean warmth in them.
    seconds: f64,
    pressure_kpa: T,
    warmth: T,
    /// Seconds of these in which the temperature of the air was known, and the mean cold pressure in kPa in them.
    cold_seconds: f64,
    cold_kpa: T,
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ReferencePressure<T> {
    /// 0 for cold tires, 1 for those as warm as driving makes them.
    warmth: T,
    /// Length of a calibration that is to begin with the next sample.
    calibration_s: Option<f64>,
    /// From when on pressures are taken, and when the calibration ends.
    takes_from_s: f64,
    ends_s: f64,
    taken: [Taken<T>; 4],
    time_s: f64,
}

impl<T: Real> ReferencePressure<T> {
    /// Cold tires, never reset.
    pub(crate) fn new() -> Self {
        Self {
            warmth: T::zero(),
            calibration_s: None,
            takes_from_s: f64::NEG_INFINITY,
            ends_s: f64::NEG_INFINITY,
            taken: [Taken::nothing(); 4],
            time_s: f64::NAN,
        }
    }

    /// A calibration of so many s begins with the next sample; what an earlier one left is forgotten.
    pub(crate) fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.calibration_s = Some(positive("calibrate_s", seconds)?);
        self.taken = [Taken::nothing(); 4];
        Ok(())
    }

    /// The calibration that is to begin or under way is over; what was taken in it counts.
    pub(crate) fn end_calibration(&mut self) {
        self.calibration_s = None;
        self.ends_s = self.ends_s.min(self.time_s);
    }

    /// Whether a calibration is to begin or under way.
    pub(crate) fn is_calibrating(&self) -> bool {
        self.calibration_s.is_some() || self.time_s < self.ends_s
    }

    /// Takes what was estimated; gives what the tires should have, in kPa, from what was given of each and the least and
    /// largest share of it that a calibration may make of it, and from how warm they are. A rule that leaves a warm tire nothing counts from
    /// the placard, whatever the temperature.
    pub(crate) fn update(
        &mut self,
        estimate: &CarEstimate<T>,
        speed_m_s: T,
        configured_kpa: [T; 4],
        span: [T; 2],
        tires: &ColdTires<T>,
        tuning: &Tuning,
    ) -> [T; 4] {
        let time_s = estimate.time_s;
        let step_s = time_s - self.time_s;
        self.time_s = time_s;
        if step_s > 0.0 {
            self.update_warmth(step_s, speed_m_s, tuning);
        }
        if let Some(seconds) = self.calibration_s.take() {
            self.ends_s = time_s + seconds;
            self.takes_from_s = self.ends_s - (tuning.taken_share * seconds).min(tuning.taken_s);
        }
        if time_s < self.ends_s {
            if time_s >= self.takes_from_s && step_s > 0.0 {
                self.take(estimate, step_s.min(PAUSE_S), configured_kpa, span, tires);
            }
            return configured_kpa;
        }
        let follows = tires.is_known() && span[1] > T::one();
        core::array::from_fn(|i| {
            let taken = &self.taken[i];
            let by_temperature =
                follows.then(|| tires.expected_kpa(taken.cold_reference(configured_kpa[i], span, tuning)));
            by_temperature
                .flatten()
                .unwrap_or_else(|| taken.reference(configured_kpa[i], self.warmth, span, tuning))
        })
    }

    /// The tires warm up or cool down for a while. To first order in the step, which errs towards cold in a long one.
    fn update_warmth(&mut self, step_s: f64, speed_m_s: T, tuning: &Tuning) {
        let driven = speed_m_s > T::zero() && step_s <= PAUSE_S;
        let goal = if driven { (speed_m_s / T::lit(tuning.warm_m_s)).min(T::one()) } else { T::zero() };
        let in_s = if goal > self.warmth { tuning.warms_in_s } else { tuning.cools_in_s };
        self.warmth += T::lit((step_s / in_s).min(1.0)) * (goal - self.warmth);
    }

    fn take(
        &mut self,
        estimate: &CarEstimate<T>,
        step_s: f64,
        configured_kpa: [T; 4],
        span: [T; 2],
        tires: &ColdTires<T>,
    ) {
        for (i, taken) in self.taken.iter_mut().enumerate() {
            let Some(corner) = estimate.corners[i].as_ref().filter(|corner| is_learning(corner)) else {
                continue;
            };
            // Within the bounds each value counts as it is: an excursion moves the mean no further than they are apart.
            let pressure =
                corner.pressure_kpa.max(span[0] * configured_kpa[i]).min(span[1] * configured_kpa[i]);
            taken.seconds += step_s;
            let share = T::lit(step_s / taken.seconds);
            taken.pressure_kpa += share * (pressure - taken.pressure_kpa);
            taken.warmth += share * (self.warmth - taken.warmth);
            if let Some(cold) = tires.cold(pressure, T::zero()) {
                taken.cold_seconds += step_s;
                taken.cold_kpa += T::lit(step_s / taken.cold_seconds) * (cold.pressure_kpa - taken.cold_kpa);
            }
        }
    }
}

impl<T: Real> Taken<T> {
    fn nothing() -> Self {
        let zero = T::zero();
        Self { seconds: 0.0, pressure_kpa: zero, warmth: zero, cold_seconds: 0.0, cold_kpa: zero }
    }

    /// Cold reference of the tire: no more than was given.
    fn cold_reference(&self, configured_kpa: T, span: [T; 2], tuning: &Tuning) -> T {
        let taken_kpa = if self.cold_seconds >= tuning.taken_least_s {
            self.cold_kpa
        } else if self.seconds >= tuning.taken_least_s {
            self.pressure_kpa
        } else {
            configured_kpa
        };
        taken_kpa.max(span[0] * configured_kpa).min(configured_kpa)
    }

    /// Reference of the tire at a warmth. What it had more at the calibration is scaled down while it is colder than then
    /// and not scaled up when it is warmer; what it had less is no matter of warmth.
    fn reference(&self, configured_kpa: T, warmth: T, span: [T; 2], tuning: &Tuning) -> T {
        if !(self.seconds >= tuning.taken_least_s) {
            return configured_kpa;
        }
        let rise = self.pressure_kpa - configured_kpa;
        let share = if !(rise > T::zero()) {
            T::one()
        } else if self.warmth > T::zero() {
            (warmth / self.warmth).min(T::one())
        } else {
            T::zero()
        };
        (configured_kpa + share * rise).max(span[0] * configured_kpa).min(span[1] * configured_kpa)
    }
}
