//! Arguments of what is identified on a bench.

use std::path::PathBuf;

use clap::Subcommand;

use super::positive;

/// Identify a spring or a damper from bench measurements, with standard errors.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms identify spring load-displacement.csv --plot spring.svg
  itpms identify damper sine.csv --plot damper.svg")]
pub(crate) struct IdentifyArgs {
    #[command(subcommand)]
    pub(crate) part: IdentifyPart,
}

#[derive(Debug, Subcommand)]
pub(crate) enum IdentifyPart {
    Spring(SpringArgs),
    Damper(DamperArgs),
}

/// Stiffness ks from load and displacement, friction separated.
///
/// Columns displacement_m and load_n, in the order in which they were measured; load and unload slowly, best four or more
/// strokes. Which way either of them counts does not matter.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms identify spring load-displacement.csv --plot spring.svg")]
pub(crate) struct SpringArgs {
    /// The measurement: .csv.
    #[arg(value_name = "LOAD_DISPLACEMENT")]
    pub(crate) table: PathBuf,
    #[command(flatten)]
    pub(crate) output: BenchOutput,
}

/// Damping cs from sinusoidal excitation at one or several frequencies, friction separated.
///
/// Columns time_s, displacement_m and force_n of a damper or a strut under imposed motion, taken at the same instants.
/// Several frequencies may follow each other in one file, be told apart by a column run, or come as several files.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms identify damper sine.csv --plot damper.svg
  itpms identify damper 1hz.csv 2hz.csv 4hz.csv --json
  itpms identify damper strut.csv --spring 20663")]
pub(crate) struct DamperArgs {
    /// The measurements: .csv.
    #[arg(value_name = "SINE", required = true)]
    pub(crate) tables: Vec<PathBuf>,
    /// A known spring beside the damper; subtracted, and its pull tells the sign of the force.
    #[arg(long, value_name = "N_PER_M", value_parser = positive)]
    pub(crate) spring: Option<f64>,
    #[command(flatten)]
    pub(crate) output: BenchOutput,
}

/// Fit a tire's stiffness over pressure, with its confidence band, and write the tire table of a vehicle file.
///
/// Columns pressure_kpa and stiffness_n_per_m; a pressure may be there several times.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms calibrate tire-tests.csv -o tire.toml --plot residuals.svg")]
pub(crate) struct CalibrateArgs {
    /// The tire tests: .csv.
    pub(crate) table: PathBuf,
    /// Where the tire table goes; printed unless given.
    #[arg(short = 'o', long = "output", value_name = "TIRE.toml")]
    pub(crate) tire: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: BenchOutput,
}

/// What becomes of a result.
#[derive(Debug, clap::Args)]
pub(crate) struct BenchOutput {
    /// Where a figure of data, fit and residuals goes: .svg.
    #[arg(long, value_name = "SVG")]
    pub(crate) plot: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Take the columns in the units of their names even if they do not look like it.
    #[arg(long)]
    pub(crate) trust_units: bool,
}
