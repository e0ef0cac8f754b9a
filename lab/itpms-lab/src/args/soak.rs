//! Arguments of `itpms lab soak`: how many hours of which drives, and where they are kept.

use std::path::PathBuf;

use itpms_console::options::{one_of, positive};
use itpms_lab::sensors::Sensors;
use itpms_lab::soak::Car;
use itpms_sim::wheel_speeds::Condition;

/// Drive for many simulated hours in which nothing is wrong, and count what the monitor says.
///
/// Each hour of drive-normal is composed from its seed and driven by another car (bodies, tires and sensors within
/// tolerances). Finished hours are appended to DIR/hours.jsonl, one line of JSON each; the same command goes on where it
/// was stopped, however it was stopped. At the end they are added up, also into DIR/summary.json.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SoakArgs {
    /// Hours in all, those of earlier runs included; a million drives at most.
    #[arg(long, value_name = "H", default_value_t = 1000.0, value_parser = positive)]
    pub(crate) hours: f64,
    /// Where the hours are kept.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Samples per second of the accelerations.
    #[arg(long, value_name = "HZ", default_value_t = 200.0, value_parser = positive)]
    pub(crate) rate: f64,
    /// Length of a drive; what is not finished when the run is stopped is driven again.
    #[arg(long, value_name = "S", default_value_t = 3600.0, value_parser = positive)]
    pub(crate) drive_s: f64,
    /// Seed of the first drive; the others follow.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) first_seed: u64,
    /// Drives at a time; as many as there are processors unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Whether every seed drives another car, all the one of the scenario, or every seed four other quarter cars that no body
    /// joins.
    #[arg(long, value_name = "CAR", default_value = Car::Varied.label(), value_parser = one_of(Car::ALL, Car::label))]
    pub(crate) car: Car,
    /// Calibrate for so long at the beginning of every drive; never unless given.
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) calibrate_s: Option<f64>,
    /// What the cars have. On wheel speeds alone every seed has another bus, tires warm up, and each drive begins with a calibration
    /// of ten minutes unless given.
    #[arg(long, value_name = "SENSORS", default_value = Sensors::default().label(), value_parser = one_of(Sensors::ALL, Sensors::label))]
    pub(crate) sensors: Sensors,
    /// On wheel speeds alone: calibrate on a day of its own and drive on a later one, with roads, weather, loads and distance drawn
    /// from the seed.
    #[arg(long, value_name = "CONDITION", value_parser = one_of(Condition::ALL, Condition::label))]
    pub(crate) condition: Option<Condition>,
    /// Let tires of every drive lose this share of their pressure, other ones with every seed.
    #[arg(long, value_name = "SHARE", value_parser = positive, requires = "condition")]
    pub(crate) lose: Option<f64>,
    /// Give every car a yaw rate with a fault, the next one with every seed.
    #[arg(long, requires = "condition")]
    pub(crate) bad_yaw: bool,
    /// Print the sums as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms lab soak --hours 1000 --out soak
  itpms lab soak --hours 2 --out soak --first-seed 5000 --jobs 1
  itpms lab soak --hours 200 --out rolling --sensors wheel-speeds
  itpms lab soak --hours 100 --out days --sensors wheel-speeds --condition mixed
  itpms lab soak --hours 40 --drive-s 2400 --out lost --sensors wheel-speeds --condition mixed --lose 0.25";
