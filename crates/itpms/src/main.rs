//! The `itpms` command: arguments in, files and a few lines of text out. No mathematics.
//!
//! | module | idea |
//! |---|---|
//! | `args` | what can be typed |
//! | `commands` | one file per command |
#![forbid(unsafe_code)]

mod args;
mod commands;

use std::process::ExitCode;

use args::{Args, Command, Lab, Tool};
use itpms_console::{Failure, Interrupt, Screen};
use itpms_data::tuning::Tuning;

fn main() -> ExitCode {
    let args = Args::read();
    let screen = Screen::new(args.speaking, std::env::args_os());
    screen.end(Interrupt::install().and_then(|interrupt| run(&args.command, &screen, &interrupt)))
}

fn run(command: &Command, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    match command {
        Command::Demo(args) => commands::demo::run(args, screen, interrupt),
        Command::Estimate(args) => commands::estimate::run(args, screen, interrupt),
        Command::Fleet(args) => commands::fleet::run(args, screen, interrupt),
        #[cfg(feature = "live")]
        Command::Monitor(args) => commands::monitor::run(args, screen, interrupt),
        Command::Roughness(args) => commands::roughness::run(args, screen, interrupt),
        Command::Convert(args) => commands::convert::run(args, screen, interrupt),
        Command::Signals(args) => commands::signals::run(args, screen, interrupt),
        Command::Plot(args) => commands::plot::run(args, screen, interrupt),
        Command::Vehicle(args) => commands::vehicle::run(&args.part, screen, interrupt),
        #[cfg(feature = "fmu")]
        Command::Fmu(args) => commands::fmu::run(args, screen),
        Command::Completions(args) => commands::completions::run(args, screen),
        Command::Man(args) => commands::man::run(args, screen),
        Command::Tool(tool) => run_tool(tool, screen, interrupt),
        Command::Study(study) => commands::lab::run(study, screen),
        Command::Lab(lab) => match &lab.tool {
            Lab::Tool(tool) => run_tool(tool, screen, interrupt),
            Lab::Study(study) => commands::lab::run(study, screen),
        },
    }
}

fn run_tool(tool: &Tool, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    match tool {
        Tool::Simulate(args) => commands::simulate::run(args, screen, interrupt),
        Tool::Identify(args) => commands::identify::run(&args.part, screen),
        Tool::Calibrate(args) => commands::identify::run_calibrate(args, screen),
        Tool::Tuning => {
            screen.write(itpms_data::tuning::text(&Tuning::default()).as_bytes());
            Ok(())
        }
    }
}
