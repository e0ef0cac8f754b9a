//! `itpms lab malfunctions`: sensors that go wrong in many drives, and what the monitor says of it.

use itpms_console::{Failure, Interrupt, Screen, threads};
use itpms_lab::malfunction::{Request, study};

use super::{driven, json};
use crate::args::MalfunctionsArgs;

pub(crate) fn run(args: &MalfunctionsArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let request =
        Request { drives: args.drives as usize, first_seed: args.first_seed, only: args.only.clone() };
    let study = driven(screen, interrupt, |look| study(&request, look))?;
    if args.json {
        screen.print_lines(json(&study)?);
    } else {
        screen.print_lines(study.table().trim_end());
    }
    args.strict.judge(study.marked(), "rows that are marked")
}
