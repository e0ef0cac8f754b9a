//! Arguments of `itpms convert`.

use std::path::PathBuf;

use super::LogArgs;

/// Convert a log into another format; extensions say which.
///
/// CSV, Parquet, MDF4 and MCAP hold the columns of a drive log; of a CAN log with its DBC file MDF4 gets every signal, and between
/// two CAN logs every frame is carried over. Into a CAN log go the columns that the DBC file has signals for, with every
/// row. Names and units are kept; what cannot be carried over is reported.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ConvertArgs {
    /// The log: .csv, .parquet, .mf4, .dat, .mcap, .log, .candump, .asc, .blf, .trc.
    pub(crate) input: PathBuf,
    /// The file to be: .csv, .parquet, .mf4, .mcap, .log, .candump, .asc, .blf.
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Rows say where the car was, too, if the log does (latitude_deg, longitude_deg).
    #[arg(long)]
    pub(crate) positions: bool,
    /// MDF4: not compressed.
    #[arg(long)]
    pub(crate) plain: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms convert drive.csv drive.mf4
  itpms convert drive.mf4 drive.mcap
  itpms convert drive.blf drive.parquet --dbc car.dbc --signals map.toml
  itpms convert drive.asc drive.mf4 --dbc car.dbc
  itpms convert drive.mf4 drive.log --dbc car.dbc --signals map.toml
  itpms convert drive.asc drive.blf";
