//! The monitor that a car would ship: watches sensors and pressures, and reports what is wrong, since when and why.
//!
//! [`MonitoredCar`] is the whole: an estimator between the two halves of a [`Monitor`]. Called by the binary, the
//! studies and controllers. Of the estimate the monitor knows pressures, their sds and
//! correlations, and whether front and rear share a road; never the truth. Thresholds, times and
//! their reasons are in docs/math/monitor.md.
//!
//! | module | idea |
//! |---|---|
//! | `config` | how a monitored car is configured |
//! | `monitored` | a whole car: estimator, monitor and wheel speeds as one |
//! | `wheels` | wheel speeds alone, for a controller with kilobytes |
//!
//! Faults of sensors are found in [`crate::diagnosis`], warnings decided in [`crate::warning`].

mod config;
mod monitored;
mod wheels;

pub use self::config::{MonitorConfig, Tuning};
pub use self::monitored::MonitoredCar;
pub use self::wheels::MonitoredWheels;
use crate::cold_pressure::ColdTires;
use crate::conditioning::Moment;
use crate::conditioning::clock::stamp_s;
use crate::conditioning::pauses::{DECIDE_S, MISSING_S};
use crate::decision::Probabilities;
use crate::diagnosis::debounce::Debouncer;
use crate::diagnosis::decorrelation::DecorrelationDetector;
use crate::diagnosis::standstill::Standstill;
use crate::diagnosis::{Diagnosis, Fault};
use crate::memory::{Blank, Placed};
use crate::model::{
    Air, CarEstimate, CarSample, Corner, CornerEstimate, CornerSample, ParameterError, Side, Validity,
    Warning, Wheels, positive,
};
use crate::real::Real;
use crate::warning::all_low::AllLow;
use crate::warning::all_tires::{leaking_tires, low_tires};
use crate::warning::leak::LeakWatch;
use crate::warning::low::{Around, WheelWatch, is_learning, reading};
use crate::warning::reference_pressure::ReferencePressure;
use crate::warning::report::{ALL_LOW_SLOT, COMMON_SHIFT_SLOT, Slot};
use crate::warning::{Alert, Cause, Doubt, MonitorReport, WheelReport, WheelState};

/// Seconds for which a corner must not have been found wrong after the fact before it requests a rollback
/// again.
const ROLLBACK_HOLDOFF_S: f64 = 60.0;

/// A running monitor, for an estimator that is none of this crate's. A value: clone it, save it, go on. Per sample: [`screen`](Self::screen)
/// what the sensors say, give the estimator what `screen` returns, and let [`judge`](Self::judge) look at what comes out; [`MonitoredCar`]
/// does so, and asks whether the estimator is to take anything back.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Monitor<T: Real> {
    config: MonitorConfig<T>,
    configured_kpa: [T; 4],
    reference: ReferencePressure<T>,
    cold: ColdTires<T>,
    /// Present reference of each tire.
    reference_kpa: [T; 4],
    diagnosis: Diagnosis<T>,
    faults: [Placed<Fault<T>>; 4],
    suspects: Wheels,
    /// Whether the sensors were judged with this sample.
    has_judged_sensors: bool,
    /// When each corner was last found to have been wrong for seconds, and those of which it was found just now.
    late_detection_s: [f64; 4],
    rollback_requested: Wheels,
    /// Corners that have had a fault since their estimator last started.
    faulted: Wheels,
    wheels: [WheelWatch; 4],
    decorrelation: [DecorrelationDetector<T>; 2],
    leaks: LeakWatch<T>,
    all_low: AllLow<T>,
    low: Probabilities<T>,
    standstill: Standstill<T>,
    /// The speed to go by.
    speed_m_s: T,
    decided_s: f64,
    /// Offset of the steady time from the stamps when it decided.
    ahead_s: f64,
    report: MonitorReport<T>,
}

impl<T: Real> Monitor<T> {
    /// A monitor for samples that come at about `sample_rate_hz`.
    ///
    /// # Errors
    /// The rate must be positive and finite, limits and references numbers in order.
    pub fn new(config: &MonitorConfig<T>, sample_rate_hz: f64) -> Result<Self, ParameterError> {
        let mut monitor = Self::BLANK;
        monitor.configure(config, sample_rate_hz)?;
        Ok(monitor)
    }

