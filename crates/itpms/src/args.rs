//! What can be typed after `itpms`. Names are part of the contract with scripts.

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use clap_complete::Shell;

/// Indirect tire pressure monitoring: tire pressure and road from the accelerations of a car's body and wheels.
#[derive(Debug, Parser)]
#[command(name = "itpms", version, max_term_width = 100, after_help = EXAMPLES)]
pub(crate) struct Args {
    /// No progress bars and no remarks on standard error; errors and warnings stay.
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXAMPLES: &str = "\
Examples:
  itpms simulate paper-drop --seed 1 -o drive.csv --vehicle-out car.toml

Exit codes: 0 complete; 2 an input, option or output is unusable (one message says why); 130 interrupted.
Outputs are written beside their target and renamed when complete: no partial file is ever left.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Simulate(SimulateArgs),
    Completions(CompletionsArgs),
}

/// Simulate a drive and write its log, with the true pressure and road beside the measurements.
#[derive(Debug, clap::Args)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub(crate) struct SimulateArgs {
    /// A built-in scenario or a TOML file. An unknown name lists the built-in ones.
    pub(crate) scenario: String,
    /// Seed of the road, the sensors' noise and losses: the same seed gives the same drive.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) seed: u64,
    /// Where the log goes: .csv or .parquet.
    #[arg(short, long, value_name = "LOG")]
    pub(crate) output: PathBuf,
    /// Drive this vehicle instead of the scenario's own.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// Also write the vehicle file that belongs to the log.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle_out: Option<PathBuf>,
    /// Leave the true pressure and road out of the log.
    #[arg(long)]
    pub(crate) no_truth: bool,
    /// Print what was written as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const SIMULATE_EXAMPLES: &str = "\
Examples:
  itpms simulate paper-drop --seed 7 -o drive.csv
  itpms simulate drive-puncture --seed 1 -o drive.parquet --vehicle-out car.toml
  itpms simulate my-scenario.toml -o drive.csv --vehicle my-car.toml";

/// Print a completion script for a shell.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms completions bash > ~/.local/share/bash-completion/completions/itpms")]
pub(crate) struct CompletionsArgs {
    /// Which shell.
    pub(crate) shell: Shell,
}
