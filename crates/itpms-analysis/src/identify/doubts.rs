//! Reservations about a damper's result. Called by the damper's identification.

use super::damper_result::{Consistency, DamperResult};

/// Probability below which runs are reported to disagree.
const SUSPICIOUS: f64 = 0.01;
/// Difference between the directions, as a share of the damping, that is worth a remark.
const ASYMMETRIC: f64 = 0.05;
/// Residual of the displacement from a sine, as a share of its amplitude, that is worth a remark.
const DISTORTED: f64 = 0.03;

pub(super) fn concerns(result: &DamperResult) -> Vec<String> {
    let mut out = Vec::new();
    let c = result.damping_n_s_per_m;
    let slowest = result.runs.iter().map(|run| run.velocity_m_s).fold(f64::INFINITY, f64::min);
    let fastest = result.runs.iter().map(|run| run.velocity_m_s).fold(0.0, f64::max);
    if fastest < 1.5 * slowest {
        out.push(
            "one velocity only: damping and friction are separated by the shape of the loop alone; add a run of another frequency or amplitude"
                .to_owned(),
        );
    }
    let disagrees = |test: &Consistency| test.p < SUSPICIOUS || test.friction_p < SUSPICIOUS;
    if let Some(test) = result.consistency.filter(disagrees) {
        out.push(format!(
            "the runs disagree (damping p = {:.2e}, friction p = {:.2e}): the damper is not linear over {slowest:.3} to {fastest:.3} m/s, or it warmed up; the value is a mean over the runs and its standard error too small",
            test.p, test.friction_p
        ));
    }
    if result.friction_n.deviation(0.0) < -3.0 {
        out.push(format!(
            "friction is negative ({:.2} N): force grows faster than velocity, the damper is progressive",
            result.friction_n.value
        ));
    }
    let (up, down) = (result.rising_n_s_per_m, result.falling_n_s_per_m);
    let between = (up.value - down.value).abs();
    if between > 2.0 * up.standard_error.hypot(down.standard_error) && between > ASYMMETRIC * c.value {
        out.push(format!(
            "bump and rebound differ: {:.1} N s/m while the displacement grows, {:.1} while it falls",
            up.value, down.value
        ));
    }
    for run in &result.runs {
        if run.distortion > DISTORTED {
            out.push(format!(
                "the motion at {:.2} Hz departs from a sine by {:.1} % of its amplitude",
                run.frequency_hz,
                100.0 * run.distortion
            ));
        }
    }
    let strays = result.runs.iter().filter(|run| {
        result.spring_n_per_m.is_some_and(|k| {
            run.in_phase_n_per_m.value.abs() > 0.05 * k && run.in_phase_n_per_m.deviation(0.0).abs() > 3.0
        })
    });
    for run in strays {
        let left = run.in_phase_n_per_m.value;
        // All of the spring is missing: more likely there is none than that something undoes it.
        let cause = match result.spring_n_per_m {
            Some(k) if (left + k).abs() < 0.1 * k => "is that spring in this force at all?",
            _ => "moving mass, a gas spring, or another spring",
        };
        out.push(format!(
            "at {:.2} Hz {left:.0} N/m in phase with the displacement are left beside the spring given: {cause}",
            run.frequency_hz
        ));
    }
    out
}
