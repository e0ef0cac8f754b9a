//! Arguments of `itpms lab observability`.

use std::path::PathBuf;

use itpms_console::options::{Jobs, one_of};
use itpms_core::model::Corner;

/// What the accelerations of a corner can tell of its tire, and what they cannot.
///
/// Two tires that give the same measurement, the rank with the road unknown, and the least error any estimator could
/// have (Cramer-Rao) with each source of information alone and together, over time, speed, damping and noise.
#[derive(Debug, clap::Args)]
#[command(after_help = OBSERVABILITY_EXAMPLES)]
pub(crate) struct ObservabilityArgs {
    /// Masses, springs, dampers and tires of the corners.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// Which corner: fl, fr, rl or rr; the vehicle's first unless given.
    #[arg(long, value_name = "C", value_parser = one_of(Corner::ALL, Corner::label))]
    pub(crate) corner: Option<Corner>,
    /// Where a page, figures (SVG), tables (CSV) and everything as JSON go.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const OBSERVABILITY_EXAMPLES: &str = "\
Examples:
  itpms lab observability --vehicle car.toml
  itpms lab observability --vehicle car.toml --corner rl --out why";
