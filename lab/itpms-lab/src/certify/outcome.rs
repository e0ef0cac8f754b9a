//! Outcome of a test, and whether it passes.

use itpms_core::model::{CarEstimate, Wheels};
use itpms_core::warning::Alert;
use itpms_sim::simulation::SimRow;
use serde::Serialize;

use super::course::Course;
use super::procedure::Procedure;
use super::rules::Rule;
use super::telltale::Wrong;
use super::test_case::Test;

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Findings {
    /// A lamp was lit while all was well.
    pub(super) false_alarm_s: Option<f64>,
    /// Cumulative driving time at which the tell-tale came on, and time since the start.
    pub(super) warned_after_s: Option<f64>,
    pub(super) warned_at_s: Option<f64>,
    /// All that were named until the key was out.
    pub(super) named: Wheels,
    /// Those named of which nothing is wrong.
    pub(super) wrong: Wheels,
    /// Everything that was reported though nothing of the kind was wrong then.
    pub(super) false_alerts: Vec<FalseAlert>,
    pub(super) went_out: bool,
    pub(super) relit: Option<bool>,
    /// Driving time after which it was out for good, everything being right again.
    pub(super) out_after_s: Option<f64>,
}

/// Something that was reported of which nothing is true.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FalseAlert {
    /// When it was first reported, in s from the start of the learning phase, the key-out included.
    pub time_s: f64,
    pub phase: Phase,
    /// Why, in one word; see [`Cause::label`](itpms_core::warning::Cause::label).
    pub cause: &'static str,
    pub wheels: String,
    pub text: String,
    #[serde(skip)]
    wrong: Wrong,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    Learning,
    /// The tell-tale is waited for, or has been on for less than a minute.
    Detection,
    /// Parked, the key in again.
    KeyIn,
    Recovery,
}

impl Findings {
    /// Keeps an alert that nothing explains; one of a cause and wheels once.
    pub(super) fn keep_false_alert(&mut self, time_s: f64, phase: Phase, wrong: Wrong, alert: &Alert<f64>) {
        let (cause, wheels) = (alert.cause.label(), alert.wheels.to_string());
        if self.false_alerts.iter().all(|known| known.cause != cause || known.wheels != wheels) {
            let text = alert.to_string();
            self.false_alerts.push(FalseAlert { time_s, phase, cause, wheels, text, wrong });
        }
    }
}

itpms_core::labelled! {
    /// Whether a test is passed, and if not, the first reason.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Verdict {
        Pass = "pass",
        /// A lamp was lit before anything was wrong.
        FalseAlarm = "FAIL: false alarm",
        /// The tell-tale did not come on in time.
        NotInTime = "FAIL: not in time",
        WentOut = "FAIL: went out",
        /// It was not lit any more after the key had been out.
        NotRelit = "FAIL: not lit again",
        /// It stayed lit with everything put right.
        NotOut = "FAIL: stays lit",
        /// Something was reported that is not the matter at all: the other lamp, or an overfull tire. The regulations do not ask; a
        /// driver would.
        OtherLamp = "FAIL: another lamp lit",
        /// The right lamp was lit, but a wheel was named with which nothing is wrong. We ask this, too.
        WrongWheel = "FAIL: wrong wheel named",
    }
}

impl Verdict {
    fn of(findings: &Findings, limit_s: f64) -> Self {
        if findings.false_alarm_s.is_some() {
            Self::FalseAlarm
        } else if !findings.warned_after_s.is_some_and(|after_s| after_s <= limit_s) {
            Self::NotInTime
        } else if findings.went_out {
            Self::WentOut
        } else if findings.relit != Some(true) {
            Self::NotRelit
        } else if findings.out_after_s.is_none() {
            Self::NotOut
        } else if findings.false_alerts.iter().any(|alert| alert.wrong == Wrong::Lamp) {
            Self::OtherLamp
        } else if !findings.false_alerts.is_empty() || !findings.wrong.is_empty() {
            Self::WrongWheel
        } else {
            Self::Pass
        }
    }
}

/// Outcome of a test. Times in s; times of day count from the start of the learning phase.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    pub name: String,
    pub rule: Rule,
    pub clause: &'static str,
    pub what: String,
    pub verdict: Verdict,
    /// Cumulative driving time at the tell-tale, and its limit.
    pub warned_after_s: Option<f64>,
    pub limit_s: f64,
    pub named: String,
    /// Those of them of which nothing was wrong. The regulations do not ask; we do.
    pub named_wrongly: String,
    /// Everything that was reported though nothing of the kind was wrong then, from the first sample to the last.
    pub false_alerts: Vec<FalseAlert>,
    /// A lamp lit while all was well.
    pub false_alarm_s: Option<f64>,
    /// Lit again after five minutes without the key; `None`: it never was lit.
    pub relit: Option<bool>,
    /// Driving time after which it was out, everything being put right; `None`: it stayed lit, or never was.
    pub out_after_s: Option<f64>,
    /// Pressure at the end of the learning phase in kPa, and the one tires were let down to.
    pub warm_kpa: f64,
    pub test_kpa: Option<f64>,
    pub wrong_at_s: f64,
    pub warned_at_s: Option<f64>,
    /// The wheels that were let down; empty for a malfunction.
    pub low_wheels: String,
    pub driven_s: f64,
    /// Pressures over time; in the CSV files and figures.
    #[serde(skip)]
    pub trace: Vec<TracePoint>,
}

