//! `itpms lab malfunctions`: sensors that go wrong in many drives, and what the monitor says of it.

use itpms_console::{Failure, Interrupt, Screen, threads};
use itpms_lab::malfunction::{MalfunctionError, Request, study};

use crate::args::MalfunctionsArgs;

pub(crate) fn run(args: &MalfunctionsArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let request =
        Request { drives: args.drives as usize, first_seed: args.first_seed, only: args.only.clone() };
    let progress = screen.progress("driving");
    let look = |done: u64, total: u64| {
        progress.set(done as f64 / total as f64);
        interrupt.flow()
    };
    let result = study(&request, &look);
    drop(progress);
    let study = result.map_err(|error| match error {
        MalfunctionError::Stopped => Failure::Interrupted,
        MalfunctionError::Scenario(scenario) => Failure::Scenario(scenario),
        other => Failure::Usage(other.to_string()),
    })?;
    if args.json {
        let json = serde_json::to_string_pretty(&study);
        screen.print_lines(json.map_err(|error| Failure::Usage(format!("the study is no JSON: {error}")))?);
    } else {
        screen.print_lines(study.table().trim_end());
    }
    args.strict.judge(study.marked(), "rows that are marked")
}
