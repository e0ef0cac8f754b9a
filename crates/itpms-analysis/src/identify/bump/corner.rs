//! One corner, or the mean of an axle's two: body, hop and tire fitted and put together. Called by `bump`.

use std::f64::consts::TAU;

use super::super::estimate::Estimate;
use super::super::{IdentifyError, Result};
use super::fit::{BandRows, Fit};
use super::hop::hop;
use super::motion::{Band, Motion};
use super::{BumpFit, BumpMasses, BumpParts, Traces, doubts};

// Coefficients of the body's equation, over its mass; constants follow.
const SPRING: usize = 0;
const DAMPING: usize = 1;
const FRICTION: usize = 2;
// Of the tire's.
const TIRE: usize = 0;
const TIRE_DAMPING: usize = 1;
/// Bands that are drawn: below 16 Hz.
const DRAWN: usize = 3;

pub(super) fn fit(label: &str, motion: &Motion, masses: Option<BumpMasses>) -> Result<BumpFit> {
    let body_rows: Vec<BandRows> = motion.bands.iter().map(|band| body_equation(band, motion)).collect();
    let body =
        Fit::of(&body_rows, &motion.whole(|band| &band.travel_velocity), "spring, damper and friction")?;
    let (spring, damping) = (body.coefficient(SPRING, 1.0), body.coefficient(DAMPING, 1.0));
    if !(spring.value > 3.0 * spring.standard_error) {
        return Err(IdentifyError::no_slope("the spring over the sprung mass", &spring, "1/s²"));
    }
    let w = spring.value.sqrt();
    let ratio = damping.value / (2.0 * w);
    let ratio_slopes = [(DAMPING, 1.0 / (2.0 * w)), (SPRING, -damping.value / (4.0 * w.powi(3)))];
    let wheel_hop = hop(&motion.wheel_acceleration[motion.rows.clone()], motion.step_s);
    let mut traces = Traces { body: trace(motion, &body_rows, &body), tire: Vec::new() };
    let parts = match masses {
        None => None,
        Some(masses) => {
            let rows: Vec<BandRows> =
                motion.bands.iter().map(|band| tire_equation(band, motion, masses)).collect();
            let tire = Fit::of(
                &rows,
                &motion.whole(|band| &band.wheel_velocity),
                "stiffness and damping of the tire",
            )?;
            traces.tire = trace(motion, &rows, &tire);
            Some(parts(&body, &tire, masses))
        }
    };
    let mut result = BumpFit {
        label: label.to_owned(),
        body_hz: body.function(w / TAU, &[(SPRING, 1.0 / (2.0 * w * TAU))]),
        body_damping_ratio: body.function(ratio, &ratio_slopes),
        friction_m_s2: body.coefficient(FRICTION, 1.0),
        hop_hz: wheel_hop.map(|(hz, _)| hz),
        hop_damping_ratio: wheel_hop.map(|(_, ratio)| ratio),
        parts,
        body_explained: body.explained,
        used_s: (motion.time_s(motion.rows.start), motion.time_s(motion.rows.end - 1)),
        concerns: Vec::new(),
        traces,
    };
    result.concerns = doubts::concerns(&result);
    Ok(result)
}

fn parts(body: &Fit, tire: &Fit, masses: BumpMasses) -> BumpParts {
    let of_body = |index: usize| -> Estimate { body.coefficient(index, masses.sprung_kg) };
    BumpParts {
        masses,
        spring_n_per_m: of_body(SPRING),
        damping_n_s_per_m: of_body(DAMPING),
        friction_n: of_body(FRICTION),
        tire_n_per_m: tire.coefficient(TIRE, 1.0),
        tire_damping_n_s_per_m: tire.coefficient(TIRE_DAMPING, 1.0),
        tire_explained: tire.explained,
    }
}

/// `a_b = (k_s (z_w - z_b) + c_s (v_w - v_b) + F u) / m_b + constants`.
fn body_equation(band: &Band, motion: &Motion) -> BandRows {
    let rows = |x: &[f64]| x[motion.rows.clone()].to_vec();
    let mut columns = vec![rows(&band.travel), rows(&band.travel_velocity), rows(&band.slip)];
    columns.extend(band.constants.iter().map(|constant| rows(constant)));
    BandRows { columns, target: rows(&band.body_acceleration) }
}

/// `m_b a_b + m_w a_w = -k_t z_w - c_t v_w + constants`, the road at rest.
fn tire_equation(band: &Band, motion: &Motion, masses: BumpMasses) -> BandRows {
    let rows = |x: &[f64], sign: f64| x[motion.rows.clone()].iter().map(|v| sign * v).collect::<Vec<_>>();
    let mut columns = vec![rows(&band.wheel, -1.0), rows(&band.wheel_velocity, -1.0)];
    columns.extend(band.constants.iter().map(|constant| rows(constant, 1.0)));
    let target = motion
        .rows
        .clone()
        .map(|i| {
            masses.sprung_kg * band.body_acceleration[i] + masses.unsprung_kg * band.wheel_acceleration[i]
        })
        .collect();
    BandRows { columns, target }
}

/// Measured and fitted over time, of the bands that are drawn together.
fn trace(motion: &Motion, bands: &[BandRows], fit: &Fit) -> Vec<(f64, f64, f64)> {
    let fitted: Vec<Vec<f64>> = bands[..DRAWN].iter().map(|band| fit.fitted(band)).collect();
    (0..motion.rows.len())
        .map(|i| {
            let measured = bands[..DRAWN].iter().map(|band| band.target[i]).sum();
            (motion.time_s(motion.rows.start + i), measured, fitted.iter().map(|band| band[i]).sum())
        })
        .collect()
}
