//! Arguments of `itpms fleet`: which drives, whose they are, and where the results go.

use std::path::PathBuf;

use super::{EstimatorKind, LogArgs, Regulation, UnitArgs, one_of, positive};

/// Estimate many drives of many cars: a table, a page about the whole fleet, and what failed.
///
/// Each drive's results are those of `itpms estimate --report`, but for the roughness where no --reports are wanted, which is
/// that of the heights known with each row. DIR/fleet.csv (and .parquet) has a row per drive and wheel, DIR/index.html is the overview, DIR/failed.csv lists the files that could not be estimated, and why. What is finished is
/// kept in DIR/drives.jsonl; the same command goes on where it was stopped, and estimates only what is new or changed.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FleetArgs {
    /// Drive logs: names, or patterns in quotes (`**` is any depth of folders). A car's drives are taken in the order of
    /// their names, numbers in them counting as numbers.
    #[arg(required = true, value_name = "GLOB")]
    pub(crate) drives: Vec<PathBuf>,
    /// All drives are of this car; that of ITPMS_VEHICLE unless --vehicle-dir is given.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// A folder with CAR.toml for every car (and CAR.reference where there is one). A drive is that car's in whose folder it
    /// lies (CAR/.../drive.parquet) or whose name its own begins with (CAR_drive.parquet).
    #[arg(long, value_name = "DIR", conflicts_with = "vehicle")]
    pub(crate) vehicle_dir: Option<PathBuf>,
    /// Where the results go.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Drives at a time; as many as there are processors unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// The first S seconds of each car's first drive are driven at placard pressure; later drives start with what that
    /// taught of the car.
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) calibrate_s: Option<f64>,
    /// Instead of each car's first drive, all those whose path fits.
    #[arg(long, value_name = "GLOB", requires = "calibrate_s", value_parser = pattern)]
    pub(crate) calibration_drives: Option<itpms_drive::fleet::Pattern>,
    /// Write a report for every drive, DIR/reports/....html, and link it from the overview.
    #[arg(long)]
    pub(crate) reports: bool,
    /// Write the pressures of every drive, DIR/estimates/....csv.
    #[arg(long)]
    pub(crate) estimates: bool,
    /// Map the roads: roughness in squares of 20 m by all cars, from latitude_deg and longitude_deg, on the page and as DIR/road.geojson; off
    /// unless asked for, as it shows where the cars were.
    #[arg(long)]
    pub(crate) map: bool,
    /// End with exit code 2 if any drive failed.
    #[arg(long)]
    pub(crate) strict: bool,
    /// Which estimator.
    #[arg(long, value_name = "NAME", default_value = EstimatorKind::default().label(), value_parser = one_of(EstimatorKind::ALL, EstimatorKind::label))]
    pub(crate) estimator: EstimatorKind,
    /// Which loss is warned of.
    #[arg(long, value_name = "NAME", default_value = Regulation::default().label(), value_parser = one_of(Regulation::ALL, Regulation::label))]
    pub(crate) regulation: Regulation,
    #[command(flatten)]
    pub(crate) unit: UnitArgs,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Print the summary as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

fn pattern(text: &str) -> Result<itpms_drive::fleet::Pattern, String> {
    text.parse().map_err(|error: itpms_drive::fleet::PatternError| error.to_string())
}

const EXAMPLES: &str = "\
Examples:
  itpms fleet 'logs/**/*.parquet' --vehicle-dir cars --out fleet --reports
  itpms fleet 'logs/*.csv' --vehicle car.toml --out fleet --calibrate-s 600
  itpms fleet 'logs/**/*.csv' --vehicle-dir cars --out fleet --calibrate-s 600 --calibration-drives '**/*first*'

Exit codes: 0 all drives were looked at, those that failed are counted in the last line; 2 the run is impossible, or every
drive failed, or one did and --strict was given; 130 interrupted, what is finished is kept.";
