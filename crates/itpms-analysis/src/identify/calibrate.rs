//! The pressure-stiffness line of a tire from a table of tire tests (paper, eq. 5, Table 1, Fig. 3;
//! docs/math/identification.md, section 3).
//!
//! Called by `itpms lab calibrate`. The regression itself is the core's; here it is held against its assumptions: is the line
//! straight, does a row stand out, do repeats scatter as the line says.

use itpms_core::model::{PressureMap, RegressionError};
use serde::Serialize;

use super::blocks::{Block, solve};
use super::distribution::{f_beyond, t_quantile};
use super::guard::{self, Units, plain};
use super::{IdentifyError, Result};

/// Rows needed for a line with a standard error.
const FEWEST_ROWS: usize = 3;
/// Probability below which a test raises a concern.
const SUSPICIOUS: f64 = 0.01;

/// A tire's line with everything that judges it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibration {
    /// The line, ready for a vehicle file.
    #[serde(skip)]
    pub map: PressureMap<f64>,
    pub stiffness_per_kpa: Coefficient,
    pub stiffness_at_zero: Coefficient,
    pub correlation: f64,
    pub r_squared: f64,
    pub residual_sd_n_per_m: f64,
    pub residual_sd_kpa: f64,
    pub pressures: usize,
    /// The table with its residuals, in the order of the file.
    pub rows: Vec<CalibrationRow>,
    /// Whether the means of repeats lie on the line; `None` without repeats or with two pressures.
    pub lack_of_fit: Option<Test>,
    /// Whether a parabola fits better; `None` for fewer than four pressures.
    pub curvature: Option<Test>,
    /// Reservations about the line.
    pub concerns: Vec<String>,
}

/// A coefficient with its ordinary standard error and its 95 % interval (Student's t).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coefficient {
    pub value: f64,
    pub standard_error: f64,
    /// Low and high end of the 95 % interval.
    pub interval_95: (f64, f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CalibrationRow {
    pub pressure_kpa: f64,
    pub stiffness_n_per_m: f64,
    pub fitted_n_per_m: f64,
    /// Half the width in N/m of the line's 95 % confidence band there.
    pub band_95_n_per_m: f64,
    /// Measured less fitted, in N/m.
    pub residual_n_per_m: f64,
    /// The residual over its standard deviation, had the row not taken part in the line. `None` where all others are exactly on a line.
    pub studentized: Option<f64>,
}

/// A test statistic and the probability of a larger one if nothing were wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Test {
    pub f: f64,
    /// Degrees of freedom, upper and lower.
    pub degrees_of_freedom: (f64, f64),
    pub p: f64,
}

impl Test {
    fn new(f: f64, upper: f64, lower: f64) -> Self {
        Self { f, degrees_of_freedom: (upper, lower), p: f_beyond(f, upper, lower) }
    }
}

/// Fits a tire's line to gauge pressures in kPa and stiffnesses in N/m; a pressure may be there several times.
pub fn calibrate(pressure_kpa: &[f64], stiffness_n_per_m: &[f64], units: Units) -> Result<Calibration> {
    let (p, k) = (pressure_kpa, stiffness_n_per_m);
    guard::pair(("pressure_kpa", p), ("stiffness_n_per_m", k))?;
    guard::at_least("rows", p.len(), FEWEST_ROWS)?;
    guard::varies("pressure_kpa", p)?;
    check_columns(p, k, units)?;
    let (map, r_squared) = PressureMap::regression(p, k).map_err(|error| refusal(error, p, k))?;
    check_slope(map.stiffness_per_kpa(), units)?;
    if !(map.stiffness_at_zero() >= 0.0) {
        let (value, standard_error) = (map.stiffness_at_zero(), map.stiffness_at_zero_sd());
        return Err(IdentifyError::Refused(format!(
            "the line meets zero pressure at {value:.0} ± {standard_error:.0} N/m, expected zero or more: measure over more pressures"
        )));
    }
    let dof = p.len() as f64 - 2.0;
    let rows = rows(&map, p, k);
    let squares: f64 = rows.iter().map(|row| row.residual_n_per_m.powi(2)).sum();
    let residual_sd = (squares / dof).sqrt();
    let coefficient = |value: f64, standard_error: f64| {
        let half = t_quantile(0.05, dof) * standard_error;
        Coefficient { value, standard_error, interval_95: (value - half, value + half) }
    };
    let groups = groups(p, k);
    let mut result = Calibration {
        stiffness_per_kpa: coefficient(map.stiffness_per_kpa(), map.stiffness_per_kpa_sd()),
        stiffness_at_zero: coefficient(map.stiffness_at_zero(), map.stiffness_at_zero_sd()),
        correlation: map.stiffness_correlation(),
        r_squared,
        residual_sd_n_per_m: residual_sd,
        residual_sd_kpa: residual_sd / map.stiffness_per_kpa(),
        pressures: groups.len(),
        lack_of_fit: lack_of_fit(&groups, squares),
        curvature: (groups.len() >= 4).then(|| curvature(p, k, squares)).flatten(),
        rows,
        concerns: Vec::new(),
        map,
    };
    result.concerns = concerns(&result);
    Ok(result)
}

