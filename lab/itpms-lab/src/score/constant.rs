//! Efficiency: how much of the information in the signals an estimator uses while nothing changes.
//!
//! Called by the score. The bound for a constant pressure `p` after `t` seconds is `1 / (J(p) t + 1/30²)`, `J` the information per second
//! with the road's level and slope unknown, the second term the estimator's prior. The estimator's prior is nine tenths a normal one of sd
//! 30 kPa about the pressure it starts from and one tenth anywhere; the interface knows no wider one. The bound holds for truths that
//! scatter about the start as the prior says, so every other drive starts 30 kPa above the truth and the rest 30 kPa below: the mean square
//! of the start's error is the prior's variance.

use itpms_paper::EstimatorKind;

use super::case::{Case, START_SD_KPA};
use super::row::{Cell, Column, Goal, Row};
use super::stats::Mean;
use crate::runner::{Result, Runner, StudyError, Turn};

const PRESSURES_KPA: [f64; 3] = [241.3, 190.0, 140.0];
const TIMES_S: [f64; 2] = [16.0, 39.0];
/// Bound over mean square error.
const EFFICIENCY: f64 = 0.8;

const EFFICIENCIES: [Column; 2] =
    [Column::new("efficiency_16_s", "at 16 s", 2), Column::new("efficiency_39_s", "at 39 s", 2)];
const STANDARD_ERRORS: [Column; 2] = [
    Column::new("efficiency_16_s_standard_error", "s.e.", 2),
    Column::new("efficiency_39_s_standard_error", "s.e.", 2),
];
const ERRORS: [Column; 2] =
    [Column::new("rmse_16_s_kpa", "RMSE 16 s", 2), Column::new("rmse_39_s_kpa", "RMSE 39 s", 2)];
const BIASES: [Column; 2] =
    [Column::new("bias_16_s_kpa", "bias 16 s", 1), Column::new("bias_39_s_kpa", "bias 39 s", 1)];
const BOUNDS: [Column; 2] =
    [Column::new("bound_16_s_kpa", "bound 16 s", 2), Column::new("bound_39_s_kpa", "bound 39 s", 2)];

/// The drives of this part, two cases per pressure: started too high, started too low.
pub(super) struct Plan {
    cases: Vec<(Constant, usize)>,
}

struct Constant {
    pressure_kpa: f64,
    /// Added to the seeds: every pressure drives roads of its own, so that errors are independent.
    seed_shift: u64,
    starts: [Case; 2],
}

impl Plan {
    pub(super) fn new(kind: EstimatorKind, drives: usize) -> Result<Self> {
        let constant = |(place, pressure_kpa): (usize, f64)| {
            let started = |start_kpa| {
                let mut case = Case::paper("paper-drop", kind)?.with_pressure(pressure_kpa, start_kpa)?;
                case.scenario.duration_s = TIMES_S[1];
                Ok::<_, StudyError>(case)
            };
            let starts = [started(pressure_kpa + START_SD_KPA)?, started(pressure_kpa - START_SD_KPA)?];
            Ok((Constant { pressure_kpa, seed_shift: (place as u64) << 32, starts }, drives))
        };
        Ok(Self { cases: PRESSURES_KPA.into_iter().enumerate().map(constant).collect::<Result<_>>()? })
    }

    pub(super) fn drives(&self) -> u64 {
        self.cases.iter().map(|(_, drives)| *drives as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let errors = runner.run(&self.cases, errors_kpa)?;
        let mut rows = vec![];
        // Square error over bound of every drive, at each of the times.
        let mut ratios = [vec![], vec![]];
        for ((constant, drives), errors) in self.cases.iter().zip(&errors) {
            let bounds = constant.bounds_kpa()?;
            let square = |i: usize| errors.iter().map(|e| e[i] * e[i]).sum::<f64>() / *drives as f64;
            let bias = |i: usize| errors.iter().map(|e| e[i]).sum::<f64>() / *drives as f64;
            let mean = [square(0), square(1)];
            for i in [0, 1] {
                ratios[i].extend(errors.iter().map(|e| (e[i] / bounds[i]).powi(2)));
            }
            let mut cells = vec![];
            cells.extend([0, 1].map(|i| EFFICIENCIES[i].plain(bounds[i].powi(2) / mean[i])));
            cells.extend([0, 1].map(|i| ERRORS[i].plain(mean[i].sqrt())));
            cells.extend([0, 1].map(|i| BIASES[i].plain(bias(i))));
            cells.extend([0, 1].map(|i| BOUNDS[i].plain(bounds[i])));
            let name = format!("{} kPa", constant.pressure_kpa);
            rows.push(Row::new("efficiency", name, constant.starts[0].kind, *drives, cells));
        }
        if let Some((constant, _)) = self.cases.first() {
            let kind = constant.starts[0].kind;
            rows.push(Row::new("efficiency", "all pressures", kind, ratios[0].len(), together(&ratios)));
        }
        Ok(rows)
    }
}

/// Efficiencies over all drives, each with its standard error.
fn together(ratios: &[Vec<f64>; 2]) -> Vec<Cell> {
    let one = |i: usize| {
        let mean = Mean::of(&ratios[i]);
        let efficiency = mean.value.recip();
        let error = efficiency * mean.error / mean.value;
        [EFFICIENCIES[i].judged(efficiency, Goal::AtLeast(EFFICIENCY)), STANDARD_ERRORS[i].plain(error)]
    };
    [one(0), one(1)].concat()
}

impl Constant {
    /// At [`TIMES_S`].
    fn bounds_kpa(&self) -> Result<[f64; 2]> {
        let bound = self.starts[0].bound()?;
        Ok(TIMES_S.map(|t| match &bound {
            Some(bound) => bound.sd_with_prior_kpa(t, self.pressure_kpa, START_SD_KPA),
            None => f64::NAN,
        }))
    }
}

/// Of the last estimate not later than each of [`TIMES_S`].
fn errors_kpa(constant: &Constant, turn: Turn) -> Result<[f64; 2]> {
    let mut errors = [f64::NAN; 2];
    let seed = turn.seed.wrapping_add(constant.seed_shift);
    constant.starts[turn.index % 2].drive(seed, |row, truth, estimate| {
        for (error, until_s) in errors.iter_mut().zip(TIMES_S) {
            if row.time_s <= until_s {
                *error = estimate.pressure_kpa - truth.pressure_kpa;
            }
        }
    })?;
    Ok(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_is_the_papers_drive_with_the_prior() {
        let plan = Plan::new(EstimatorKind::Informed, 2).unwrap();
        let [at_16, at_39] = plan.cases[0].0.bounds_kpa().unwrap();
        // 36 kPa sqrt(s) (stated to the unit in docs/math/bound.md) and the prior's 30 kPa, added as information.
        let by_hand = |t: f64| (t / 36.0f64.powi(2) + 1.0 / 900.0).sqrt().recip();
        assert!((at_16 / by_hand(16.0) - 1.0).abs() < 0.02 && (at_39 / by_hand(39.0) - 1.0).abs() < 0.02);
    }

    #[test]
    fn starts_scatter_about_the_truth_as_the_prior_says() {
        let plan = Plan::new(EstimatorKind::Informed, 2).unwrap();
        for (constant, _) in &plan.cases {
            let starts = constant.starts.each_ref().map(|case| {
                let corner = case.corner().unwrap();
                corner.initial_kpa.unwrap() - constant.pressure_kpa
            });
            assert!((starts[0] - 30.0).abs() < 1e-9 && (starts[1] + 30.0).abs() < 1e-9);
        }
    }
}
