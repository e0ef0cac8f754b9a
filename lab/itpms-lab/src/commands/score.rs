//! `itpms lab score`: how good an estimator is over many drives, held against the goals.

use std::time::Instant;

use itpms_console::{Failure, Interrupt, Screen, threads};
use itpms_lab::score::row::Verdict;
use itpms_lab::score::{Part, Request, score};

use super::{driven, json};
use crate::args::ScoreArgs;

/// Drives per row of `--quick`, and cars of the row `own`.
const QUICK_SEEDS: usize = 3;
const QUICK_CARS: usize = 5;

pub(crate) fn run(args: &ScoreArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let request = Request {
        seeds: match (args.quick, args.row) {
            (true, Some(Part::Own)) => QUICK_CARS,
            (true, _) => QUICK_SEEDS,
            (false, _) => args.seeds as usize,
        },
        first_seed: args.first_seed,
        estimators: args.estimator.kinds(),
        part: args.row,
        only: args.only.clone(),
        wheel_speeds: args.wheel_speeds,
    };
    let began = Instant::now();
    let score = driven(screen, interrupt, |look| score(&request, look))?;
    if args.json {
        screen.print_lines(json(&score)?);
    } else {
        screen.print_lines(score.table().trim_end());
    }
    if args.row == Some(Part::Own) {
        let core_s = began.elapsed().as_secs_f64() * rayon::current_num_threads() as f64;
        screen.remark(format!(
            "{:.1} core-seconds a car, if no one else was at work",
            core_s / request.seeds as f64
        ));
    }
    if args.row.is_none() {
        screen.remark(
            "by themselves: --row own (an owner's whole path), detection (how soon a loss is warned of), ablation and disturbances, car (cars that are not their files); false warnings: itpms lab soak",
        );
    }
    let missed = score.rows.iter().filter(|row| row.verdict == Some(Verdict::Missed)).count();
    args.strict.judge(missed, "rows that miss a goal")
}
