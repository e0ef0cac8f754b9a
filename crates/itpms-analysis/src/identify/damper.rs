//! Damping from sinusoidal excitation at one or several frequencies (paper, Sec. 5.1; docs/math/identification.md, section 2).
//!
//! Called by `itpms lab identify damper`. Force and displacement of a damper or of a whole strut under imposed motion, taken at
//! the same instants; which way either of them counts does not matter. Friction is separated from damping by the
//! shape of the loop and by how force grows from run to run.

use super::blocks::{Block, BlockFit, jackknife};
use super::damper_result::{Consistency, DamperResult, RunResult};
use super::distribution::chi_square_beyond;
use super::estimate::Estimate;
use super::guard::Units;
use super::motion::{Run, SineRecord, runs};
use super::spring::UNSETTLED;
use super::{IdentifyError, Result, doubts};

/// Damping in N s/m beyond which the unit is doubted.
const PLAUSIBLE_N_S_PER_M: (f64, f64) = (10.0, 500_000.0);

/// Share of a stroke after a turn that is left out for a second opinion, and by how many standard errors it must differ.
const STRICTER: f64 = 0.15;
const OTHER_OPINION: f64 = 3.0;

// Regressors: velocity, its size, its sign; then the displacement of each run.
const VELOCITY: usize = 0;
const SIZE: usize = 1;
const SIGN: usize = 2;
const FIRST_DISPLACEMENT: usize = 3;