    /// The same where it lies.
    pub(crate) fn configure(
        &mut self,
        config: &MonitorConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<(), ParameterError> {
        let sample_rate_hz = positive("sample_rate_hz", sample_rate_hz)?;
        config.check()?;
        let placard =
            |i: Corner| config.car.corners[i].as_ref().map_or(T::one(), |corner| corner.placard_kpa);
        self.config = *config;
        self.configured_kpa = Corner::ALL.map(|i| config.reference_kpa[i].unwrap_or(placard(i)));
        self.reference = ReferencePressure::new();
        self.cold = ColdTires::new(config.home_kpa);
        self.reference_kpa = self.configured_kpa;
        self.diagnosis.configure(&config.car, sample_rate_hz, &config.tuning.diagnosis);
        self.faults.iter_mut().for_each(Placed::clear);
        (self.suspects, self.has_judged_sensors) = (Wheels::NONE, false);
        self.late_detection_s = [f64::NEG_INFINITY; 4];
        self.rollback_requested = Wheels::NONE;
        self.faulted = Wheels::NONE;
        self.wheels = [WheelWatch::new(); 4];
        self.decorrelation = [DecorrelationDetector::new(); 2];
        self.leaks = LeakWatch::new();
        self.all_low = AllLow::new();
        self.low = Probabilities::of_nothing(&config.tuning.decision);
        self.standstill = Standstill::new();
        self.speed_m_s = T::lit(f64::NAN);
        (self.decided_s, self.ahead_s) = (f64::NEG_INFINITY, 0.0);
        self.report = MonitorReport::empty();
        Ok(())
    }

    /// As before it was configured, of which a report and a denied standstill are to be seen.
    pub(crate) fn clear(&mut self) {
        self.standstill = Standstill::new();
        self.report = MonitorReport::empty();
    }

    /// Says that a calibration begins with the next sample and takes `seconds`: what is estimated at its end is from then on what
    /// the tires should have, within [`Limits::reference_span`](crate::warning::Limits::reference_span).
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.reference.begin_calibration(seconds)?;
        // Other tires, or the same ones filled: that they read less than before is no leak.
        Corner::ALL.into_iter().for_each(|wheel| self.leaks.forget(wheel));
        Ok(())
    }

    /// Ends the calibration that is under way.
    pub fn end_calibration(&mut self) {
        self.reference.end_calibration();
    }

    /// Takes the air around the car, as often as it is measured; the last value holds for half an hour. Where the temperature
    /// is known, cold pressures are given and the reference follows the tires' temperature.
    pub fn follow_air(&mut self, air: &Air<T>) {
        self.cold.take(air);
    }

    /// Takes what the wheel speeds of the same car show now into the report, beside its own alerts.
    pub fn follow_wheels(&mut self, wheels: &MonitoredWheels<T>) {
        self.report.put_of_wheel_speeds(wheels.alert());
    }

    /// Whether the speed says that the car stands while its wheels roll. It is taken as unknown for as long.
    pub fn denies_standstill(&self) -> bool {
        self.standstill.is_denied()
    }

    /// Takes a sample and the moment it was taken at; gives both back without what is not to be learned from, and without the wheel speeds.
    pub fn screen(&mut self, at: &Moment<T>, sample: &CarSample<T>) -> (Moment<T>, CarSample<T>) {
        let tuning = &self.config.tuning.diagnosis;
        if let Some(time_s) = at.time_s {
            self.speed_m_s = self.standstill.take(time_s, at.speed_m_s, sample, tuning);
            self.diagnosis.push(time_s, self.speed_m_s, &sample.corners, tuning);
        }
        self.has_judged_sensors = self.diagnosis.take_news();
        if self.has_judged_sensors {
            for (fault, found) in self.faults.iter_mut().zip(self.diagnosis.faults()) {
                fault.set(found);
            }
            let faulty = self.faults.iter().flatten().map(|fault| fault.malfunction.wheels());
            let faulty = faulty.fold(Wheels::NONE, |all, wheels| all | wheels);
            self.suspects = self.diagnosis.suspects(tuning) | faulty;
            self.request_rollback(at.now_s);
            self.retract_beside_faults();
            self.faulted = self.faulted | faulty;
        }
        let (mut at, mut screened) = (*at, CarSample { wheel_speeds: None, ..*sample });
        if self.standstill.is_denied() {
            (at.speed_m_s, screened.speed_m_s) = (T::lit(f64::NAN), T::lit(f64::NAN));
        }
        let lost = T::lit(f64::NAN);
        let lost = CornerSample { body_accel_m_s2: lost, wheel_accel_m_s2: lost };
        for corner in self.all().iter() {
            // A corner that a sample leaves out is still one to be watched.
            let values = screened.corners[corner].get_or_insert(lost);
            if self.suspects.contains(corner) {
                *values = lost;
            }
        }
        (at, screened)
    }

