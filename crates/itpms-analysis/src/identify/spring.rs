//! Spring stiffness from a load-displacement record, loaded and unloaded slowly (paper, Sec. 5.1; docs/math/identification.md, section 1).
//!
//! Called by `itpms lab identify spring`. Load may be a force or a weight in newtons; which way either of them counts does
//! not matter. Friction shows as a loop and is separated, preload as an offset.

use serde::Serialize;

use super::blocks::{Block, jackknife, solve};
use super::estimate::{ErrorBasis, Estimate};
use super::guard::{self, Units};
use super::strokes::{Stroke, strokes};
use super::{IdentifyError, Result, loops};

const FEWEST_ROWS: usize = 6;
/// Share of the travel by which the displacement must come back to have turned.
const TURN: f64 = 0.1;
/// Share of the travel after a turn in which friction has not settled to the new direction.
pub(super) const UNSETTLED: f64 = 0.05;
/// Rows from which a stroke can spare its ends, so that all strokes cover the same stretch.
const DENSE: usize = 20;
/// Strokes from which their disagreement gives the standard error.
const STROKES_TO_COMPARE: usize = 4;
/// Rows from which the correlation of residuals can be learnt.
const ROWS_TO_CORRELATE: usize = 30;
/// Window of that correlation as a share of the rows. The critical value that belongs to a third is 2.98 (Kiefer and
/// Vogelsang 2005) for long records; one loop is short and its residuals have lost an offset per stroke. Student's t with
/// two degrees of freedom, 4.30, keeps the interval honest for noise that forgets within a thirtieth of a stroke.
const WINDOW: f64 = 1.0 / 3.0;
const WINDOW_DOF: f64 = 2.0;
/// Nonlinearity in percent of the load's range that is worth a remark.
const NONLINEAR_PERCENT: f64 = 1.0;
/// Stiffness in N/m beyond which the unit is doubted.
const PLAUSIBLE_N_PER_M: (f64, f64) = (500.0, 10_000_000.0);
/// Longest travel in m of any spring of a car.
const LONGEST_M: f64 = 1.0;

/// Spring parameters from a load-displacement record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpringResult {
    /// Stiffness in N/m: slope of the best line over the travel.
    pub stiffness_n_per_m: Estimate,
    pub error_basis: ErrorBasis,
    /// Half the height of the loop in N; `None` for a record in one direction.
    pub friction_n: Option<Estimate>,
    /// Load in N at zero displacement, midway between loading and unloading.
    pub load_at_zero_n: f64,
    /// Whether load and displacement count in opposite directions.
    pub opposite_signs: bool,
    /// Stiffness in N/m while the displacement grows and while it falls.
    pub rising_falling_n_per_m: (Option<f64>, Option<f64>),
    /// How the curve departs from the line; `None` where the rows are too few to see it.
    pub nonlinearity: Option<Nonlinearity>,
    /// Lowest and highest displacement in m that was used.
    pub travel_m: (f64, f64),
    pub strokes: usize,
    pub rows: usize,
    /// Rows left out: next to turning points, or in strokes too short to use.
    pub rows_left_out: usize,
    pub residual_rms_n: f64,
    pub concerns: Vec<String>,
    /// Displacement in m, load in N and residual in N of the rows used; for figures.
    #[serde(skip)]
    pub used: Vec<(f64, f64, f64)>,
}

/// Departure of a cubic from its best line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Nonlinearity {
    /// Largest distance in percent of the load's range.
    pub percent: f64,
    /// Stiffness in N/m of the cubic at the low end, in the middle and at the high end of the travel.
    pub tangent_n_per_m: [f64; 3],
    /// Whether a quadratic or cubic coefficient differs from zero by more than two standard errors.
    pub significant: bool,
}

struct Used {
    rising: bool,
    rows: Vec<(f64, f64)>,
}

