//! Arguments of `itpms lab faults`.

use std::path::PathBuf;

use itpms_console::options::Jobs;

/// Make things go wrong around a monitor and a calibration, and count what is lost.
///
/// Programs killed while they save, full disks, files with every byte changed, brokers that go and return, a silent bus, clocks
/// that jump. Works in a folder of its own that is gone afterwards. Exit code 2 if anything was lost.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FaultsArgs {
    /// How often each fault is tried, in percent of the usual: 10 is quick.
    #[arg(long, value_name = "PERCENT", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) effort: u32,
    /// Seed of the moments.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Only faults whose names contain TEXT.
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
    /// Print JSON: version, seed, faults of name, tried, lost, found.
    #[arg(long)]
    pub(crate) json: bool,
    /// The program that is killed: saves the two files in turn under the name of the third.
    #[arg(long, num_args = 4, value_names = ["KIND", "A", "B", "TARGET"], hide = true)]
    pub(crate) victim: Option<Vec<PathBuf>>,
}

const EXAMPLES: &str = "\
Examples:
  itpms lab faults
  itpms lab faults --effort 10 --only killed --json";
