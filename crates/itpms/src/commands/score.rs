//! `itpms lab score`: how good an estimator is over many drives, held against the goals.

use itpms_study::score::{Request, ScoreError, score};

use crate::args::ScoreArgs;
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;
use crate::threads;

/// Drives per row of `--quick`.
const QUICK_SEEDS: usize = 3;

pub(crate) fn run(args: &ScoreArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let request = Request {
        seeds: if args.quick { QUICK_SEEDS } else { args.seeds as usize },
        first_seed: args.first_seed,
        estimators: args.estimator.kinds(),
        part: args.row,
        only: args.only.clone(),
    };
    let progress = screen.progress("driving");
    let look = |done: u64, total: u64| {
        progress.set(done as f64 / total as f64);
        interrupt.flow()
    };
    let result = score(&request, &look);
    drop(progress);
    let score = result.map_err(|error| match error {
        ScoreError::Stopped => Failure::Interrupted,
        other => Failure::Usage(other.to_string()),
    })?;
    if args.json {
        let json = serde_json::to_string_pretty(&score);
        screen.print_lines(json.map_err(|error| Failure::Usage(format!("the score is no JSON: {error}")))?);
    } else {
        screen.print_lines(score.table().trim_end());
    }
    if args.row.is_none() {
        screen.remark(
            "by themselves: --row detection (how soon a loss is warned of), ablation and disturbances, car (cars that are not their files); false warnings: itpms lab soak",
        );
    }
    Ok(())
}
