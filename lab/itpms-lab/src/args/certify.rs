//! Arguments of `itpms lab certify`.

use std::path::PathBuf;

use itpms_console::options::{Jobs, Strict, one_of};
use itpms_lab::certify::StatedLoads;
use itpms_lab::sensors::Sensors;

/// Drive the test procedures of UN R141 Annex 3 and FMVSS 138 S6 in simulation: pass or fail, with times against the limits.
///
/// Every wheel, every combination of wheels that a regulation names, every sensor unplugged; with --quick one test of each
/// kind. A test that fails is marked; the exit code is 0 unless --strict is given. A simulation is no type approval.
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
    /// What the car has. On wheel speeds, alone or with their tooth pulses, no sensor is unplugged, and every combination of tires is let down for both regulations.
    #[arg(long, value_name = "SENSORS", default_value = Sensors::default().label(), value_parser = one_of(Sensors::ALL, Sensors::label))]
    pub(crate) sensors: Sensors,
    /// What a car with wheel speeds alone knows of its loads while it stands.
    #[arg(long, value_name = "LOADS", default_value = StatedLoads::default().label(), value_parser = one_of(StatedLoads::ALL, StatedLoads::label))]
    pub(crate) loads: StatedLoads,
    /// How often each test is driven, each time by another car on another road.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) repeats: u32,
    /// Where a page with all tests and their pressures goes: .html, complete in itself.
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Where the page, its figures (SVG), the pressures over time (CSV) and everything as JSON go.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) strict: Strict,
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
  itpms lab certify --only un-r141-puncture --seed 7 --out punctures
  itpms lab certify --sensors wheel-speeds --loads constant --repeats 6";