    /// Takes back what was reported of a wheel because the other one of its side was believed, whose sensor turns out to be wrong.
    fn retract_beside_faults(&mut self) {
        for fault in self.faults.iter().flatten() {
            let wheels = fault.malfunction.wheels();
            for wheel in wheels.iter().filter(|wheel| !self.faulted.contains(*wheel)).map(Corner::same_side) {
                if !wheels.contains(wheel) {
                    self.wheels[wheel].retract_beside(fault.since_s, &self.config.tuning.warning);
                    self.leaks.forget(wheel);
                }
            }
        }
    }

    /// Notes the corners whose sensors were wrong for seconds before it showed. One that comes and goes is noted once.
    fn request_rollback(&mut self, time_s: f64) {
        let late_detection = self.diagnosis.late_detection();
        let fresh = |corner: &Corner| !(time_s - self.late_detection_s[*corner] < ROLLBACK_HOLDOFF_S);
        self.rollback_requested = self.rollback_requested | late_detection.iter().filter(fresh).collect();
        late_detection.iter().for_each(|corner| self.late_detection_s[corner] = time_s);
    }

    /// The corners whose sensors have just turned out to have been wrong for some seconds; once. What was learned in them is to
    /// be taken back ([`CarEstimator::rollback`](crate::car::CarEstimator::rollback)).
    pub(crate) fn take_rollback_request(&mut self) -> Wheels {
        core::mem::replace(&mut self.rollback_requested, Wheels::NONE)
    }

    /// Whether it weighs the pressures with this sample.
    fn decides_at(&self, at: &Moment<T>) -> bool {
        at.time_s.is_some() && at.now_s - self.decided_s >= DECIDE_S - 1e-9
    }

    /// Whether this sample is much work for the monitor, one way or the other.
    pub(crate) fn is_busy_at(&self, at: &Moment<T>) -> bool {
        self.has_judged_sensors || self.decides_at(at)
    }

    /// Takes what was estimated after the sample; gives the wheels whose estimator should start again, because their
    /// sensors have come back. The estimate leaves with the monitor's validity and warnings.
    #[inline(never)]
    pub fn judge(&mut self, at: &Moment<T>, estimate: &mut CarEstimate<T>) -> Wheels {
        let back: Wheels = self.faulted.iter().filter(|corner| !self.suspects.contains(*corner)).collect();
        back.iter().for_each(|corner| self.leaks.forget(corner));
        self.faulted = self.faulted.iter().filter(|corner| !back.contains(*corner)).collect();
        for corner in Corner::ALL {
            if let Some(estimate) = &mut estimate.corners[corner] {
                if self.suspects.contains(corner) {
                    estimate.validity = Validity::BadSignal;
                } else if back.contains(corner) {
                    estimate.validity = Validity::Starting;
                }
            }
        }
        let time_s = at.now_s;
        let step_s = time_s - self.decided_s;
        if self.decides_at(at) {
            self.decided_s = time_s;
            self.cold.advance(step_s, self.speed_m_s);
            self.ahead_s = at.ahead_s;
            self.decide(steadied(estimate, time_s), step_s.min(MISSING_S));
        }
        self.doubt(estimate);
        // Without a valid time the age of an estimate is unknown.
        let (latest_s, tuning) = (at.latest_s, &self.config.tuning);
        for i in Corner::ALL {
            let of_both = (&mut estimate.corners[i], &mut self.report.wheels[i]);
            let (Some(estimate), Some(wheel)) = of_both else { continue };
            estimate.warning = wheel.warning;
            estimate.cold = self.cold.cold(estimate.pressure_kpa, estimate.pressure_sd_kpa);
            let watch = &self.wheels[i];
            // A rim has no pressure, and no tire has so much.
            let most_kpa = T::lit(1.0 + tuning.decision.nobody_inflates) * self.reference_kpa[i];
            let rim = watch.flat.is_active() || estimate.pressure_kpa > most_kpa;
            let (validity, doubt) = if watch.is_forgotten(latest_s) {
                (Validity::NoInformation, watch.forgotten(&tuning.warning))
            } else if rim {
                (Validity::Misfit, Doubt::Misfit)
            } else {
                // Since the last decision it may have become so.
                if wheel.state == WheelState::Fine && !estimate.validity.is_valid() {
                    wheel.validity = estimate.validity;
                    let low = self.low.low(i);
                    wheel.state =
                        watch.quiet_state(estimate, self.reference_kpa[i], low, &self.config.rules());
                }
                continue;
            };
            if estimate.validity.is_valid() {
                estimate.validity = validity;
            }
            if wheel.validity.is_valid() {
                wheel.validity = validity;
            }
            // Nothing is fine whose pressure may not be shown.
            if matches!(wheel.state, WheelState::Fine | WheelState::Unknown(Doubt::Uncertain)) {
                wheel.state = WheelState::Unknown(doubt);
            }
        }
        back
    }

