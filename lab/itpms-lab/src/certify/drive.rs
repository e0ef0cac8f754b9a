//! One test: reset and learning, something goes wrong, the tell-tale, key out and in, everything put right.
//!
//! Called for each procedure. The estimator and its monitor get samples and nothing else; what is known here of pressures
//! and faults is held against what they say.

use itpms_core::model::{Corner, Wheels};
use itpms_sim::fault::Faults;
use itpms_sim::simulation::{SimRow, Simulation};
use rand::{RngExt, SeedableRng as _};
use rand_pcg::Pcg64;

use super::course::{Course, RECOVERY_S};
use super::outcome::{Findings, Outcome, Phase, TracePoint};
use super::procedure::Procedure;
use super::telltale::{Lamp, Wrong, wrong};
use super::test_case::Test;
use super::watched::Watched;
use super::{Odometer, StatedLoads};
use crate::runner::Result;
use crate::sensors::Sensors;

/// After the tell-tale has come on the drive goes on so many s: it has to stay lit.
const STAYS_LIT_S: f64 = 60.0;
/// With the tell-tale lit the key is taken out for five minutes (R141 Annex 3, FMVSS S6(g)).
const PARKED_S: f64 = 300.0;
/// With the key in again the lamp has to be lit after so many s, which a bulb check may take, and stay lit this long.
const LAMP_CHECK_S: f64 = 10.0;
const KEY_IN_S: f64 = 30.0;
/// The reset after everything is put right takes so many s of driving.
const NEW_RESET_S: f64 = 300.0;
/// A lamp that is out for so many s is out; as long it is looked at what else is reported then.
const OUT_S: f64 = 60.0;
const TRACE_S: f64 = 2.0;
/// Seconds between two reports of how far it is.
const REPORT_S: f64 = 10.0;

pub(super) fn drive(
    procedure: &Procedure,
    course: &Course,
    seed: u64,
    (sensors, loads): (Sensors, StatedLoads),
    odometer: &Odometer<'_>,
) -> Result<Outcome> {
    let mut car = Watched::new(procedure, course, loads, sensors)?;
    car.begin_calibration(course.learning_s)?;
    let mut run = Run::new(procedure, course, seed, car, odometer);
    run.test()?;
    if run.findings.warned_after_s.is_some() {
        run.park();
        run.recover()?;
    }
    // Stretches not driven count as done.
    let left_s = course.longest_s() - run.simulated_s;
    odometer.advance(left_s.max(0.0) as u64)?;
    Ok(Outcome::new(procedure, course, run.findings, run.trace, run.simulated_s))
}

struct Run<'a> {
    course: &'a Course,
    odometer: &'a Odometer<'a>,
    lamp: Lamp,
    concerned: Wheels,
    low: bool,
    seed: u64,
    car: Watched,
    /// Time of the last sample in s, and simulated time in s.
    time_s: f64,
    simulated_s: f64,
    findings: Findings,
    trace: Vec<TracePoint>,
}

impl<'a> Run<'a> {
    fn new(
        procedure: &Procedure,
        course: &'a Course,
        seed: u64,
        car: Watched,
        odometer: &'a Odometer<'a>,
    ) -> Self {
        let low = !matches!(procedure.test, Test::Malfunction(_));
        Self {
            course,
            odometer,
            lamp: if low { Lamp::Low } else { Lamp::Malfunction },
            concerned: procedure.concerned(),
            low,
            seed,
            car,
            time_s: 0.0,
            simulated_s: 0.0,
            findings: Findings::default(),
            trace: Vec::new(),
        }
    }

    /// Learning, standstill, detection, until the tell-tale comes on or the time is over.
    fn test(&mut self) -> Result<()> {
        let course = self.course;
        let (mut counted_s, mut last_s) = (0.0, 0.0);
        self.car.roll(&course.scenario, self.seed)?;
        for row in Simulation::new(&course.scenario, self.seed)? {
            let step_s = row.time_s - last_s;
            last_s = row.time_s;
            let [off_s, on_s] = course.key_out_s;
            if (off_s..on_s).contains(&row.time_s) {
                continue;
            }
            self.take(&row, 0.0);
            self.keep(&row, 0.0)?;
            if row.time_s < course.wrong_from_s {
                self.look_for_false_alarms(row.time_s);
                continue;
            }
            self.keep_false_alerts(Phase::Detection);
            if row.time_s > course.wrong_at_s && course.counts(row.speed_m_s) {
                counted_s += step_s;
            }
            self.look_for_warning(row.time_s, counted_s);
            let enough_s = self.findings.warned_at_s.map_or(f64::INFINITY, |at_s| at_s + STAYS_LIT_S);
            if row.time_s >= enough_s || (counted_s >= course.limit_s && enough_s == f64::INFINITY) {
                break;
            }
        }
        Ok(())
    }

