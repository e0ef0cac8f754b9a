//! Arguments of `itpms roughness`.

use std::path::PathBuf;

use super::{LogArgs, positive};

/// How rough a road is: International Roughness Index, ISO 8608 class, level and slope, per track and segment.
///
/// From a profile: OpenCRG (.crg), or text or Parquet with distance_m and height_m, or left_height_m and right_height_m, or
/// what estimate --road-out wrote; without a header two columns are distance and height, three are distance, left and
/// right. Or from a drive, with --vehicle: then
/// the road under every wheel is estimated first, and its holes and bumps are listed. A segment with too little road says so instead of a number.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RoughnessArgs {
    /// A road profile (.crg, .parquet, or text), or a drive log with --vehicle.
    pub(crate) input: PathBuf,
    /// The input is a drive log of this vehicle.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// Length of a segment in m, 5 or more; a road that is shorter is one segment.
    #[arg(long, value_name = "M", default_value_t = 100.0, value_parser = positive)]
    pub(crate) segment_m: f64,
    /// OpenCRG: where the left and the right track lie beside the reference line in m, left positive; one for one track.
    #[arg(
        long,
        value_name = "LEFT,RIGHT",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_values_t = [0.75, -0.75]
    )]
    pub(crate) lateral_m: Vec<f64>,
    /// Drive log: the speed in m/s where the log has none.
    #[arg(long, value_name = "V", value_parser = positive, requires = "vehicle")]
    pub(crate) speed_m_s: Option<f64>,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Drive log: where the map goes, as GeoJSON: a line per segment, a point per hole or bump. The log says where the car was
    /// (latitude_deg, longitude_deg); that is written here and nowhere else.
    #[arg(long, value_name = "ROAD.geojson", requires = "vehicle")]
    pub(crate) geojson: Option<PathBuf>,
    /// Drive log: where the same map goes as a page that asks nothing of a network (.html).
    #[arg(long, value_name = "ROAD.html", requires = "vehicle")]
    pub(crate) map: Option<PathBuf>,
    /// Where the table goes: .csv, a row per segment and track.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms roughness survey.csv
  itpms roughness road.crg --segment-m 20 --lateral-m 0.8,-0.7 -o roughness.csv
  itpms roughness drive.csv --vehicle car.toml --json
  itpms roughness drive.csv --vehicle car.toml --geojson road.geojson --map road.html";