impl Outcome {
    pub(super) fn new(
        procedure: &Procedure,
        course: &Course,
        findings: Findings,
        trace: Vec<TracePoint>,
        driven_s: f64,
    ) -> Self {
        Self {
            name: procedure.name(),
            rule: procedure.rule,
            clause: procedure.rule.clause(procedure.test),
            what: procedure.text(),
            verdict: Verdict::of(&findings, course.limit_s),
            warned_after_s: findings.warned_after_s,
            limit_s: course.limit_s,
            named: findings.named.to_string(),
            named_wrongly: findings.wrong.to_string(),
            false_alerts: findings.false_alerts,
            false_alarm_s: findings.false_alarm_s,
            relit: findings.relit,
            out_after_s: findings.out_after_s,
            warm_kpa: course.warm_kpa,
            test_kpa: course.test_kpa,
            wrong_at_s: course.wrong_at_s,
            warned_at_s: findings.warned_at_s,
            low_wheels: match procedure.test {
                Test::Malfunction(_) => String::new(),
                _ => procedure.low_wheels().to_string(),
            },
            driven_s: driven_s.round(),
            trace,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    pub time_s: f64,
    pub speed_km_h: f64,
    /// True pressures in kPa, in the order of `Corner::ALL`.
    pub truth_kpa: [f64; 4],
    /// Estimated ones; NaN where not valid.
    pub estimate_kpa: [f64; 4],
    pub sd_kpa: [f64; 4],
}

impl TracePoint {
    pub(super) fn nothing(time_s: f64) -> Self {
        let unknown = [f64::NAN; 4];
        Self { time_s, speed_km_h: 0.0, truth_kpa: unknown, estimate_kpa: unknown, sd_kpa: unknown }
    }

    pub(super) fn new(time_s: f64, row: &SimRow, estimate: &CarEstimate<f64>) -> Self {
        let valid = estimate.corners.map(|corner| corner.filter(|corner| corner.validity.is_valid()));
        Self {
            time_s,
            speed_km_h: 3.6 * row.speed_m_s,
            truth_kpa: row.corners.map(|corner| corner.map_or(f64::NAN, |corner| corner.pressure_kpa)),
            estimate_kpa: valid.map(|corner| corner.map_or(f64::NAN, |corner| corner.pressure_kpa)),
            sd_kpa: valid.map(|corner| corner.map_or(f64::NAN, |corner| corner.pressure_sd_kpa)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::Corner;

    fn good() -> Findings {
        Findings {
            warned_after_s: Some(600.0),
            relit: Some(true),
            out_after_s: Some(30.0),
            ..Findings::default()
        }
    }

    #[test]
    fn a_test_passes_only_if_everything_is_as_it_should_be() {
        assert_eq!(Verdict::of(&good(), 600.0), Verdict::Pass);
        assert_eq!(Verdict::of(&good(), 599.0), Verdict::NotInTime);
        assert_eq!(Verdict::of(&Findings::default(), 600.0), Verdict::NotInTime);
        assert_eq!(Verdict::of(&Findings { went_out: true, ..good() }, 600.0), Verdict::WentOut);
        assert_eq!(Verdict::of(&Findings { relit: Some(false), ..good() }, 600.0), Verdict::NotRelit);
        assert_eq!(Verdict::of(&Findings { out_after_s: None, ..good() }, 600.0), Verdict::NotOut);
        assert_eq!(Verdict::of(&Findings { false_alarm_s: Some(7.0), ..good() }, 600.0), Verdict::FalseAlarm);
        let never = Findings { warned_after_s: Some(f64::NAN), ..good() };
        assert_eq!(Verdict::of(&never, 600.0), Verdict::NotInTime);
    }

    #[test]
    fn another_lamp_or_wheel_fails_a_test_and_is_kept_once() {
        let [fl, fr, ..] = Corner::ALL;
        let mut findings = good();
        findings.keep_false_alert(1500.0, Phase::Detection, Wrong::Wheel, &crate::low(fr));
        findings.keep_false_alert(1600.0, Phase::Recovery, Wrong::Wheel, &crate::low(fr));
        assert_eq!(Verdict::of(&findings, 600.0), Verdict::WrongWheel);
        // While parked the other lamp, too; that is the graver one.
        findings.keep_false_alert(1900.0, Phase::KeyIn, Wrong::Lamp, &crate::low(fl));
        assert_eq!(Verdict::of(&findings, 600.0), Verdict::OtherLamp);
        let kept: Vec<(f64, &str)> =
            findings.false_alerts.iter().map(|e| (e.time_s, e.wheels.as_str())).collect();
        assert_eq!(kept, [(1500.0, "fr"), (1900.0, "fl")]);
        assert!(findings.false_alerts[0].text.starts_with("fr under-inflated: 190 kPa"));
        // The regulation's requirement comes first.
        let out = Findings { went_out: true, ..findings };
        assert_eq!(Verdict::of(&out, 600.0), Verdict::WentOut);
        let named = Findings { wrong: fr.into(), ..good() };
        assert_eq!(Verdict::of(&named, 600.0), Verdict::WrongWheel);
    }
}
