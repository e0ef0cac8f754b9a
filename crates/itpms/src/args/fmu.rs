//! Arguments of `itpms fmu`.

use std::path::PathBuf;

use super::VEHICLE;

use clap::ValueEnum;

/// Write a functional mock-up unit (FMU) of a vehicle for simulation tools: co-simulation, FMI 2.0 or 3.0.
///
/// With every step it takes accelerations, speed and wheel speeds, and gives pressures, states and warnings. Its shared library is for
/// the system that this program runs on.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms fmu --vehicle car.toml -o itpms.fmu")]
pub(crate) struct FmuArgs {
    /// Masses, springs, dampers and tires of the corners; goes into the unit.
    #[arg(long, value_name = "V.toml", env = VEHICLE, hide_env_values = true)]
    pub(crate) vehicle: PathBuf,
    /// Where the unit goes.
    #[arg(short, long, value_name = "UNIT.fmu")]
    pub(crate) output: PathBuf,
    /// Version of the standard.
    #[arg(long, value_name = "VERSION", value_enum, default_value = "2")]
    pub(crate) fmi: FmiVersion,
    /// Samples a second: a tool takes steps of this length unless stated otherwise.
    #[arg(long, value_name = "HZ", default_value_t = 500.0)]
    pub(crate) rate_hz: f64,
    /// The shared library; else it is looked for beside this program.
    #[arg(long, value_name = "PATH")]
    pub(crate) library: Option<PathBuf>,
}

/// A version of the standard.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum FmiVersion {
    /// FMI 2.0.
    #[value(name = "2")]
    Two,
    /// FMI 3.0.
    #[value(name = "3")]
    Three,
}
