//! Arguments of what is said and asked about one's own car.

use std::path::PathBuf;

use clap::Subcommand;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use itpms_data::vehicle::typical::{CarClass, TireSize};

use super::{LogArgs, positive};

/// The parameters of one's own car: a file of typical values, what a file says, and whether a drive agrees.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms vehicle init --mass 1500 --front-share 0.55 --tire 205/55R16 -o car.toml
  itpms vehicle show car.toml
  itpms vehicle check drive.csv --vehicle car.toml --report check.html")]
pub(crate) struct VehicleArgs {
    #[command(subcommand)]
    pub(crate) part: VehiclePart,
}

#[derive(Debug, Subcommand)]
pub(crate) enum VehiclePart {
    Init(InitArgs),
    Show(ShowArgs),
    Check(CheckArgs),
}

/// Write a vehicle file of typical values, each with its standard deviation and its source.
///
/// Masses, springs and dampers are those of other cars of the class, the tire's stiffness that of its size. The file is
/// good enough to begin with; what is measured replaces it line by line (docs/vehicle.md).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms vehicle init --mass 1500 --front-share 0.55 --tire 205/55R16 -o car.toml
  itpms vehicle init --mass 2100 --front-share 0.5 --tire 235/60R18 --class suv --placard-kpa 250 --wheelbase-m 2.87 -o suv.toml")]
pub(crate) struct InitArgs {
    /// Mass ready to drive, from the registration papers.
    #[arg(long, value_name = "KG", value_parser = positive)]
    pub(crate) mass: f64,
    /// Share of the mass that rests on the front axle: some 0.6 with the engine in front driving the front wheels, 0.5 to
    /// 0.55 otherwise.
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    pub(crate) front_share: f64,
    /// Size as on the sidewall, such as 205/55R16.
    #[arg(long, value_name = "SIZE")]
    pub(crate) tire: TireSize,
    /// Kind of car.
    #[arg(long, value_name = "CLASS", default_value = CarClass::default().label(), value_parser = classes())]
    pub(crate) class: CarClass,
    /// Pressure on the placard.
    #[arg(long, value_name = "KPA", default_value_t = 240.0, value_parser = positive)]
    pub(crate) placard_kpa: f64,
    /// Distance between the axles; typical of the class unless given. Worth measuring: front and rear are compared over it.
    #[arg(long, value_name = "M", value_parser = positive)]
    pub(crate) wheelbase_m: Option<f64>,
    /// What the car is called.
    #[arg(long, value_name = "TEXT")]
    pub(crate) name: Option<String>,
    /// Where the file goes; printed unless given.
    #[arg(short, long, value_name = "V.toml")]
    pub(crate) output: Option<PathBuf>,
}

fn classes() -> impl clap::builder::TypedValueParser<Value = CarClass> {
    PossibleValuesParser::new(CarClass::ALL.map(CarClass::label))
        .map(|label| CarClass::from_label(&label).unwrap_or_default())
}

/// Show what a vehicle file says: parameters, standard deviations, and what follows from them.
///
/// Frequencies and damping ratios of body and wheel hop, the tire's stiffness at placard pressure, and by how many kPa a
/// pressure is misread where the unsprung mass is wrong by one per cent.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms vehicle show car.toml")]
pub(crate) struct ShowArgs {
    /// The vehicle file.
    #[arg(value_name = "V.toml")]
    pub(crate) file: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Compare how the body answers each wheel in a drive with what the vehicle file says of spring and damper.
///
/// A sentence per corner: what fits, what does not, and what to change. Needs half a minute of rough enough road; neither
/// road nor tire nor unsprung mass enter.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms vehicle check drive.csv --vehicle car.toml --report check.html")]
pub(crate) struct CheckArgs {
    /// The drive log: .csv, .parquet, .mf4, or a CAN log (.log, .candump, .asc, .blf) with --dbc.
    pub(crate) log: PathBuf,
    /// Masses, springs, dampers and tires of the corners.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// Where a page with a picture per corner goes: .html, complete in itself.
    #[arg(long, value_name = "HTML")]
    pub(crate) report: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
