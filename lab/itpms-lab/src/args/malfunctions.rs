//! Arguments of `itpms lab malfunctions`.

use itpms_console::options::{Jobs, Strict};

/// Put every malfunction of the sensors into many everyday drives: is it reported in time, is no wrong pressure shown, does the
/// monitor come back; and is nothing reported on the same drives without.
///
/// The same seeds give the same figures. A malfunction that is reported late is marked; the exit code is 0 unless --strict is given.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MalfunctionsArgs {
    /// Drives per malfunction.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) drives: u32,
    /// Seed of the first drive; the others follow.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) first_seed: u64,
    /// Only malfunctions whose names contain TEXT.
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    #[command(flatten)]
    pub(crate) strict: Strict,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
    /// Print JSON: version, drives, first_seed, rows and what was reported without a malfunction.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms lab malfunctions
  itpms lab malfunctions --drives 5 --only swapped --json";