/// Identifies a damper. `spring_n_per_m` is a spring that works in parallel, already known; it is subtracted, and tells
/// the sign of the force.
pub fn damper(records: &[SineRecord<'_>], spring_n_per_m: Option<f64>, units: Units) -> Result<DamperResult> {
    let runs = runs(records, UNSETTLED, units)?;
    let fastest = runs.iter().map(Run::velocity_m_s).fold(0.0, f64::max);
    let raw = Fit::new(&runs, fastest, 1.0, 0.0)?;
    let opposite = match spring_n_per_m {
        Some(_) => raw.mean_in_phase() < 0.0,
        None => raw.damping().value < 0.0,
    };
    let fit = Fit::new(&runs, fastest, if opposite { -1.0 } else { 1.0 }, spring_n_per_m.unwrap_or(0.0))?;
    let damping = fit.damping();
    check(&damping, units)?;
    let used_rows = fit.used.iter().map(Vec::len).sum();
    let all_rows: usize = records.iter().map(|record| record.time_s.len()).sum();
    let results: Vec<RunResult> = runs.iter().enumerate().map(|(i, run)| fit.run(i, run)).collect();
    let mut result = DamperResult {
        damping_n_s_per_m: damping,
        rising_n_s_per_m: Estimate::of(&fit.joint, &[(VELOCITY, 1.0 / fastest), (SIZE, 1.0 / fastest)]),
        falling_n_s_per_m: Estimate::of(&fit.joint, &[(VELOCITY, 1.0 / fastest), (SIZE, -1.0 / fastest)]),
        friction_n: Estimate::of(&fit.joint, &[(SIGN, 1.0)]),
        consistency: consistency(&results),
        runs: results,
        spring_n_per_m,
        opposite_signs: opposite,
        blocks: fit.blocks,
        rows: used_rows,
        rows_left_out: all_rows - used_rows,
        concerns: Vec::new(),
        used: fit.used,
    };
    result.concerns = doubts::concerns(&result);
    result.concerns.extend(slow_to_turn(records, &result, fastest));
    Ok(result)
}

/// The damping once more from rows farther from the turns: it differs where friction takes long to turn round.
fn slow_to_turn(records: &[SineRecord<'_>], result: &DamperResult, fastest: f64) -> Option<String> {
    let runs = runs(records, STRICTER, Units::Trusted).ok()?;
    let sign = if result.opposite_signs { -1.0 } else { 1.0 };
    let strict = Fit::new(&runs, fastest, sign, result.spring_n_per_m.unwrap_or(0.0)).ok()?.damping();
    let used = result.damping_n_s_per_m;
    // Of an efficient estimate and one of fewer rows, the difference has the difference of their variances (Hausman 1978);
    // the larger one is on the safe side.
    let apart = (strict.value - used.value).abs();
    (apart > OTHER_OPINION * strict.standard_error.max(used.standard_error)).then(|| {
        format!(
            "friction seems slow to turn round: without the first {:.0} % of each stroke the damping is {:.1} ± {:.1} N s/m; take longer strokes",
            100.0 * STRICTER, strict.value, strict.standard_error
        )
    })
}

fn check(damping: &Estimate, units: Units) -> Result<()> {
    let Estimate { value, standard_error, .. } = *damping;
    if !(value.abs() > 3.0 * standard_error) {
        return Err(IdentifyError::no_slope("the damping", damping, "N s/m"));
    }
    if !(value > 0.0) {
        return Err(IdentifyError::Refused(format!(
            "the damping is {value:.1} N s/m with the sign in which the spring pulls back: force_n and displacement_m are not of the same instant, or not of this part"
        )));
    }
    let (lowest, highest) = PLAUSIBLE_N_S_PER_M;
    if units == Units::Trusted || (lowest..=highest).contains(&value) {
        return Ok(());
    }
    let hint = if value < lowest { "; the force looks like kN" } else { "; is the displacement in m?" };
    Err(IdentifyError::unit("the damping", (value, "N s/m"), "10 to 500 000 N s/m", hint))
}

/// All runs together, and each alone.
struct Fit {
    joint: BlockFit,
    alone: Vec<BlockFit>,
    fastest: f64,
    sign: f64,
    spring: f64,
    blocks: usize,
    used: Vec<Vec<[f64; 4]>>,
}

impl Fit {
    /// Force times `sign`, less a spring, over velocity and displacement.
    fn new(runs: &[Run], fastest: f64, sign: f64, spring: f64) -> Result<Self> {
        let singular = || IdentifyError::singular("damping and friction");
        let width = FIRST_DISPLACEMENT + runs.len();
        let mut alone = Vec::new();
        let mut joint = Vec::new();
        for (i, run) in runs.iter().enumerate() {
            let row = |x: f64, v: f64| [v / fastest, v.abs() / fastest, v.signum(), x / run.amplitude_m()];
            let target = |x: f64, force: f64| sign * force - spring * x;
            let blocks: Vec<Block> = run
                .blocks
                .iter()
                .map(|rows| {
                    let rows: Vec<_> = rows.iter().map(|r| (row(r.x, r.v), target(r.x, r.force))).collect();
                    Block::new(4, &rows)
                })
                .collect();
            let fit = jackknife(&blocks).ok_or_else(singular)?;
            // Runs weigh by their noise.
            let weight = 1.0 / (fit.residual_rms * fit.residual_rms).max(f64::MIN_POSITIVE);
            for rows in &run.blocks {
                let rows: Vec<_> = rows
                    .iter()
                    .map(|r| {
                        let [velocity, size, sign, x] = row(r.x, r.v);
                        let mut wide = vec![0.0; width];
                        wide[..FIRST_DISPLACEMENT].copy_from_slice(&[velocity, size, sign]);
                        wide[FIRST_DISPLACEMENT + i] = x;
                        (wide, target(r.x, r.force))
                    })
                    .collect();
                joint.push(Block::new(width, &rows).weighted(weight));
            }
            alone.push(fit);
        }
        let blocks = joint.len();
        let joint = jackknife(&joint).ok_or_else(singular)?;
        let mut fit = Self { joint, alone, fastest, sign, spring, blocks, used: Vec::new() };
        fit.used = runs.iter().enumerate().map(|(i, run)| fit.residuals(i, run)).collect();
        Ok(fit)
    }

    fn damping(&self) -> Estimate {
        Estimate::of(&self.joint, &[(VELOCITY, 1.0 / self.fastest)])
    }

    /// Mean over the runs of the force in phase with a displacement of one amplitude.
    fn mean_in_phase(&self) -> f64 {
        let n = self.alone.len();
        (0..n).map(|i| self.joint.coefficients[FIRST_DISPLACEMENT + i]).sum::<f64>() / n as f64
    }

    /// Displacement, velocity, force and residual of a run's rows about the joint fit.
    fn residuals(&self, index: usize, run: &Run) -> Vec<[f64; 4]> {
        let c = &self.joint.coefficients;
        let mut out = Vec::new();
        for rows in &run.blocks {
            let from = out.len();
            for r in rows {
                let fitted = c[VELOCITY] * r.v / self.fastest
                    + c[SIZE] * r.v.abs() / self.fastest
                    + c[SIGN] * r.v.signum()
                    + c[FIRST_DISPLACEMENT + index] * r.x / run.amplitude_m();
                let force = self.sign * r.force;
                out.push([r.x, r.v, force, force - self.spring * r.x - fitted]);
            }
            // Each block has an offset of its own.
            let mean = out[from..].iter().map(|r: &[f64; 4]| r[3]).sum::<f64>() / rows.len() as f64;
            out[from..].iter_mut().for_each(|r| r[3] -= mean);
        }
        out
    }

    fn run(&self, index: usize, run: &Run) -> RunResult {
        let fit = &self.alone[index];
        RunResult {
            record: run.record.clone(),
            frequency_hz: run.frequency_hz(),
            amplitude_m: run.amplitude_m(),
            velocity_m_s: run.velocity_m_s(),
            periods: run.periods,
            damping_n_s_per_m: Estimate::of(fit, &[(VELOCITY, 1.0 / self.fastest)]),
            friction_n: Estimate::of(fit, &[(SIGN, 1.0)]),
            equivalent_n_s_per_m: self.sign * run.equivalent_n_s_per_m,
            in_phase_n_per_m: Estimate::of(fit, &[(3, 1.0 / run.amplitude_m())]),
            residual_rms_n: fit.residual_rms,
            distortion: run.sine.residual_rms / run.amplitude_m(),
        }
    }
}

fn chi_square(estimates: impl Iterator<Item = Estimate> + Clone) -> f64 {
    let weight = |e: &Estimate| e.standard_error.powi(-2);
    let (sum, weights) = estimates
        .clone()
        .fold((0.0, 0.0), |(sum, weights), e| (sum + e.value * weight(&e), weights + weight(&e)));
    estimates.map(|e| e.deviation(sum / weights).powi(2)).sum()
}

fn consistency(runs: &[RunResult]) -> Option<Consistency> {
    if runs.len() < 2 {
        return None;
    }
    let degrees_of_freedom = runs.len() - 1;
    let chi = chi_square(runs.iter().map(|run| run.damping_n_s_per_m));
    let friction = chi_square(runs.iter().map(|run| run.friction_n));
    let p = |chi: f64| chi_square_beyond(chi, degrees_of_freedom as f64);
    Some(Consistency {
        chi_square: chi,
        friction_chi_square: friction,
        degrees_of_freedom,
        p: p(chi),
        friction_p: p(friction),
    })
}
