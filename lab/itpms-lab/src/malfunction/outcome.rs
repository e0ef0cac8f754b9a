//! One malfunction put into one drive: when it was reported, what was shown meanwhile, and how the monitor came back.

use itpms_core::model::{CarSample, Corner, CornerEstimate, CornerSample, Wheels};
use itpms_core::monitor::MonitoredCar;
use itpms_core::warning::{Alert, Cause, Change};
use itpms_sim::fault::{FaultSpec, Faults};
use serde::Serialize;

use super::drive::Recorded;
use super::kinds::{Kind, malfunction_label};

/// Seconds for which a malfunction goes on after it was reported, and the longest it lasts.
const AFTER_REPORT_S: f64 = 20.0;
const LONGEST_S: f64 = 150.0;
/// Seconds that are driven after its end, whenever all is well again: a tire may be warned of for nothing later.
const RECOVERY_S: f64 = 120.0;
/// Speed in m/s above which time counts as driven.
const DRIVING_M_S: f64 = 3.0;
/// Error over its sd beyond which a pressure that is shown is wrong; and in kPa, whatever the sd.
const WRONG_SDS: f64 = 3.0;
const FAR_KPA: f64 = 20.0;

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Outcome {
    /// Seconds of driving until it was reported; `None`: never.
    pub(super) reported_after_s: Option<f64>,
    /// Its label then, and whether nothing but the very malfunction was reported.
    pub(super) label: &'static str,
    pub(super) exactly: bool,
    pub(super) driven_s: f64,
    /// Pressures shown before it was reported, after that, and after its end.
    pub(super) before: Shown,
    pub(super) after: Shown,
    pub(super) back: Shown,
    pub(super) others_said: usize,
    /// False reports of tires: while it lasted, and after.
    pub(super) tires_during: TireWarnings,
    pub(super) tires_after: TireWarnings,
    /// Seconds of driving after its end until nothing was reported any more, a right pressure was shown at its wheels and no
    /// wrong one at any.
    pub(super) recovered_after_s: Option<f64>,
    pub(super) driven_after_s: f64,
}

/// Seconds in which a wrong pressure was shown, and one far off: at the wheels a malfunction happens to, and at the others,
/// which learn from a road and a body they share with them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Shown {
    pub(super) wrong_s: [f64; 2],
    pub(super) far_s: [f64; 2],
}

