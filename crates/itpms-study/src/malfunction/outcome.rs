//! One malfunction put into one drive: when it was said, what was shown meanwhile, and how the monitor came back.

use itpms_core::estimate::CornerEstimate;
use itpms_core::monitor::{Cause, MonitorReport, MonitoredCar, Wheels};
use itpms_core::sample::{CarSample, Corner, CornerSample};
use itpms_sim::fault::{CornerName, FaultKind, FaultSpec, Faults};

use super::drive::Recorded;
use super::kinds::Kind;

/// Seconds for which a malfunction goes on after it was said, and the longest it lasts.
const AFTER_SAID_S: f64 = 20.0;
const LONGEST_S: f64 = 150.0;
/// Seconds for which the recovery is waited for.
const RECOVERY_S: f64 = 120.0;
/// Speed in m/s above which time counts as driven.
const DRIVING_M_S: f64 = 3.0;
/// Error over its sd beyond which a pressure that is shown is wrong; and in kPa, whatever the sd.
const WRONG_SDS: f64 = 3.0;
const FAR_KPA: f64 = 20.0;

/// What came of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Outcome {
    /// Seconds of driving until it was said; `None`: never.
    pub(super) said_after_s: Option<f64>,
    /// What it was called then.
    pub(super) label: &'static str,
    /// Seconds of driving while it lasted.
    pub(super) driven_s: f64,
    /// Seconds in which a wrong pressure was shown at a wheel it concerns, and one far off: before it was said, and after.
    pub(super) wrong_before_s: f64,
    pub(super) far_before_s: f64,
    pub(super) wrong_after_s: f64,
    pub(super) far_after_s: f64,
    /// Seconds of driving after its end until nothing was said any more and a right pressure was shown.
    pub(super) recovered_after_s: Option<f64>,
    /// Seconds of driving after its end that were driven.
    pub(super) driven_after_s: f64,
}

/// Where it stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    Hidden,
    Said,
    Over,
}

/// Drives on with the malfunction from where it begins.
pub(super) fn run(kind: &Kind, drive: &Recorded, mut car: MonitoredCar<f64>, seed: u64) -> Outcome {
    let period_s = 1.0 / drive.rate_hz;
    let concerned = kind.faults.iter().flat_map(concerned).collect::<Wheels>();
    let mut faults = Faults::new(&from_the_start(kind), seed);
    let mut outcome = Outcome::default();
    let mut phase = Phase::Hidden;
    let (mut lasted_s, mut since_s) = (0.0, 0.0);
    for row in &drive.rows[drive.begins..] {
        let step_driven_s = if row.speed_m_s > DRIVING_M_S { period_s } else { 0.0 };
        let sample = if phase == Phase::Over { *row } else { spoiled(row, &mut faults) };
        let estimate = car.update(&sample);
        let report = car.report();
        let [wrong, far] = shown_wrong(&estimate.corners, concerned, &drive.pressure_kpa);
        lasted_s += period_s;
        since_s += period_s;
        match phase {
            Phase::Hidden => {
                outcome.driven_s += step_driven_s;
                outcome.wrong_before_s += if wrong { period_s } else { 0.0 };
                outcome.far_before_s += if far { period_s } else { 0.0 };
                if let Some(label) = malfunction_of(report, concerned) {
                    (outcome.said_after_s, outcome.label) = (Some(outcome.driven_s), label);
                    (phase, since_s) = (Phase::Said, 0.0);
                } else if lasted_s > LONGEST_S {
                    (phase, since_s) = (Phase::Over, 0.0);
                }
            }
            Phase::Said => {
                outcome.driven_s += step_driven_s;
                outcome.wrong_after_s += if wrong { period_s } else { 0.0 };
                outcome.far_after_s += if far { period_s } else { 0.0 };
                if since_s > AFTER_SAID_S {
                    (phase, since_s) = (Phase::Over, 0.0);
                }
            }
            Phase::Over => {
                outcome.driven_after_s += step_driven_s;
                let all_shown = concerned.iter().all(|corner| {
                    estimate.corners[corner.index()].is_some_and(|corner| corner.validity.is_valid())
                });
                if all_shown && !wrong && report.malfunctioning().is_empty() {
                    outcome.recovered_after_s = Some(outcome.driven_after_s);
                    break;
                }
                if since_s > RECOVERY_S {
                    break;
                }
            }
        }
    }
    outcome
}

/// The malfunction's label if one is said at a wheel that it concerns.
pub(super) fn malfunction_of(report: &MonitorReport<f64>, concerned: Wheels) -> Option<&'static str> {
    report.alerts().find_map(|alert| match &alert.cause {
        Cause::Malfunction(malfunction) if alert.wheels.iter().any(|c| concerned.contains(c)) => {
            Some(malfunction.label())
        }
        _ => None,
    })
}

fn concerned(fault: &FaultSpec) -> impl Iterator<Item = Corner> {
    let corner = |name: CornerName| Corner::ALL[name as usize];
    let other = match fault.kind {
        FaultKind::Swap { with } => Some(corner(with.corner)),
        _ => None,
    };
    std::iter::once(corner(fault.corner)).chain(other)
}

fn from_the_start(kind: &Kind) -> Vec<FaultSpec> {
    kind.faults.iter().map(|fault| FaultSpec { from_s: -1e6, ..*fault }).collect()
}

fn spoiled(row: &CarSample<f64>, faults: &mut Faults) -> CarSample<f64> {
    let nothing = [f64::NAN; 2];
    let mut readings = row.corners.map(|c| c.map_or(nothing, |c| [c.body_accel_m_s2, c.wheel_accel_m_s2]));
    faults.spoil(row.time_s, &mut readings);
    let corner =
        |[body_accel_m_s2, wheel_accel_m_s2]: [f64; 2]| CornerSample { body_accel_m_s2, wheel_accel_m_s2 };
    CarSample { corners: readings.map(|readings| Some(corner(readings))), ..*row }
}

/// Whether a pressure that is shown at one of these wheels is beyond its interval, and whether it is far off.
fn shown_wrong(
    corners: &[Option<CornerEstimate<f64>>; 4],
    concerned: Wheels,
    pressure_kpa: &[f64; 4],
) -> [bool; 2] {
    let shown = concerned.iter().filter_map(|corner| {
        let estimate = corners[corner.index()].filter(|estimate| estimate.validity.is_valid())?;
        Some(((estimate.pressure_kpa - pressure_kpa[corner.index()]).abs(), estimate.pressure_sd_kpa))
    });
    shown.fold([false; 2], |[wrong, far], (error, sd)| {
        let is_far = !(error <= FAR_KPA);
        [wrong || is_far && !(error <= WRONG_SDS * sd), far || is_far]
    })
}
