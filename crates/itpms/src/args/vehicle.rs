//! Arguments of the commands about one's own car.

use std::path::PathBuf;

use clap::Subcommand;
use itpms_console::options::one_of;
use itpms_core::model::Corner;
use itpms_data::vehicle::Driven;
use itpms_data::vehicle::typical::{CarClass, FrontRear, TireSize};
use itpms_drive::field::KnownFrom;

use super::{LogArgs, VEHICLE, positive};

/// The parameters of one's own car: a file of typical values, what a file says, and whether a drive agrees.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms vehicle init --mass 1500 --front-share 0.55 --tire 205/55R16 -o car.toml
  itpms vehicle show car.toml
  itpms vehicle learn calibration.csv --pressure-kpa 240 --from car.toml -o learned.toml
  itpms vehicle check drive.csv --vehicle car.toml --report check.html")]
pub(crate) struct VehicleArgs {
    #[command(subcommand)]
    pub(crate) part: VehiclePart,
}

#[derive(Debug, Subcommand)]
pub(crate) enum VehiclePart {
    Init(InitArgs),
    Show(ShowArgs),
    Learn(LearnArgs),
    Check(CheckArgs),
}

/// Write a vehicle file of typical values, each with its standard deviation and its source.
///
/// Masses, springs and dampers are those of other cars of the class, the tire's stiffness that of its size. The file is
/// good enough to begin with; what is measured replaces it line by line (docs/vehicle.md). Dampers and load are judged better, or not at
/// all, with spring_stiffening_per_m, gross_axle_kg, level_control and adaptive_dampers in the vehicle table.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms vehicle init --mass 1500 --front-share 0.55 --tire 205/55R16 -o car.toml
  itpms vehicle init --tire 205/55R16 --wheelbase-m 2.66 --driven front -o wheels.toml
  itpms vehicle init --mass 2100 --front-share 0.5 --tire 235/60R18 --class suv --placard-kpa 250 --wheelbase-m 2.87 -o suv.toml")]
pub(crate) struct InitArgs {
    /// Mass ready to drive, from the registration papers. Without it the file is for wheel speeds alone.
    #[arg(long, value_name = "KG", value_parser = positive)]
    pub(crate) mass: Option<f64>,
    /// Share of the mass that rests on the front axle: some 0.6 with the engine in front driving the front wheels, 0.5 to
    /// 0.55 otherwise.
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    pub(crate) front_share: Option<f64>,
    /// Size as on the sidewall, such as 205/55R16; front and rear: 225/45R18,255/40R18.
    #[arg(long, value_name = "SIZE[,SIZE]")]
    pub(crate) tire: Option<FrontRear<TireSize>>,
    /// Kind of car.
    #[arg(long, value_name = "CLASS", default_value = CarClass::default().label(), value_parser = one_of(CarClass::ALL, CarClass::label))]
    pub(crate) class: CarClass,
    /// Pressure on the placard; front and rear: 230,260.
    #[arg(long, value_name = "KPA[,KPA]", default_value = "240", value_parser = placard)]
    pub(crate) placard_kpa: FrontRear<f64>,
    /// Distance between the axles; typical of the class unless given. Worth measuring: front and rear are compared over it.
    #[arg(long, value_name = "M", value_parser = positive)]
    pub(crate) wheelbase_m: Option<f64>,
    /// Which wheels are driven; for wheel speeds.
    #[arg(long, value_name = "AXLE", value_parser = one_of(Driven::ALL, Driven::label))]
    pub(crate) driven: Option<Driven>,
    /// Whether the wheels of a driven axle are coupled: a limited-slip or locked differential; for wheel speeds.
    #[arg(long)]
    pub(crate) limited_slip: bool,
    /// Distance between the front wheels; typical unless given; for wheel speeds.
    #[arg(long, value_name = "M", value_parser = positive)]
    pub(crate) track_front_m: Option<f64>,
    /// Distance between the rear wheels.
    #[arg(long, value_name = "M", value_parser = positive)]
    pub(crate) track_rear_m: Option<f64>,
    /// What the car is called.
    #[arg(long, value_name = "TEXT")]
    pub(crate) name: Option<String>,
    /// Where the file goes; printed unless given.
    #[arg(short, long, value_name = "V.toml")]
    pub(crate) output: Option<PathBuf>,
}