/// Identifies a spring from displacement in m and load in N, in the order in which they were measured.
pub fn spring(displacement_m: &[f64], load_n: &[f64], units: Units) -> Result<SpringResult> {
    guard::pair(("displacement_m", displacement_m), ("load_n", load_n))?;
    guard::at_least("rows", load_n.len(), FEWEST_ROWS)?;
    let (low, high) = guard::varies("displacement_m", displacement_m)?;
    guard::varies("load_n", load_n)?;
    check_travel(high - low, units)?;
    let inside: Vec<f64> = displacement_m
        .iter()
        .zip(load_n)
        .filter(|(x, _)| **x > low + UNSETTLED * (high - low) && **x < high - UNSETTLED * (high - low))
        .map(|(_, load)| *load)
        .collect();
    guard::not_clipped("load_n", &inside)?;

    let used = usable(displacement_m, load_n, high - low);
    let rows: usize = used.iter().map(|stroke| stroke.rows.len()).sum();
    guard::at_least("usable rows", rows, FEWEST_ROWS)?;
    // Where the line is looked at: middle and half length of the travel used.
    let (first, last) =
        guard::range(&used.iter().flat_map(|s| s.rows.iter().map(|r| r.0)).collect::<Vec<_>>());
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let (slope, basis) = stiffness(&used, middle, half)?;
    let sign = slope.value.signum();
    if !(slope.value.abs() > 3.0 * slope.standard_error) {
        return Err(IdentifyError::no_slope("the stiffness", &slope, "N/m"));
    }
    let stiffness_n_per_m = Estimate { value: slope.value.abs(), ..slope };
    check_stiffness(stiffness_n_per_m.value, units)?;
    let fit = loops::Loop::of(
        &used.iter().map(|stroke| (stroke.rising, stroke.rows.as_slice())).collect::<Vec<_>>(),
        slope.value,
        middle,
    );
    let mut result = SpringResult {
        stiffness_n_per_m,
        error_basis: basis,
        friction_n: fit.friction(sign),
        load_at_zero_n: fit.middle_load - slope.value * middle,
        opposite_signs: sign < 0.0,
        rising_falling_n_per_m: (one_way(&used, middle, half, true), one_way(&used, middle, half, false)),
        nonlinearity: nonlinearity(&used, middle, half, basis),
        travel_m: (first, last),
        strokes: used.len(),
        rows,
        rows_left_out: load_n.len() - rows,
        residual_rms_n: fit.residual_rms,
        concerns: Vec::new(),
        used: fit.residuals,
    };
    result.concerns = concerns(&result, half);
    Ok(result)
}

fn check_travel(travel_m: f64, units: Units) -> Result<()> {
    if units == Units::Checked && travel_m > LONGEST_M {
        let hint = "; it looks like millimetres";
        return Err(IdentifyError::unit("the travel", (travel_m, "m"), "at most 1 m", hint));
    }
    Ok(())
}

fn check_stiffness(value: f64, units: Units) -> Result<()> {
    let (lowest, highest) = PLAUSIBLE_N_PER_M;
    if units == Units::Trusted || (lowest..=highest).contains(&value) {
        return Ok(());
    }
    let hint = if value < lowest { "; the load looks like kN" } else { "; is the displacement in m?" };
    Err(IdentifyError::unit("the stiffness", (value, "N/m"), "500 to 10 000 000 N/m", hint))
}

/// The rows of each stroke that friction has settled in.
fn usable(x: &[f64], load: &[f64], travel: f64) -> Vec<Used> {
    let found = strokes(x, TURN * travel);
    let turns = found.len() > 1;
    let keep = |stroke: &Stroke| {
        let range = stroke.start..stroke.end;
        let (low, high) = guard::range(&x[range.clone()]);
        // A record in one direction has no turn and keeps its ends.
        let margin = if turns { UNSETTLED * travel } else { 0.0 };
        let dense = range.len() >= DENSE;
        let rows = range.filter(|i| {
            let (from_low, from_high) = (x[*i] - low, high - x[*i]);
            let (since, until) = if stroke.rising { (from_low, from_high) } else { (from_high, from_low) };
            since >= margin && (!dense || until >= margin)
        });
        let rows: Vec<(f64, f64)> = rows.map(|i| (x[i], load[i])).collect();
        // The beginning or end of a record may hold the rest of a stroke only.
        (rows.len() >= 3 && high - low > 0.5 * travel).then_some(Used { rising: stroke.rising, rows })
    };
    found.iter().filter_map(keep).collect()
}

fn block(stroke: &Used, middle: f64, half: f64) -> Block {
    let rows: Vec<_> = stroke.rows.iter().map(|(x, load)| ([(x - middle) / half], *load)).collect();
    Block::new(1, &rows)
}

/// Signed slope and what its standard error rests on.
fn stiffness(used: &[Used], middle: f64, half: f64) -> Result<(Estimate, ErrorBasis)> {
    let blocks: Vec<Block> = used.iter().map(|stroke| block(stroke, middle, half)).collect();
    if used.len() >= STROKES_TO_COMPARE {
        let fit = jackknife(&blocks).ok_or(IdentifyError::singular("load and preload"))?;
        return Ok((Estimate::of(&fit, &[(0, 1.0 / half)]), ErrorBasis::Blocks(used.len())));
    }
    let (coefficients, rms) = solve(&blocks).ok_or(IdentifyError::singular("load and preload"))?;
    let slope = coefficients[0] / half;
    // Score of each row: distance from the stroke's mean times residual. And the square sum of the distances.
    let (scores, squares) = loops::scores(used.iter().map(|s| s.rows.as_slice()), slope);
    let rows = scores.len();
    if rows < ROWS_TO_CORRELATE {
        let dof = rows as f64 - 1.0 - used.len() as f64;
        if !(dof >= 1.0) {
            return Err(IdentifyError::too_few("rows", rows, FEWEST_ROWS));
        }
        let variance = rms * rms * rows as f64 / dof / squares;
        return Ok((Estimate::new(slope, variance, dof), ErrorBasis::Independent));
    }
    let window = (WINDOW * rows as f64) as usize;
    let variance = loops::long_run(&scores, window) / (squares * squares);
    Ok((Estimate::new(slope, variance, WINDOW_DOF), ErrorBasis::Autocorrelation(window)))
}

