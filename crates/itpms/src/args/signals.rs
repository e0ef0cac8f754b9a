//! Arguments of `itpms signals`.

use std::path::PathBuf;

use itpms_data::log::Selection;

/// What is in a log: every signal with its rate and range, and which column of a drive log it would be.
///
/// CAN logs (.log, .asc, .blf, .trc, frames in .mf4) are decoded with --dbc; without it identifiers and their rates are listed. CSV and
/// Parquet: every column. MDF4: every channel that holds numbers. The log is read once, from beginning to end.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SignalsArgs {
    /// A CAN log, an MDF4 file, CSV or Parquet.
    pub(crate) log: PathBuf,
    /// CAN logs: what the frames mean.
    #[arg(long, value_name = "CAR.dbc")]
    pub(crate) dbc: Option<PathBuf>,
    /// Which signal is which column, where the names do not say it.
    #[arg(long, value_name = "MAP.toml")]
    pub(crate) signals: Option<PathBuf>,
    /// Tables: only rows that have this value in a column, or in a key of a folder's parts.
    #[arg(id = "where", long = "where", value_name = "COLUMN=VALUE")]
    pub(crate) rows: Vec<Selection>,
    /// Where the mapping that was found goes, as a map to start from.
    #[arg(long, value_name = "MAP.toml")]
    pub(crate) write_map: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms signals drive.log --dbc car.dbc
  itpms signals drive.mf4 --write-map map.toml
  itpms signals drive.blf --dbc car.dbc --signals map.toml --json";