impl Shown {
    fn add(&mut self, [wrong, far]: [[bool; 2]; 2], step_s: f64) {
        for i in 0..2 {
            self.wrong_s[i] += if wrong[i] { step_s } else { 0.0 };
            self.far_s[i] += if far[i] { step_s } else { 0.0 };
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct TireWarnings {
    pub low: usize,
    pub fast_leak: usize,
    pub all_low: usize,
    pub over: usize,
}

impl TireWarnings {
    fn count(&mut self, cause: &Cause<f64>) {
        match cause {
            Cause::UnderInflated(_) | Cause::Flat(_) | Cause::Differs { .. } | Cause::SlowLeak(_) => {
                self.low += 1
            }
            Cause::FastLeak { .. } => self.fast_leak += 1,
            Cause::AllLow { .. } | Cause::CommonShift { .. } => self.all_low += 1,
            Cause::OverInflated(_) => self.over += 1,
            Cause::Malfunction(_) | Cause::NoInformation { .. } => {}
        }
    }

    pub fn total(&self) -> usize {
        self.low + self.fast_leak + self.all_low + self.over
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            fast_leak: self.fast_leak + other.fast_leak,
            all_low: self.all_low + other.all_low,
            over: self.over + other.over,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Hidden,
    Said,
    Over,
}

/// Drives on with the malfunction from where it begins.
pub(super) fn run(kind: &Kind, drive: &Recorded, mut car: Box<MonitoredCar<f64>>, seed: u64) -> Outcome {
    let period_s = 1.0 / drive.rate_hz;
    let concerned = kind.wheels();
    let mut faults = Faults::new(&from_the_start(kind), seed);
    let mut outcome = Outcome::default();
    let mut phase = Phase::Hidden;
    let (mut lasted_s, mut since_s) = (0.0, 0.0);
    let mut before = *car.report();
    for (i, row) in drive.rows.iter().enumerate().skip(drive.begins) {
        let step_driven_s = if row.speed_m_s > DRIVING_M_S { period_s } else { 0.0 };
        if phase != Phase::Over && drive.ends.is_some_and(|end| i >= end) {
            (phase, since_s) = (Phase::Over, 0.0);
        }
        let sample = if phase == Phase::Over { *row } else { with_faults(row, &mut faults) };
        let estimate = car.update(&sample);
        let report = car.report();
        if report.time_s != before.time_s {
            for change in report.changes_since(&before) {
                if let Change::Begun(alert) = change {
                    outcome.note(kind, phase, &alert);
                }
            }
            before = *report;
        }
        let shown = shown_wrong(&estimate.corners, concerned, &drive.pressure_kpa);
        lasted_s += period_s;
        since_s += period_s;
        match phase {
            Phase::Hidden => {
                outcome.driven_s += step_driven_s;
                outcome.before.add(shown, period_s);
                let alerts: Vec<Alert<f64>> = report.alerts().copied().collect();
                if outcome.take_report(kind, &alerts) {
                    (phase, since_s) = (Phase::Said, 0.0);
                } else if drive.ends.is_none() && lasted_s > LONGEST_S {
                    (phase, since_s) = (Phase::Over, 0.0);
                }
            }
            Phase::Said => {
                outcome.driven_s += step_driven_s;
                // Twenty seconds, however long the road makes it last.
                if since_s <= AFTER_REPORT_S {
                    outcome.after.add(shown, period_s);
                } else if drive.ends.is_none() {
                    (phase, since_s) = (Phase::Over, 0.0);
                }
            }
            Phase::Over => {
                outcome.driven_after_s += step_driven_s;
                outcome.back.add(shown, period_s);
                let all_shown = concerned.iter().all(|corner| {
                    estimate.corners[corner.index()].is_some_and(|corner| corner.validity.is_valid())
                });
                let [wrong, _] = shown;
                let well = all_shown && wrong == [false; 2] && report.alerts().next().is_none();
                if well && outcome.recovered_after_s.is_none() {
                    outcome.recovered_after_s = Some(outcome.driven_after_s);
                }
                if since_s > RECOVERY_S {
                    break;
                }
            }
        }
    }
    outcome
}

impl Outcome {
    /// Something began to be reported: the malfunction, another one, or a warning of a tire, which is a false one.
    fn note(&mut self, kind: &Kind, phase: Phase, alert: &Alert<f64>) {
        if malfunction_label(&alert.cause).is_some() && !kind.is_exactly(&alert.cause) {
            self.others_said += 1;
        }
        let tires = if phase == Phase::Over { &mut self.tires_after } else { &mut self.tires_during };
        tires.count(&alert.cause);
    }

    /// Whether a malfunction is reported at a wheel that it happens to; then when, and by which name.
    fn take_report(&mut self, kind: &Kind, alerts: &[Alert<f64>]) -> bool {
        let Some(label) = alerts.iter().find_map(|alert| kind.label_of(&alert.cause, alert.wheels)) else {
            return false;
        };
        let mut malfunctions = alerts.iter().filter(|alert| malfunction_label(&alert.cause).is_some());
        self.exactly = malfunctions.all(|alert| kind.is_exactly(&alert.cause));
        (self.reported_after_s, self.label) = (Some(self.driven_s), label);
        true
    }
}

fn from_the_start(kind: &Kind) -> Vec<FaultSpec> {
    kind.faults.iter().map(|fault| FaultSpec { from_s: -1e6, ..*fault }).collect()
}

fn with_faults(row: &CarSample<f64>, faults: &mut Faults) -> CarSample<f64> {
    let nothing = [f64::NAN; 2];
    let mut readings = row.corners.map(|c| c.map_or(nothing, |c| [c.body_accel_m_s2, c.wheel_accel_m_s2]));
    faults.spoil(row.time_s, &mut readings);
    let corner =
        |[body_accel_m_s2, wheel_accel_m_s2]: [f64; 2]| CornerSample { body_accel_m_s2, wheel_accel_m_s2 };
    CarSample { corners: readings.map(|readings| Some(corner(readings))), ..*row }
}

/// Whether a pressure is shown that is beyond its interval, and one that is far off: at these wheels, and at the others.
fn shown_wrong(
    corners: &[Option<CornerEstimate<f64>>; 4],
    concerned: Wheels,
    pressure_kpa: &[f64; 4],
) -> [[bool; 2]; 2] {
    let [mut wrong, mut far] = [[false; 2]; 2];
    for corner in Corner::ALL {
        let i = corner.index();
        let Some(estimate) = corners[i].filter(|estimate| estimate.validity.is_valid()) else { continue };
        let at = usize::from(!concerned.contains(corner));
        let error = (estimate.pressure_kpa - pressure_kpa[i]).abs();
        let is_far = !(error <= FAR_KPA);
        far[at] |= is_far;
        wrong[at] |= is_far && !(error <= WRONG_SDS * estimate.pressure_sd_kpa);
    }
    [wrong, far]
}

#[cfg(test)]
mod tests {
    use super::super::kinds;
    use super::*;
    use crate::low;
    use itpms_core::diagnosis::{Malfunction, Place, Sensor};
    use itpms_core::model::{Diagnostics, Level, Validity, Warning};

    fn stuck() -> Kind {
        kinds().into_iter().find(|kind| kind.name == "stuck, wheel").unwrap()
    }

    fn alert(cause: Cause<f64>, wheels: impl Into<Wheels>) -> Alert<f64> {
        Alert { wheels: wheels.into(), since_s: 0.0, reported_s: 1.0, cause }
    }

    fn broken(malfunction: Malfunction<f64>) -> Alert<f64> {
        alert(Cause::Malfunction(malfunction), malfunction.wheels())
    }

    fn shows(pressure_kpa: f64, pressure_sd_kpa: f64, validity: Validity) -> Option<CornerEstimate<f64>> {
        Some(CornerEstimate {
            time_s: 0.0,
            stiffness_n_per_m: 2e5,
            stiffness_sd_n_per_m: 5e3,
            pressure_kpa,
            pressure_sd_kpa,
            change_sd_kpa: pressure_sd_kpa,
            axle_difference_sd_kpa: None,
            loss: None,
            cold: None,
            level: Level::Calibration,
            road_m: 0.0,
            road_sd_m: 0.01,
            validity,
            warning: Warning::None,
            diagnostics: Diagnostics {
                forgetting: 1.0,
                nis: 1.0,
                gate: 1.0,
                change_probability: 0.0,
                pressure_variance_kpa2: pressure_sd_kpa * pressure_sd_kpa,
            },
        })
    }

    #[test]
    fn a_wheel_that_is_dragged_along_is_counted_apart() {
        use Validity::{BadSignal, Valid};
        let truth = [240.0; 4];
        let faulty = Wheels::from(Corner::FrontLeft);
        let looked = |corners| shown_wrong(&corners, faulty, &truth);
        let fine = shows(241.0, 4.0, Valid);
        assert_eq!(looked([fine; 4]), [[false; 2]; 2]);
        // The faulty wheel shows nothing; the one behind it is 30 kPa off at 4 kPa of sd, then at 12.
        let hidden = shows(120.0, 4.0, BadSignal);
        assert_eq!(looked([hidden, fine, shows(210.0, 4.0, Valid), fine]), [[false, true]; 2]);
        assert_eq!(looked([hidden, fine, shows(210.0, 12.0, Valid), fine]), [[false; 2], [false, true]]);
        assert_eq!(looked([shows(270.0, 4.0, Valid), fine, fine, fine]), [[true, false]; 2]);
        let mut sum = Shown::default();
        sum.add([[false, true], [true, true]], 0.5);
        sum.add([[true, false], [true, false]], 0.25);
        assert_eq!((sum.wrong_s, sum.far_s), ([0.25, 0.5], [0.75, 0.5]));
    }

    #[test]
    fn warnings_of_tires_and_other_malfunctions_are_counted() {
        let (kind, [fl, fr, rl, _]) = (stuck(), Corner::ALL);
        let wheel = |corner| Sensor { corner, place: Place::Wheel };
        let mut outcome = Outcome::default();
        outcome.note(&kind, Phase::Hidden, &low(fl));
        outcome.note(&kind, Phase::Said, &broken(Malfunction::Stuck(wheel(fl))));
        outcome.note(&kind, Phase::Said, &broken(Malfunction::Noise(wheel(fl))));
        outcome.note(&kind, Phase::Said, &broken(Malfunction::Stuck(wheel(fr))));
        outcome.note(&kind, Phase::Over, &low(rl));
        let all: Wheels = Corner::ALL.into_iter().collect();
        outcome.note(
            &kind,
            Phase::Over,
            &alert(Cause::AllLow { mean_share: 0.8, sd_share: 0.01, probability: 0.998 }, all),
        );
        assert_eq!(outcome.tires_during, TireWarnings { low: 1, ..TireWarnings::default() });
        assert_eq!(outcome.tires_after, TireWarnings { low: 1, all_low: 1, ..TireWarnings::default() });
        assert_eq!(outcome.tires_during.plus(outcome.tires_after).total(), 3);
        assert_eq!(outcome.others_said, 2);
    }

    #[test]
    fn exactly_is_the_malfunction_and_no_other_beside_it() {
        let (kind, [fl, fr, ..]) = (stuck(), Corner::ALL);
        let wheel = |corner| Sensor { corner, place: Place::Wheel };
        let said = |alerts: &[Alert<f64>]| {
            let mut outcome = Outcome { driven_s: 3.0, ..Outcome::default() };
            outcome.take_report(&kind, alerts).then_some((outcome.label, outcome.exactly))
        };
        let (right, other_wheel) =
            (broken(Malfunction::Stuck(wheel(fl))), broken(Malfunction::Stuck(wheel(fr))));
        assert_eq!(said(&[low(fl)]), None);
        assert_eq!(said(&[other_wheel]), None);
        assert_eq!(said(&[low(fl), right]), Some(("stuck", true)));
        assert_eq!(said(&[right, other_wheel]), Some(("stuck", false)));
        assert_eq!(said(&[broken(Malfunction::Inconsistent(fl))]), Some(("inconsistent", false)));
    }
}