/// Stiffness of the strokes in one direction.
fn one_way(used: &[Used], middle: f64, half: f64, rising: bool) -> Option<f64> {
    let blocks: Vec<Block> =
        used.iter().filter(|s| s.rising == rising).map(|s| block(s, middle, half)).collect();
    solve(&blocks).map(|(coefficients, _)| (coefficients[0] / half).abs())
}

/// Fits a cubic with an offset per stroke.
fn nonlinearity(used: &[Used], middle: f64, half: f64, basis: ErrorBasis) -> Option<Nonlinearity> {
    let blocks: Vec<Block> = used
        .iter()
        .map(|stroke| {
            let cubic = |x: f64| {
                let u = (x - middle) / half;
                [u, u * u, u * u * u]
            };
            let rows: Vec<_> = stroke.rows.iter().map(|(x, load)| (cubic(*x), *load)).collect();
            Block::new(3, &rows)
        })
        .collect();
    let rows: usize = used.iter().map(|stroke| stroke.rows.len()).sum();
    if rows < 8 + used.len() {
        return None;
    }
    let (c, rms) = solve(&blocks)?;
    // Distance of the cubic from the best line through it: u² - 1/3 and u³ - 3u/5 are what no line can follow.
    let distance = |u: f64| (c[1] * (u * u - 1.0 / 3.0) + c[2] * u * (u * u - 0.6)).abs();
    let largest = (-50..=50).map(|i| distance(f64::from(i) / 50.0)).fold(0.0, f64::max);
    let range = 2.0 * c[0].abs();
    let significant = match (basis, jackknife(&blocks)) {
        (ErrorBasis::Blocks(_), Some(fit)) => [1, 2].iter().any(|i| {
            let estimate = Estimate::of(&fit, &[(*i, 1.0)]);
            estimate.deviation(0.0).abs() > 2.0
        }),
        // Without strokes to compare: against the residuals' size.
        _ => largest > 2.0 * rms,
    };
    let tangent = |u: f64| ((c[0] + 2.0 * c[1] * u + 3.0 * c[2] * u * u) / half).abs();
    Some(Nonlinearity {
        percent: 100.0 * largest / range,
        tangent_n_per_m: [tangent(-1.0), tangent(0.0), tangent(1.0)],
        significant,
    })
}

fn concerns(result: &SpringResult, half: f64) -> Vec<String> {
    let mut out = Vec::new();
    let k = result.stiffness_n_per_m;
    if let ErrorBasis::Independent | ErrorBasis::Autocorrelation(_) = result.error_basis {
        let n = result.strokes;
        let strokes = if n == 1 { "stroke" } else { "strokes" };
        out.push(format!(
            "only {n} {strokes}: the standard error comes from {}; four or more strokes tell how well the test repeats",
            result.error_basis
        ));
    }
    match &result.friction_n {
        None => out.push("one direction only: friction cannot be separated from the preload".to_owned()),
        Some(f) if f.deviation(0.0) < -3.0 => out.push(format!(
            "the loop runs backwards (friction {:.2} N): rows out of order, or load delayed against displacement",
            f.value
        )),
        Some(_) => {}
    }
    if let Some(bend) = result.nonlinearity.filter(|b| b.significant && b.percent > NONLINEAR_PERCENT) {
        let [low, middle, high] = bend.tangent_n_per_m;
        out.push(format!(
            "not a straight line: {:.1} % of the load's range, stiffness {low:.0} / {middle:.0} / {high:.0} N/m at low / middle / high displacement; the value is that of the best line over the travel",
            bend.percent
        ));
    }
    // If all of the residual were noise of the displacement, the slope would be low by this much.
    let noise_m = result.residual_rms_n / k.value;
    let bias = k.value * noise_m * noise_m * 3.0 / (half * half);
    if bias > k.standard_error && bias > 1e-4 * k.value {
        out.push(format!(
            "if the scatter is the displacement's, the stiffness reads up to {bias:.0} N/m low"
        ));
    }
    out
}
