//! Imposed motion, made ready for a fit: runs of a steady sine, cut into blocks of whole periods, with smooth displacement
//! and velocity and without the rows in which friction has not settled. Called by the damper's identification.

use std::f64::consts::TAU;
use std::ops::Range;

use super::guard::{self, Units};
use super::sine::{self, Sine};
use super::{IdentifyError, Result};

/// Rows needed in a period.
const FEWEST_PER_PERIOD: usize = 20;
/// Most blocks of a run: enough to learn their scatter, each long enough to be independent of its neighbors.
const MOST_BLOCKS: usize = 12;
/// Largest amplitude of a damper in m, lowest frequency in Hz of a test.
const LARGEST_M: f64 = 0.5;
const SLOWEST_HZ: f64 = 0.02;

/// One continuous record of imposed motion.
#[derive(Debug, Clone, Copy)]
pub struct SineRecord<'a> {
    pub name: &'a str,
    /// Time in s, strictly increasing.
    pub time_s: &'a [f64],
    pub displacement_m: &'a [f64],
    pub force_n: &'a [f64],
}

/// A row that is used: displacement about its mean in m, velocity in m/s, force in N.
#[derive(Debug, Clone, Copy)]
pub(super) struct MotionRow {
    pub(super) x: f64,
    pub(super) v: f64,
    pub(super) force: f64,
}

/// A stretch of one steady sine.
pub(super) struct Run {
    pub(super) record: String,
    pub(super) sine: Sine,
    pub(super) periods: usize,
    pub(super) blocks: Vec<Vec<MotionRow>>,
    /// Imaginary part of force over displacement, over omega.
    pub(super) equivalent_n_s_per_m: f64,
}

impl Run {
    pub(super) fn frequency_hz(&self) -> f64 {
        self.sine.omega / TAU
    }

    pub(super) fn amplitude_m(&self) -> f64 {
        self.sine.amplitude()
    }

    pub(super) fn velocity_m_s(&self) -> f64 {
        self.sine.omega * self.amplitude_m()
    }
}

/// All runs of all records, in their order. `unsettled` is the share of a stroke after a turn that is left out.
pub(super) fn runs(records: &[SineRecord<'_>], unsettled: f64, units: Units) -> Result<Vec<Run>> {
    let mut out = Vec::new();
    let mut none = None;
    for record in records {
        guard::pair(("time_s", record.time_s), ("displacement_m", record.displacement_m))?;
        guard::pair(("displacement_m", record.displacement_m), ("force_n", record.force_n))?;
        guard::at_least("rows", record.time_s.len(), FEWEST_PER_PERIOD)?;
        let (low, high) = guard::varies("displacement_m", record.displacement_m)?;
        guard::varies("force_n", record.force_n)?;
        check_amplitude(0.5 * (high - low), units)?;
        match sine::stretches(record.time_s, record.displacement_m) {
            Ok(stretches) => {
                for rows in stretches {
                    out.push(run(record, rows, unsettled, units)?);
                }
            }
            Err(error @ IdentifyError::TooFewPeriods { .. }) => none = Some(error),
            Err(error) => return Err(error),
        }
    }
    if let (true, Some(error)) = (out.is_empty(), none) {
        return Err(error);
    }
    guard::at_least("records", out.len(), 1).map(|()| out)
}

fn check_amplitude(amplitude_m: f64, units: Units) -> Result<()> {
    if units == Units::Trusted || amplitude_m <= LARGEST_M {
        return Ok(());
    }
    let hint = "; it looks like millimetres";
    Err(IdentifyError::unit("the amplitude", (amplitude_m, "m"), "at most 0.5 m", hint))
}

fn run(record: &SineRecord<'_>, rows: Range<usize>, unsettled: f64, units: Units) -> Result<Run> {
    let (t, x, force) =
        (&record.time_s[rows.clone()], &record.displacement_m[rows.clone()], &record.force_n[rows]);
    guard::not_clipped("displacement_m", x)?;
    guard::not_clipped("force_n", force)?;
    let short = IdentifyError::TooFewPeriods { found: 0, expected: sine::FEWEST_PERIODS };
    let sine = sine::fit(t, x).ok_or(short)?;
    let frequency_hz = sine.omega / TAU;
    if units == Units::Checked && frequency_hz < SLOWEST_HZ {
        let hint = "; time_s looks like milliseconds";
        return Err(IdentifyError::unit("the frequency", (frequency_hz, "Hz"), "0.02 Hz or more", hint));
    }
    let span = t.last().unwrap_or(&0.0) - t.first().unwrap_or(&0.0);
    let rows_per_period = (t.len() - 1) as f64 / (span * frequency_hz);
    if !(rows_per_period >= FEWEST_PER_PERIOD as f64) {
        return Err(IdentifyError::Refused(format!(
            "{rows_per_period:.1} rows per period at {frequency_hz:.3} Hz, expected at least {FEWEST_PER_PERIOD}"
        )));
    }
    let singular = || IdentifyError::singular("frequency and force");
    let answer = sine::at(sine.omega, t, force).ok_or_else(singular)?;
    let (periods, blocks) = blocks(&sine, t, x, force, unsettled).ok_or_else(singular)?;
    Ok(Run {
        record: record.name.to_owned(),
        equivalent_n_s_per_m: quadrature(&sine, &answer) / sine.omega,
        sine,
        periods,
        blocks,
    })
}

/// Imaginary part of the ratio of two sines.
fn quadrature(x: &Sine, force: &Sine) -> f64 {
    // x = Re (cosine - i sine) exp(i omega tau), and so the force.
    (x.sine * force.cosine - x.cosine * force.sine) / x.amplitude().powi(2)
}

/// Whole periods, and their rows in blocks.
fn blocks(
    sine: &Sine,
    t: &[f64],
    x: &[f64],
    force: &[f64],
    unsettled: f64,
) -> Option<(usize, Vec<Vec<MotionRow>>)> {
    // A record of whole periods may begin a row too late or end one too early.
    let slack = 1.0 / FEWEST_PER_PERIOD as f64;
    let first = (sine.turns(*t.first()?) - slack).ceil();
    let last = (sine.turns(*t.last()?) + slack).floor();
    let periods = (last - first).max(0.0) as usize;
    if periods < 2 {
        return None;
    }
    let count = periods.min(MOST_BLOCKS);
    let mut out = Vec::with_capacity(count);
    for block in 0..count {
        let from = first + (block * periods / count) as f64;
        let to = first + ((block + 1) * periods / count) as f64;
        let start = t.partition_point(|t| sine.turns(*t) < from);
        let end = t.partition_point(|t| sine.turns(*t) < to);
        let smooth = sine::smooth(sine, &t[start..end], &x[start..end])?;
        // A record may begin at rest, with friction that has not built up.
        let turned_at = if block == 0 { smooth.first().map(|(x, _)| *x) } else { None };
        out.push(settled(&smooth, &force[start..end], 2.0 * unsettled * sine.amplitude(), turned_at));
    }
    Some((periods, out))
}

/// The rows in which the motion is at least `margin` from where it last turned.
fn settled(smooth: &[(f64, f64)], force: &[f64], margin: f64, mut turned_at: Option<f64>) -> Vec<MotionRow> {
    let mut out = Vec::with_capacity(smooth.len());
    for (i, ((x, v), force)) in smooth.iter().zip(force).enumerate() {
        if i > 0 && smooth[i - 1].1 * v <= 0.0 {
            turned_at = Some(*x);
        }
        if turned_at.is_none_or(|at| (x - at).abs() >= margin) {
            out.push(MotionRow { x: *x, v: *v, force: *force });
        }
    }
    out
}