    /// Weighs the pressures of the last `step_s` seconds and writes the report. Its frame is not to lie under the estimator's.
    #[inline(never)]
    fn decide(&mut self, mut estimate: CarEstimate<T>, step_s: f64) {
        let rules = self.config.rules();
        self.reference_kpa = self.reference.update(
            &estimate,
            self.speed_m_s,
            self.configured_kpa,
            rules.limits.reference_span,
            &self.cold,
            rules.tuning,
        );
        let diagnosis = &self.config.tuning.diagnosis;
        let pending_fault = self.diagnosis.pending_fault();
        let doubted = Side::ALL.map(|side| {
            let parting =
                self.decorrelation[side].update(step_s, estimate.tracks[side].incoherence, diagnosis);
            parting || pending_fault.iter().any(|corner| corner.side() == side)
        });
        // In a calibration no tire is held against the pressure that is stated.
        self.low = match self.reference.is_calibrating() {
            true => Probabilities::of_nothing(rules.decision),
            false => low_tires(&estimate, self.reference_kpa, &rules),
        };
        let around = Corner::ALL.map(|corner| self.around(&estimate, corner, doubted[corner.side()]));
        for i in Corner::ALL {
            if let Some(corner) = &estimate.corners[i] {
                self.wheels[i].update(step_s, corner, self.reference_kpa[i], &around[i], &rules);
                if self.wheels[i].is_unfit(corner, rules.tuning) {
                    self.leaks.retract(i);
                }
            }
        }
        let lost_kpa = Corner::ALL.map(|i| {
            let learned = estimate.corners[i].as_ref().filter(|corner| is_learning(corner));
            learned.and_then(|corner| corner.loss).map(|loss| loss.lost_kpa)
        });
        let leaking = leaking_tires(&estimate, self.reference_kpa, &rules);
        let doubted = around.map(|around| around.doubted);
        self.leaks.update(estimate.time_s, step_s, &lost_kpa, &leaking, doubted, &rules);
        self.all_low.update(step_s, &estimate, self.reference_kpa, &self.low, &rules);
        self.doubt(&mut estimate);
        self.write(&estimate);
    }

    /// Adds to what the levels are known to what another car or nothing known would make of them (docs/math/decision.md, eq. 5).
    fn doubt(&self, estimate: &mut CarEstimate<T>) {
        let doubt = Corner::ALL.map(|i| self.low.doubt(i) * self.reference_kpa[i]);
        let sd =
            Corner::ALL.map(|i| estimate.corners[i].as_ref().map_or(T::one(), |tire| tire.pressure_sd_kpa));
        // Less than a tenth of it adds less than half a percent.
        if doubt.iter().zip(&sd).all(|(doubt, sd)| !(doubt.abs() > T::lit(0.1) * *sd)) {
            return;
        }
        let both = Corner::ALL.map(|i| sd[i].hypot(doubt[i]));
        for (i, row) in Corner::ALL.into_iter().zip(&mut estimate.correlation) {
            for (j, correlation) in Corner::ALL.into_iter().zip(row).filter(|(j, _)| *j != i) {
                *correlation = (*correlation * sd[i] * sd[j] + doubt[i] * doubt[j]) / (both[i] * both[j]);
            }
            if let Some(tire) = &mut estimate.corners[i] {
                tire.pressure_sd_kpa = both[i];
            }
        }
    }

    /// Further information about a wheel.
    fn around(&self, estimate: &CarEstimate<T>, corner: Corner, doubted: bool) -> Around<T> {
        let other = estimate.corners[corner.same_side()].as_ref();
        let is_silent = |corner: &CornerEstimate<T>| {
            matches!(corner.validity, Validity::BadSignal | Validity::Diverged | Validity::Starting)
        };
        Around {
            speed_m_s: self.speed_m_s,
            other_is_silent: other.is_some_and(is_silent),
            low: self.low.low(corner),
            on_rim: self.low.on_rim(corner),
            doubted,
        }
    }

    fn write(&mut self, estimate: &CarEstimate<T>) {
        self.report.begin(estimate.time_s, self.ahead_s);
        let all_low = self.all_low.cause().map(|cause| alert(self.all_low.debouncer(), self.all(), cause));
        self.report.put(ALL_LOW_SLOT, all_low);
        let shift = self.all_low.shift_cause();
        let shift = shift.map(|(wheels, cause)| alert(self.all_low.shift(), wheels, cause));
        self.report.put(COMMON_SHIFT_SLOT, shift);
        for (corner, estimate) in Corner::ALL.into_iter().zip(&estimate.corners) {
            if let Some(estimate) = estimate {
                self.write_alerts(corner, estimate);
            }
        }
        self.report.wheels =
            Corner::ALL.map(|corner| Some(self.wheel_report(corner, estimate.corners[corner].as_ref()?)));
    }

