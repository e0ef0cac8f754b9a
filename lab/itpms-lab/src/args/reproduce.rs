//! Arguments of `itpms lab reproduce`: how many drives, and what the paper leaves open.

use std::path::PathBuf;

use itpms_console::options::{Jobs, positive};

/// Drives per case with `--quick`, and without.
const QUICK: u32 = 8;
const USUAL: u32 = 40;

/// Make the paper's study again: every figure and table, from our own drives, beside the paper's numbers.
///
/// Writes index.html, complete in itself, and beside it each figure as SVG and the data of each figure and table as CSV
/// and JSON. The same options give the same bytes.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ReproduceArgs {
    /// Where the page and its files go.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Drives per case; 40 unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    seeds: Option<u32>,
    /// Only 8 drives per case, unless --seeds says how many.
    #[arg(long)]
    quick: bool,
    /// Seed of the first drive, which is the one that is drawn; the others follow.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) first_seed: u64,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
    /// Sampling rate of the simulation study. The paper does not say it, nor any of the following.
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, value_parser = positive)]
    pub(crate) rate: f64,
    /// Accelerometer noise of the simulation study, rms per sample.
    #[arg(long, value_name = "M_S2", default_value_t = 0.05, value_parser = positive)]
    pub(crate) noise: f64,
    /// Level Gd(n0) of the road in m^3: 16e-6 is class A of ISO 8608, 64e-6 class B.
    #[arg(long, value_name = "M3", default_value_t = 16e-6, value_parser = positive)]
    pub(crate) road: f64,
    /// Sampling rate of the test bed.
    #[arg(long, value_name = "HZ", default_value_t = 500.0, value_parser = positive)]
    pub(crate) bench_rate: f64,
    /// Unsprung mass of the test bed.
    #[arg(long, value_name = "KG", default_value_t = 56.9, value_parser = positive)]
    pub(crate) bench_unsprung_mass: f64,
    /// Natural frequency of the test bed's hydraulic actuator.
    #[arg(long, value_name = "HZ", default_value_t = 30.0, value_parser = positive)]
    pub(crate) bench_actuator: f64,
}

impl ReproduceArgs {
    /// Drives per case.
    pub(crate) fn drives(&self) -> usize {
        self.seeds.unwrap_or(if self.quick { QUICK } else { USUAL }) as usize
    }
}

const EXAMPLES: &str = "\
Examples:
  itpms lab reproduce --out study
  itpms lab reproduce --out study --quick --noise 0.3
  itpms lab reproduce --out study --seeds 100 --first-seed 1000";