impl Calibration {
    /// Half the width in N/m of the 95 % confidence band of the line at a pressure in kPa.
    pub fn band_95_n_per_m(&self, pressure_kpa: f64) -> f64 {
        band(&self.map, t_of_band(self.rows.len()), pressure_kpa)
    }
}

/// Student's t of the 95 % band.
fn t_of_band(rows: usize) -> f64 {
    t_quantile(0.05, rows as f64 - 2.0)
}

/// `t` is that of [`t_of_band`]: dear enough not to be computed for every row.
fn band(map: &PressureMap<f64>, t: f64, pressure_kpa: f64) -> f64 {
    t * map.map_sd_kpa(pressure_kpa) * map.stiffness_per_kpa()
}

fn refusal(error: RegressionError, p: &[f64], k: &[f64]) -> IdentifyError {
    match error {
        RegressionError::NotIncreasing(value) => {
            let n = p.len() as f64;
            let mean = p.iter().sum::<f64>() / n;
            let s_pp: f64 = p.iter().map(|p| (p - mean).powi(2)).sum();
            let k_mean = k.iter().sum::<f64>() / n;
            let squares: f64 = p.iter().zip(k).map(|(p, k)| (k - k_mean - value * (p - mean)).powi(2)).sum();
            let standard_error = (squares / (n - 2.0) / s_pp).sqrt();
            IdentifyError::Refused(format!(
                "stiffness falls with pressure ({value:.1} ± {standard_error:.1} N/m per kPa), expected it to rise"
            ))
        }
        // All else was looked at before.
        _ => IdentifyError::constant("pressure_kpa", p),
    }
}

fn check_columns(p: &[f64], k: &[f64], units: Units) -> Result<()> {
    if units == Units::Trusted {
        return Ok(());
    }
    let (lowest, highest) = guard::range(p);
    let hint = match highest {
        _ if lowest < 0.0 => Some("; gauge pressures are not negative"),
        h if h < 10.0 => Some("; it looks like bar"),
        h if h < 80.0 => Some("; it looks like psi (1 psi is 6.895 kPa)"),
        h if h > 2_000.0 => Some("; it looks like Pa or mbar"),
        _ => None,
    };
    if let Some(hint) = hint {
        let found = format!("{} to {} kPa", plain(lowest), plain(highest));
        return Err(IdentifyError::units("pressure_kpa", &found, "80 to 2000 kPa at its highest", hint));
    }
    let (lowest, highest) = guard::range(k);
    let hint = match () {
        () if !(lowest > 0.0) => Some("; a stiffness is positive"),
        () if highest < 10_000.0 => Some("; it looks like N/mm or kN/m"),
        () if lowest > 20_000_000.0 => Some("; it looks like N/m times a thousand"),
        () => None,
    };
    let found = format!("{} to {} N/m", plain(lowest), plain(highest));
    let refused = |hint| IdentifyError::units("stiffness_n_per_m", &found, "10 000 to 20 000 000 N/m", hint);
    hint.map_or(Ok(()), |hint| Err(refused(hint)))
}

/// A vehicle file takes 20 to 20 000 N/m per kPa.
fn check_slope(slope: f64, units: Units) -> Result<()> {
    if units == Units::Trusted || (20.0..=20_000.0).contains(&slope) {
        return Ok(());
    }
    Err(IdentifyError::unit("the slope", (slope, "N/m per kPa"), "20 to 20 000 N/m per kPa", ""))
}

