//! The `itpms-lab` command: studies of the estimator, for those who work on it.
#![forbid(unsafe_code)]

mod args;
mod commands;

use std::process::ExitCode;

use args::{Args, Study};
use clap::Parser as _;
use itpms_console::{Failure, Interrupt, Screen};

fn main() -> ExitCode {
    let args = Args::parse();
    let screen = Screen::new(args.speaking, std::env::args_os());
    screen.end(Interrupt::install().and_then(|interrupt| run(&args, &screen, &interrupt)))
}

fn run(args: &Args, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    if let Some(path) = &args.tuning {
        let _first = itpms_lab::tuning::set(itpms_data::tuning::read(path)?);
    }
    match &args.study {
        Study::Score(args) => commands::score::run(args, screen, interrupt),
        Study::Soak(args) => commands::soak::run(args, screen, interrupt),
        Study::Certify(args) => commands::certify::run(args, screen, interrupt),
        Study::Malfunctions(args) => commands::malfunctions::run(args, screen, interrupt),
        Study::Observability(args) => commands::observability::run(args, screen, interrupt),
        Study::Reproduce(args) => commands::reproduce::run(args, screen, interrupt),
        Study::Faults(args) => commands::faults::run(args, screen, interrupt),
        Study::Completions(args) => {
            let mut script = Vec::new();
            clap_complete::generate(args.shell, &mut Args::shown(), "itpms-lab", &mut script);
            screen.write(&script);
            Ok(())
        }
    }
}
