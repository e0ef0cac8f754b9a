//! Arguments of `itpms plot`.

use std::path::PathBuf;

use super::LogArgs;

/// Look at a log before there is a vehicle file: signals over time, spectra, coherence of body and wheel.
///
/// One page, complete in itself, with statistics of every signal and what looks wrong: body and wheel exchanged, a body that
/// follows another wheel, gravity, ranges that are too small, coarse steps, missing values, gaps.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct PlotArgs {
    /// The drive log: .csv, .parquet, .mf4, .dat, .mcap, or a CAN log (.log, .asc, .blf, .trc, .mf4) with --dbc.
    pub(crate) log: PathBuf,
    /// Where the page goes; the log's name with -plot.html in this folder unless given.
    #[arg(short, long, value_name = "HTML")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Print statistics and what looks wrong as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms plot drive.csv
  itpms plot drive.mf4 --signals map.toml -o drive.html
  itpms plot drive.blf --dbc car.dbc --json";