/// Different pressures with their stiffnesses, from low to high.
fn groups(p: &[f64], k: &[f64]) -> Vec<(f64, Vec<f64>)> {
    let mut pairs: Vec<(f64, f64)> = p.iter().copied().zip(k.iter().copied()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<(f64, Vec<f64>)> = Vec::new();
    for (p, k) in pairs {
        match out.last_mut() {
            Some((pressure, values)) if *pressure == p => values.push(k),
            _ => out.push((p, vec![k])),
        }
    }
    out
}

fn rows(map: &PressureMap<f64>, p: &[f64], k: &[f64]) -> Vec<CalibrationRow> {
    let n = p.len() as f64;
    let mean = p.iter().sum::<f64>() / n;
    let s_pp: f64 = p.iter().map(|p| (p - mean).powi(2)).sum();
    let residual = |p: f64, k: f64| k - map.stiffness_n_per_m(p);
    let squares: f64 = p.iter().zip(k).map(|(p, k)| residual(*p, *k).powi(2)).sum();
    let t = t_of_band(p.len());
    let row = |(p, k): (&f64, &f64)| {
        let e = residual(*p, *k);
        let leverage = 1.0 / n + (p - mean).powi(2) / s_pp;
        // Variance of the others about their own line.
        let others = (squares - e * e / (1.0 - leverage)) / (n - 3.0);
        let studentized = e / (others * (1.0 - leverage)).sqrt();
        CalibrationRow {
            pressure_kpa: *p,
            stiffness_n_per_m: *k,
            fitted_n_per_m: map.stiffness_n_per_m(*p),
            band_95_n_per_m: band(map, t, *p),
            residual_n_per_m: e,
            studentized: studentized.is_finite().then_some(studentized),
        }
    };
    p.iter().zip(k).map(row).collect()
}

/// Scatter of the means about the line over scatter of the repeats about their means.
fn lack_of_fit(groups: &[(f64, Vec<f64>)], squares: f64) -> Option<Test> {
    let pure: f64 = groups
        .iter()
        .map(|(_, values)| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.iter().map(|k| (k - mean).powi(2)).sum::<f64>()
        })
        .sum();
    let rows: usize = groups.iter().map(|(_, values)| values.len()).sum();
    let (upper, lower) = (groups.len() as f64 - 2.0, (rows - groups.len()) as f64);
    if !(upper >= 1.0 && lower >= 1.0 && pure > 0.0) {
        return None;
    }
    Some(Test::new(((squares - pure) / upper).max(0.0) / (pure / lower), upper, lower))
}

/// F statistic of the quadratic term.
fn curvature(p: &[f64], k: &[f64], squares: f64) -> Option<Test> {
    let (low, high) = guard::range(p);
    let rows: Vec<_> = p
        .iter()
        .zip(k)
        .map(|(p, k)| {
            let u = (2.0 * p - low - high) / (high - low);
            ([u, u * u], *k)
        })
        .collect();
    let n = p.len() as f64;
    let (_, rms) = solve(&[Block::new(2, &rows)])?;
    let (left, dof) = (rms * rms * n, n - 3.0);
    (dof >= 1.0 && left > 0.0).then(|| Test::new(((squares - left) / (left / dof)).max(0.0), 1.0, dof))
}

fn concerns(result: &Calibration) -> Vec<String> {
    let mut out = Vec::new();
    let n = result.rows.len();
    if n == FEWEST_ROWS {
        out.push("three rows leave one degree of freedom: the standard errors mean little".to_owned());
    }
    if result.pressures == 2 {
        out.push("two pressures only: nothing shows whether the line is straight".to_owned());
    }
    if let Some(test) = result.lack_of_fit.filter(|test| test.p < SUSPICIOUS) {
        out.push(format!(
            "the means of the repeats miss the line by more than repeats scatter (p = {:.2e}): the standard errors are too small",
            test.p
        ));
    }
    if let Some(test) = result.curvature.filter(|test| test.p < SUSPICIOUS) {
        out.push(format!(
            "a parabola fits better than a line (p = {:.2e}): do not extrapolate beyond the pressures measured",
            test.p
        ));
    }
    // Bonferroni: any of n rows.
    let farthest = if n >= 5 { t_quantile(SUSPICIOUS / n as f64, n as f64 - 3.0) } else { f64::INFINITY };
    for (i, row) in result.rows.iter().enumerate() {
        let Some(t) = row.studentized else { continue };
        if t.abs() > farthest {
            out.push(format!(
                "row {} ({} kPa, {} N/m) stands out: {t:.1} standard deviations from the line of the others",
                i + 1,
                row.pressure_kpa,
                row.stiffness_n_per_m
            ));
        }
    }
    out
}
