//! Reservations about the result. Called by `corner`.

use std::f64::consts::TAU;

use super::BumpFit;

/// Share of the slow motion that a quarter car explains at least.
const EXPLAINED: f64 = 0.97;
/// By how many standard errors, and by which share, two ways to the hop may differ.
const APART: f64 = 3.0;
const APART_SHARE: f64 = 0.05;

/// By how much a single moment's residual exceeds the usual one when it is no suspension's.
const JUMP: f64 = 20.0;

pub(super) fn concerns(fit: &BumpFit) -> Vec<String> {
    let mut out = Vec::new();
    out.extend(jump(fit));
    if !(fit.body_explained > EXPLAINED) {
        out.push(format!(
            "spring, damper and friction explain {:.1} % of the body's motion below 4 Hz: several corners move, or sensors are not of the same instant",
            100.0 * fit.body_explained
        ));
    }
    let friction = &fit.friction_m_s2;
    if friction.value < -APART * friction.standard_error {
        out.push("friction comes out negative: the damper gets stiffer with velocity, or the signals are delayed against each other".to_owned());
    }
    if fit.body_damping_ratio.value < -APART * fit.body_damping_ratio.standard_error {
        out.push(
            "damping comes out negative: body and wheel are exchanged, or not of the same instant".to_owned(),
        );
    }
    if fit.hop_hz.is_none() {
        out.push(
            "the wheel hardly hops by itself in this record: no hop frequency; a drop off a block excites it"
                .to_owned(),
        );
    }
    out.extend(tire(fit));
    out
}

/// A moment that stands out of the body's residual.
fn jump(fit: &BumpFit) -> Option<String> {
    let left = |p: &(f64, f64, f64)| (p.1 - p.2).abs();
    let worst = fit.traces.body.iter().max_by(|a, b| left(a).total_cmp(&left(b)))?;
    let mut sizes: Vec<f64> = fit.traces.body.iter().map(left).collect();
    let middle = sizes.len() / 2;
    let (_, usual, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    (left(worst) > JUMP * *usual).then(|| {
        format!(
            "at {:.2} s the body's signal jumps by {:.0} times what is left at other times: a sensor's step, or a stop that is hit; --from-s and --until-s leave it out",
            worst.0,
            left(worst) / *usual
        )
    })
}

fn tire(fit: &BumpFit) -> Vec<String> {
    let Some(parts) = &fit.parts else { return Vec::new() };
    let mut out = Vec::new();
    let (spring, tire, m_w) = (&parts.spring_n_per_m, &parts.tire_n_per_m, parts.masses.unsprung_kg);
    if !(tire.value > APART * tire.standard_error) {
        out.push(format!(
            "the tire is not distinguishable from none: {:.0} ± {:.0} N/m; the wheel moves too little for its sensor, or the masses are of another corner",
            tire.value, tire.standard_error
        ));
        return out;
    }
    if !(parts.tire_explained > EXPLAINED) {
        out.push(format!(
            "a tire explains {:.1} % of the force on the road below 4 Hz: the masses are of another corner, or the wheel's sensor drifts",
            100.0 * parts.tire_explained
        ));
    }
    let (Some(hop), stiffness) = (&fit.hop_hz, spring.value + tire.value) else { return out };
    let by_parts = (stiffness / m_w).sqrt() / TAU;
    let error = 0.5 * by_parts * spring.standard_error.hypot(tire.standard_error) / stiffness;
    let apart = (hop.value - by_parts).abs();
    if apart > APART * hop.standard_error.hypot(error) && apart > APART_SHARE * by_parts {
        out.push(format!(
            "the wheel hops at {:.2} Hz; spring, tire and {m_w:.1} kg would make it {by_parts:.2} Hz: {:.1} kg hop, or the ground or the axle gives way, or another oscillation was taken for the hop",
            hop.value,
            stiffness / (TAU * hop.value).powi(2)
        ));
    }
    out
}