    fn all(&self) -> Wheels {
        let corners = Corner::ALL.into_iter();
        corners.filter(|corner| self.config.car.corners[*corner].is_some()).collect()
    }

    fn write_alerts(&mut self, corner: Corner, estimate: &CornerEstimate<T>) {
        let limits = &self.config.limits;
        let (watch, reference) = (&self.wheels[corner], self.reference_kpa[corner]);
        let (leak, rate_kpa_per_min, lost) = self.leaks.of(corner);
        let low = Some(self.low.low(corner));
        let against = |share: T, probability: Option<T>| reading(estimate, share, reference, probability);
        let named = |debouncer: &Debouncer, cause: Cause<T>| {
            debouncer.is_active().then(|| alert(debouncer, corner.into(), cause))
        };
        let low = named(&watch.low, Cause::UnderInflated(against(limits.low_share, low)));
        let over = named(&watch.over, Cause::OverInflated(against(limits.over_share, None)));
        let over = over.filter(|_| !watch.flat.is_active());
        let flat = named(&watch.flat, Cause::Flat(against(limits.over_share, None)));
        let leaking = Cause::FastLeak { reading: against(limits.low_share, lost), rate_kpa_per_min };
        let leaking = named(leak, leaking);
        let silent = Cause::NoInformation { driven_s: watch.driven_s };
        let silent = named(&watch.uninformed, silent);
        let broken = self.faults[corner].get().map(|fault| Alert {
            wheels: fault.malfunction.wheels(),
            since_s: fault.since_s,
            reported_s: fault.reported_s,
            cause: Cause::Malfunction(fault.malfunction),
        });
        let alerts = [
            (Slot::Low, low),
            (Slot::Leak, leaking),
            (Slot::Over, over),
            (Slot::Flat, flat),
            (Slot::Malfunction, broken),
            (Slot::NoInformation, silent),
        ];
        for (slot, alert) in alerts {
            self.report.put(slot.of(corner), alert);
        }
    }

    fn wheel_report(&self, corner: Corner, estimate: &CornerEstimate<T>) -> WheelReport<T> {
        let (reference, watch) = (self.reference_kpa[corner], &self.wheels[corner]);
        let low = self.low.low(corner);
        let mut state = watch.quiet_state(estimate, reference, low, &self.config.rules());
        // The gravest is looked at last.
        for alert in self.report.alerts_of(corner) {
            state = match (&alert.cause, state) {
                (Cause::Malfunction(_) | Cause::NoInformation { .. }, _) => WheelState::Malfunction,
                (_, WheelState::Malfunction) => state,
                (Cause::OverInflated(_), _) => WheelState::Over,
                (Cause::CommonShift { .. }, WheelState::Low | WheelState::Over) => state,
                (Cause::CommonShift { .. }, _) => WheelState::Unknown(Doubt::Uncertain),
                _ => WheelState::Low,
            };
        }
        let warning = match state {
            WheelState::Malfunction => Warning::Malfunction,
            WheelState::Low => Warning::Low,
            WheelState::Unknown(_) | WheelState::Fine | WheelState::Over => Warning::None,
        };
        WheelReport {
            state,
            validity: estimate.validity,
            warning,
            pressure_kpa: estimate.pressure_kpa,
            pressure_sd_kpa: estimate.pressure_sd_kpa,
            reference_kpa: reference,
            informed_s: stamp_s(watch.informed_s, self.ahead_s),
        }
    }

    /// The report, for another monitor to write: of a car that has no corners.
    pub(crate) fn report_mut(&mut self) -> &mut MonitorReport<T> {
        &mut self.report
    }

    /// The present report.
    pub fn report(&self) -> &MonitorReport<T> {
        &self.report
    }
}

/// The same with the steady time in place of the samples' stamps.
fn steadied<T: Real>(estimate: &CarEstimate<T>, time_s: f64) -> CarEstimate<T> {
    let corners = estimate.corners.map(|corner| corner.map(|corner| CornerEstimate { time_s, ..corner }));
    CarEstimate { time_s, corners, ..*estimate }
}

fn alert<T>(debouncer: &Debouncer, wheels: Wheels, cause: Cause<T>) -> Alert<T> {
    Alert { wheels, since_s: debouncer.since_s(), reported_s: debouncer.reported_s(), cause }
}
