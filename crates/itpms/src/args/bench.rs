//! Arguments of identification on a bench.

use std::path::PathBuf;

use clap::Subcommand;

use super::positive;

/// Identify a spring or a damper from bench measurements, or a whole corner from a drop, with standard errors.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms lab identify spring load-displacement.csv --plot spring.svg
  itpms lab identify damper sine.csv --plot damper.svg
  itpms lab identify bump drop.csv --sprung-mass-kg 366 --unsprung-mass-kg 47 --plot drop.svg")]
pub(crate) struct IdentifyArgs {
    #[command(subcommand)]
    pub(crate) part: IdentifyPart,
}

#[derive(Debug, Subcommand)]
pub(crate) enum IdentifyPart {
    Spring(SpringArgs),
    Damper(DamperArgs),
    Bump(BumpArgs),
}

/// Spring, damper, friction, wheel hop and tire of each corner from one drop or bump.
///
/// A car let down off a block, a body let go on its springs, a rig: body and wheel then swing freely over a road at rest.
/// Columns time_s and per corner c of fl fr rl rr either heights {c}_body_m and {c}_wheel_m or accelerations
/// {c}_body_accel_m_s2 and {c}_wheel_accel_m_s2, up positive, at one rate of 100 Hz or more.
#[derive(Debug, clap::Args)]
#[command(after_help = BUMP_EXAMPLES)]
pub(crate) struct BumpArgs {
    /// The record: .csv or .parquet.
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// Sprung mass of one corner. Without the masses there are frequencies and damping ratios, but no spring and no tire.
    #[arg(long, value_name = "KG", value_parser = positive, requires = "unsprung_mass_kg")]
    pub(crate) sprung_mass_kg: Option<f64>,
    /// Unsprung mass of one corner.
    #[arg(long, value_name = "KG", value_parser = positive, requires = "sprung_mass_kg")]
    pub(crate) unsprung_mass_kg: Option<f64>,
    /// Use the motion from this time, where the beginning that is found is not the right one.
    #[arg(long, value_name = "S")]
    pub(crate) from_s: Option<f64>,
    /// Use the motion until this time.
    #[arg(long, value_name = "S")]
    pub(crate) until_s: Option<f64>,
    /// Where a figure of motion, fit and residuals goes: .svg.
    #[arg(long, value_name = "SVG")]
    pub(crate) plot: Option<PathBuf>,
    /// Print JSON: corners and axles by label, each number with its standard error under the same key and _se.
    #[arg(long)]
    pub(crate) json: bool,
}

const BUMP_EXAMPLES: &str = "\
Examples:
  itpms lab identify bump drop.csv
  itpms lab identify bump drop.parquet --sprung-mass-kg 366 --unsprung-mass-kg 47 --plot drop.svg
  itpms lab identify bump drop.csv --sprung-mass-kg 366 --unsprung-mass-kg 47 --json";

/// Stiffness ks from load and displacement, friction separated.
///
/// Columns displacement_m and load_n, in the order in which they were measured; load and unload slowly, best four or more
/// strokes. Which way either of them counts does not matter.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms lab identify spring load-displacement.csv --plot spring.svg")]
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
/// Several frequencies may follow each other in one file, be distinguished by a column run, or come as several files.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms lab identify damper sine.csv --plot damper.svg
  itpms lab identify damper 1hz.csv 2hz.csv 4hz.csv --json
  itpms lab identify damper strut.csv --spring 20663")]
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
#[command(after_help = "Example: itpms lab calibrate tire-tests.csv -o tire.toml --plot residuals.svg")]
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
