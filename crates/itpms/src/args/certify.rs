//! What can be typed after `itpms lab certify`.

use std::path::PathBuf;

use super::Jobs;

/// Drive the test procedures of UN R141 Annex 3 and FMVSS 138 S6 in simulation: pass or fail, with times against the limits.
///
/// Every wheel, every combination of wheels that a regulation names, every sensor unplugged; with --quick one test of each
/// kind. A test that fails is marked and is no error: the exit code is 0. A simulation is no type approval.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CertifyArgs {
    /// One test of each kind instead of all.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Only tests whose names contain TEXT.
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Seed of the first test's course; the others follow.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Where a page with all tests and their pressures goes: .html, complete in itself.
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Where the page, its figures (SVG), the pressures over time (CSV) and everything as JSON go.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
    /// Print the tests with their names and limits, and drive nothing.
    #[arg(long, conflicts_with_all = ["json", "report", "out"])]
    pub(crate) list: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms lab certify --quick
  itpms lab certify --report certify.html
  itpms lab certify --only un-r141-puncture --seed 7 --out punctures";
