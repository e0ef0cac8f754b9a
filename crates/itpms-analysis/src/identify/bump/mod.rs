//! Spring, damper, friction, wheel hop and tire of a corner from a drop or a bump: a body let fall on its suspension, a car
//! off a block, a rig (docs/math/identification.md, section 6).
//!
//! Called by `itpms lab identify bump`. Body and wheel of a corner are measured, as heights or as accelerations, while they swing
//! freely over a road that stands still. Spring, damper and friction follow from the body's equation, the tire from the
//! sum of both; each is fitted in bands of frequency that weigh by what the model leaves of them.
//!
//! | module | idea |
//! |---|---|
//! | `smooth` | Gaussian low-passes without delay, and the bands between them |
//! | `motion` | heights or accelerations to heights, velocities, accelerations and friction by band; where the free motion is |
//! | `fit` | least squares over bands, standard errors from the disagreement of blocks |
//! | `hop` | the wheel's own oscillation, from its spectrum |
//! | `corner` | the parts put together for one corner, or for the mean of an axle's two |
//! | `doubts`, `text`, `figure` | concerns; the result for people |

mod corner;
mod doubts;
mod figure;
mod fit;
mod hop;
mod motion;
mod smooth;
mod text;

use serde::Serialize;

use super::Result;
use super::estimate::Estimate;
use motion::Motion;

/// Measurements of a corner, in the rows of the record.
#[derive(Debug, Clone, Copy)]
pub enum BumpSignals<'a> {
    /// Heights in m of body and wheel, up positive, from any zero.
    Heights { body_m: &'a [f64], wheel_m: &'a [f64] },
    /// Accelerations in m/s² of body and wheel, up positive, with or without gravity.
    Accelerations { body_m_s2: &'a [f64], wheel_m_s2: &'a [f64] },
}

#[derive(Debug, Clone, Copy)]
pub struct BumpCorner<'a> {
    /// `fl`, `fr`, `rl` or `rr`.
    pub label: &'a str,
    pub signals: BumpSignals<'a>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BumpMasses {
    pub sprung_kg: f64,
    pub unsprung_kg: f64,
}

/// Parameters of a car's corners from a drop.
#[derive(Debug, Clone, PartialEq)]
pub struct BumpResult {
    pub corners: Vec<BumpFit>,
    /// Where both corners of an axle were measured, their mean motion as one corner: the roll that couples them is not in it.
    pub axles: Vec<BumpFit>,
}

/// Parameters of one corner from a drop, or of the mean of an axle's two.
#[derive(Debug, Clone, PartialEq)]
pub struct BumpFit {
    /// `fl`, `fr`, `rl`, `rr`, or `front`, `rear`.
    pub label: String,
    pub body_hz: Estimate,
    /// Damping ratio of the body on its spring, without friction.
    pub body_damping_ratio: Estimate,
    pub friction_m_s2: Estimate,
    /// Frequency in Hz of the wheel's hop, from the wheel's motion alone; `None` where it was hardly excited.
    pub hop_hz: Option<Estimate>,
    pub hop_damping_ratio: Option<Estimate>,
    pub parts: Option<BumpParts>,
    /// Share of the body's acceleration (below 4 Hz) that the model explains.
    pub body_explained: f64,
    /// Time in s from which and until which the motion was used.
    pub used_s: (f64, f64),
    /// Reservations about the result.
    pub concerns: Vec<String>,
    traces: Traces,
}

/// Spring, damper, friction and tire.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BumpParts {
    #[serde(skip)]
    pub masses: BumpMasses,
    pub spring_n_per_m: Estimate,
    pub damping_n_s_per_m: Estimate,
    pub friction_n: Estimate,
    pub tire_n_per_m: Estimate,
    pub tire_damping_n_s_per_m: Estimate,
    /// Share of the force on the road (below 4 Hz) that the model explains.
    pub tire_explained: f64,
}

/// Measured and fitted over time: (s, measured, fitted), below 16 Hz.
#[derive(Debug, Clone, PartialEq, Default)]
struct Traces {
    body: Vec<(f64, f64, f64)>,
    /// Force on the road in N, less its mean; empty without masses.
    tire: Vec<(f64, f64, f64)>,
}

/// Where to look; the free motion is found unless given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BumpWindow {
    pub from_s: Option<f64>,
    pub until_s: Option<f64>,
}

/// Identifies the corners of a record of one drop or bump.
pub fn bump(
    time_s: &[f64],
    corners: &[BumpCorner<'_>],
    masses: Option<BumpMasses>,
    window: BumpWindow,
) -> Result<BumpResult> {
    let motions = corners
        .iter()
        .map(|corner| Ok((corner.label, Motion::of(time_s, corner, window)?)))
        .collect::<Result<Vec<_>>>()?;
    let fits = motions
        .iter()
        .map(|(label, motion)| corner::fit(label, motion, masses))
        .collect::<Result<Vec<_>>>()?;
    let find = |label: &str| motions.iter().find(|(name, _)| *name == label).map(|(_, motion)| motion);
    let mut axles = Vec::new();
    for (axle, [left, right]) in [("front", ["fl", "fr"]), ("rear", ["rl", "rr"])] {
        if let (Some(left), Some(right)) = (find(left), find(right)) {
            axles.push(corner::fit(axle, &left.mean_with(right), masses)?);
        }
    }
    Ok(BumpResult { corners: fits, axles })
}
