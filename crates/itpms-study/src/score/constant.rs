//! Efficiency: how much of the information in the signals an estimator uses while nothing changes.
//!
//! Called by the score. The bound for a constant pressure `p` after `t` seconds is `1 / (J(p) t + 1/30²)`, `J` the
//! information per second with the road's level and slope unknown, the second term the estimator's prior. The
//! estimator's prior is nine tenths a normal one of sd 30 kPa about the pressure it starts from and one tenth anywhere;
//! the interface knows no wider one. The bound holds for truths that scatter about the start as the prior says, so
//! every other drive starts 30 kPa above the truth and the rest 30 kPa below: the mean square of the start's error is
//! the prior's variance.

use itpms_core::estimator::EstimatorKind;

use super::ScoreError;
use super::case::{Case, START_SD_KPA};
use super::row::{Column, Goal, Row};
use super::runner::{Runner, Turn};

/// True pressures in kPa.
const PRESSURES_KPA: [f64; 3] = [241.3, 190.0, 140.0];
/// When to look, in s.
const TIMES_S: [f64; 2] = [16.0, 39.0];
/// Bound over mean square error.
const EFFICIENCY: f64 = 0.8;

const EFFICIENCIES: [Column; 2] =
    [Column::new("efficiency_16_s", "at 16 s", 2), Column::new("efficiency_39_s", "at 39 s", 2)];
const ERRORS: [Column; 2] =
    [Column::new("rmse_16_s_kpa", "RMSE 16 s", 2), Column::new("rmse_39_s_kpa", "RMSE 39 s", 2)];
const BOUNDS: [Column; 2] =
    [Column::new("bound_16_s_kpa", "bound 16 s", 2), Column::new("bound_39_s_kpa", "bound 39 s", 2)];

/// The drives of this part, two cases per pressure: started too high, started too low.
pub(super) struct Plan {
    cases: Vec<(Constant, usize)>,
}

struct Constant {
    pressure_kpa: f64,
    /// Started above and below the truth.
    starts: [Case; 2],
}

impl Plan {
    pub(super) fn new(kind: EstimatorKind, drives: usize) -> Result<Self, ScoreError> {
        let constant = |pressure_kpa: f64| {
            let started = |start_kpa| {
                let mut case = Case::paper("paper-drop", kind)?.with_pressure(pressure_kpa, start_kpa)?;
                case.scenario.duration_s = TIMES_S[1];
                Ok::<_, ScoreError>(case)
            };
            let starts = [started(pressure_kpa + START_SD_KPA)?, started(pressure_kpa - START_SD_KPA)?];
            Ok((Constant { pressure_kpa, starts }, drives))
        };
        Ok(Self { cases: PRESSURES_KPA.into_iter().map(constant).collect::<Result<_, ScoreError>>()? })
    }

    pub(super) fn drives(&self) -> u64 {
        self.cases.iter().map(|(_, drives)| *drives as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>, ScoreError> {
        let squares = runner.run(&self.cases, squared_errors)?;
        let mut rows = vec![];
        // Mean square error over bound, of all drives.
        let (mut ratios, mut drives) = ([0.0; 2], 0);
        for ((constant, count), squares) in self.cases.iter().zip(&squares) {
            let bounds = constant.bounds_kpa()?;
            let mean = [0, 1].map(|i| squares.iter().map(|s| s[i]).sum::<f64>() / *count as f64);
            for i in [0, 1] {
                ratios[i] += mean[i] / bounds[i].powi(2) * *count as f64;
            }
            drives += count;
            let mut cells = vec![];
            cells.extend([0, 1].map(|i| EFFICIENCIES[i].plain(bounds[i].powi(2) / mean[i])));
            cells.extend([0, 1].map(|i| ERRORS[i].plain(mean[i].sqrt())));
            cells.extend([0, 1].map(|i| BOUNDS[i].plain(bounds[i])));
            rows.push(Row::new("efficiency", format!("{} kPa", constant.pressure_kpa), *count, cells));
        }
        let together =
            [0, 1].map(|i| EFFICIENCIES[i].judged(drives as f64 / ratios[i], Goal::AtLeast(EFFICIENCY)));
        rows.push(Row::new("efficiency", "all pressures", drives, together.to_vec()));
        Ok(rows)
    }
}

impl Constant {
    /// At [`TIMES_S`].
    fn bounds_kpa(&self) -> Result<[f64; 2], ScoreError> {
        let bound = self.starts[0].bound()?;
        Ok(TIMES_S.map(|t| match &bound {
            Some(bound) => bound.sd_with_prior_kpa(t, self.pressure_kpa, START_SD_KPA),
            None => f64::NAN,
        }))
    }
}

/// Of the last estimate not later than each of [`TIMES_S`].
fn squared_errors(constant: &Constant, turn: Turn) -> Result<[f64; 2], ScoreError> {
    let mut squares = [f64::NAN; 2];
    constant.starts[turn.index % 2].drive(turn.seed, |row, truth, estimate| {
        let error = estimate.pressure_kpa - truth.pressure_kpa;
        for (square, until_s) in squares.iter_mut().zip(TIMES_S) {
            if row.time_s <= until_s {
                *square = error * error;
            }
        }
    })?;
    Ok(squares)
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