    /// When the lamp came on, for which wheels, and whether it stays so.
    fn look_for_warning(&mut self, time_s: f64, counted_s: f64) {
        let named = self.car.lit(self.lamp);
        let findings = &mut self.findings;
        if findings.warned_at_s.is_none() && !named.is_empty() {
            findings.warned_at_s = Some(time_s);
            findings.warned_after_s = Some(counted_s);
        }
        if findings.warned_at_s.is_some() {
            findings.went_out |= named.is_empty();
            findings.named = findings.named | named;
            for alert in self.car.report().alerts() {
                if wrong(self.lamp, self.concerned, alert) == Some(Wrong::Wheel) {
                    let concerned = self.concerned;
                    let others: Wheels =
                        alert.wheels.iter().filter(|corner| !concerned.contains(*corner)).collect();
                    findings.wrong = findings.wrong | others;
                }
            }
        }
    }

    /// While all is well nothing may be reported.
    fn look_for_false_alarms(&mut self, time_s: f64) {
        for alert in self.car.report().alerts() {
            self.findings.false_alarm_s.get_or_insert(time_s);
            self.findings.keep_false_alert(time_s, Phase::Learning, Wrong::Lamp, alert);
        }
    }

    /// Whether something is reported that what is wrong does not explain; before the tell-tale, beside it and after it.
    fn keep_false_alerts(&mut self, phase: Phase) {
        for alert in self.car.report().alerts() {
            if let Some(wrong) = wrong(self.lamp, self.concerned, alert) {
                self.findings.keep_false_alert(self.time_s, phase, wrong, alert);
            }
        }
    }

    /// The car is parked, the key taken out and put in again: the lamp has to be lit again, without a meter driven. The
    /// program's state is a value and outlives the key.
    fn park(&mut self) {
        let course = self.course;
        let step_s = 1.0 / course.scenario.rate_hz;
        let mut random = Pcg64::seed_from_u64(self.seed);
        // Uniform noise of 0.05 m/s² rms, which is its half width over the root of three.
        let mut noise = || random.random_range(-1.0..1.0) * 0.05 * 3f64.sqrt();
        let mut faults = Faults::new(&course.scenario.fault, self.seed);
        let samples = (KEY_IN_S * course.scenario.rate_hz) as usize;
        let key_in_s = self.time_s + PARKED_S;
        let mut relit = true;
        for i in 0..samples {
            let since_s = i as f64 * step_s;
            let time_s = key_in_s + since_s;
            let mut readings = Corner::ALL.map(|_| [noise(), noise()]);
            faults.spoil(time_s, &mut readings);
            self.time_s = time_s;
            self.car.stand(time_s, readings);
            self.keep_false_alerts(Phase::KeyIn);
            relit &= since_s < LAMP_CHECK_S || !self.car.lit(self.lamp).is_empty();
        }
        self.findings.relit = Some(relit);
    }

    /// Tires filled, plugs put in, and a reset where tires were touched: the lamp has to go out.
    fn recover(&mut self) -> Result<()> {
        let offset_s = self.time_s + PARKED_S;
        let quiet_s = if self.low { NEW_RESET_S } else { 0.0 };
        if self.low {
            self.car.begin_calibration(NEW_RESET_S)?;
        }
        let mut out_since_s = None;
        self.trace.push(TracePoint::nothing(offset_s));
        let seed = self.seed.wrapping_add(500);
        self.car.roll(&self.course.recovery, seed)?;
        for row in Simulation::new(&self.course.recovery, seed)? {
            self.take(&row, offset_s);
            self.keep(&row, offset_s)?;
            self.keep_false_alerts(Phase::Recovery);
            if !self.car.lit(self.lamp).is_empty() {
                out_since_s = None;
                continue;
            }
            let since_s = *out_since_s.get_or_insert(row.time_s);
            if row.time_s - since_s >= OUT_S && row.time_s >= quiet_s + OUT_S {
                self.findings.out_after_s = Some(since_s);
                break;
            }
        }
        Ok(())
    }

    fn take(&mut self, row: &SimRow, offset_s: f64) {
        self.time_s = offset_s + row.time_s;
        self.car.take(row, offset_s);
    }

    /// A point of the trace now and then, and a word of how far it is.
    fn keep(&mut self, row: &SimRow, offset_s: f64) -> Result<()> {
        let before_s = self.simulated_s;
        self.simulated_s += 1.0 / self.course.scenario.rate_hz;
        let passed = |every_s: f64| (before_s / every_s).floor() < (self.simulated_s / every_s).floor();
        let (report, trace) = (passed(REPORT_S), passed(TRACE_S));
        if report {
            self.odometer.advance(REPORT_S as u64)?;
        }
        if trace {
            self.trace.extend(self.car.trace(offset_s + row.time_s, row));
        }
        Ok(())
    }
}

const _: () = assert!(RECOVERY_S > NEW_RESET_S + OUT_S);
