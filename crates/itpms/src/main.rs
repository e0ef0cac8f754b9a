//! The `itpms` command: arguments in, files and a few lines of text out. No mathematics.
//!
//! | module | idea |
//! |---|---|
//! | `args` | what can be typed |
//! | `commands` | one file per command |
//! | `interrupt` | Ctrl-C and a polite kill end a run between two rows |
//! | `progress` | a bar on a terminal, nothing in a file or pipe |
//! | `screen` | results on standard output, remarks on standard error |
//! | `threads` | on how many threads the work is done |
//! | `exit` | why a command ends, and the code for it |
#![forbid(unsafe_code)]

mod args;
mod commands;
mod exit;
mod interrupt;
mod progress;
mod screen;
mod threads;

use std::process::ExitCode;

use args::{Args, Command, Lab, Study};
use exit::Failure;
use interrupt::Interrupt;
use screen::Screen;

fn main() -> ExitCode {
    let args = Args::read();
    let screen = Screen::new(args.quiet, std::env::args_os());
    let result = Interrupt::install().and_then(|interrupt| match &args.command {
        Command::Demo(args) => commands::demo::run(args, &screen, &interrupt),
        Command::Estimate(args) => commands::estimate::run(args, &screen, &interrupt),
        Command::Fleet(args) => commands::fleet::run(args, &screen, &interrupt),
        #[cfg(feature = "live")]
        Command::Monitor(args) => commands::monitor::run(args, &screen, &interrupt),
        Command::Roughness(args) => commands::roughness::run(args, &screen, &interrupt),
        Command::Convert(args) => commands::convert::run(args, &screen, &interrupt),
        Command::Signals(args) => commands::signals::run(args, &screen, &interrupt),
        Command::Plot(args) => commands::plot::run(args, &screen, &interrupt),
        Command::Vehicle(args) => commands::vehicle::run(&args.part, &screen, &interrupt),
        #[cfg(feature = "fmu")]
        Command::Fmu(args) => commands::fmu::run(args, &screen),
        Command::Completions(args) => commands::completions::run(args, &screen),
        Command::Study(study) => run_study(study, &screen, &interrupt),
        Command::Lab(lab) => match &lab.tool {
            Lab::Study(study) => run_study(study, &screen, &interrupt),
            #[cfg(feature = "live")]
            Lab::Faults(args) => commands::lab::faults::run(args, &screen, &interrupt),
        },
    });
    match result.and_then(|()| screen.check()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            screen.error(&failure);
            failure.code()
        }
    }
}

fn run_study(study: &Study, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    match study {
        Study::Simulate(args) => commands::simulate::run(args, screen, interrupt),
        Study::Score(args) => commands::score::run(args, screen, interrupt),
        Study::Soak(args) => commands::soak::run(args, screen, interrupt),
        Study::Certify(args) => commands::certify::run(args, screen, interrupt),
        Study::Malfunctions(args) => commands::malfunctions::run(args, screen, interrupt),
        Study::Identify(args) => commands::identify::run(&args.part, screen),
        Study::Calibrate(args) => commands::identify::run_calibrate(args, screen),
        Study::Observability(args) => commands::observability::run(args, screen, interrupt),
        Study::Reproduce(args) => commands::reproduce::run(args, screen, interrupt),
    }
}