fn placard(text: &str) -> Result<FrontRear<f64>, String> {
    FrontRear::read(text, positive).map_err(|error| format!("{error}, or two of them: front,rear"))
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

/// Learn a vehicle file's parameters from drives whose pressures are known.
///
/// Ten minutes at an even pace teach unsprung mass against tire, dampers, springs and friction; a second drive with the same tires at another pressure (180
/// and 240 kPa) how stiffness goes with pressure. Every value is weighed against the file's own standard deviation; what no drive
/// can tell stays the file's and is named (docs/vehicle.md).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms vehicle learn calibration.csv --pressure-kpa 240 --from car.toml -o learned.toml
  itpms vehicle learn soft.csv hard.csv --pressure-kpa 180 --pressure-kpa 240 --from car.toml -o learned.toml
  itpms vehicle learn drive.csv --pressure-kpa fl=240,fr=240,rl=220,rr=220 --from car.toml -o learned.toml")]
pub(crate) struct LearnArgs {
    /// Drive logs, each at pressures that were measured: as for estimate.
    #[arg(required = true, value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    /// Pressure of the tires while driving, gauge: one for all wheels or one for each; once, or once per log. Without it, what the
    /// tires' own sensors send in the log.
    #[arg(long, value_name = "KPA|fl=KPA,...")]
    pub(crate) pressure_kpa: Vec<KnownPressures>,
    /// The vehicle file to begin with; that of --output unless given.
    #[arg(long, value_name = "V.toml")]
    pub(crate) from: Option<PathBuf>,
    /// Where the learned vehicle file goes.
    #[arg(short, long, value_name = "V.toml")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Pressures of a drive in kPa, in the order of the corners; as far as they were given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KnownPressures(pub(crate) [Option<f64>; 4]);

impl std::str::FromStr for KnownPressures {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("found {text:?}, expected kPa such as 240 or fl=240,fr=240,rl=220,rr=220");
        let kpa = |text: &str| match positive(text) {
            Ok(kpa) => itpms_drive::learn::no_pressure(kpa).map_or(Ok(kpa), Err),
            Err(_) => Err(expected()),
        };
        if !text.contains('=') {
            return Ok(Self([Some(kpa(text)?); 4]));
        }
        let mut pressures = [None; 4];
        for part in text.split(',') {
            let (label, value) = part.split_once('=').ok_or_else(expected)?;
            let corner = Corner::ALL.into_iter().find(|c| c.label() == label.trim()).ok_or_else(expected)?;
            pressures[corner.index()] = Some(kpa(value.trim())?);
        }
        Ok(Self(pressures))
    }
}

/// Compare how the body answers each wheel in a drive with what the vehicle file says of spring and damper.
///
/// A sentence per corner: what fits, what does not, and what to change; one per axle: whether its dampers are alike. Needs half a minute of
/// rough enough road; neither road nor tire nor unsprung mass enter. With --field: whether a log of twenty minutes with three known
/// pressures is good enough to be handed on, and the archive to hand on (docs/field-kit.md).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  itpms vehicle check drive.csv --vehicle car.toml --report check.html
  itpms vehicle check drive.csv --vehicle car.toml --field --pressure-kpa 240 --pressure-kpa 480:fl=200 --pressure-kpa 900:fl=160 -o car.zip

Exit code with --field: 0 good enough, 1 not.")]
pub(crate) struct CheckArgs {
    /// The drive log: .csv, .parquet, .mf4, .dat, .mcap, or a CAN log (.log, .asc, .blf, .trc, .mf4) with --dbc.
    pub(crate) log: PathBuf,
    /// Masses, springs, dampers and tires of the corners.
    #[arg(long, value_name = "V.toml", env = VEHICLE, hide_env_values = true)]
    pub(crate) vehicle: PathBuf,
    /// Where a page with a picture per corner goes: .html, complete in itself.
    #[arg(long, value_name = "HTML", conflicts_with = "field")]
    pub(crate) report: Option<PathBuf>,
    /// Whether the log is good enough for the field kit: sensors, rate, length, stops, clipping, known pressures.
    #[arg(long)]
    pub(crate) field: bool,
    /// What the gauge read, from so many seconds since the log's first row on: 240, then 480:fl=200. Tires that are not named keep theirs.
    #[arg(long, value_name = "[FROM_S:]KPA|fl=KPA,...", requires = "field")]
    pub(crate) pressure_kpa: Vec<KnownFrom>,
    /// For the archive: sensors, where they are mounted, road, weather.
    #[arg(long, value_name = "TEXT", requires = "field")]
    pub(crate) note: Option<String>,
    /// Where the archive goes if the log is good enough: without position, altitude and identification number.
    #[arg(short, long, value_name = "PACK.zip", requires = "field")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
