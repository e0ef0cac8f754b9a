//! Arguments of `itpms`. Names are part of the contract with scripts.

mod bench;
mod convert;
mod fleet;
#[cfg(feature = "fmu")]
mod fmu;
mod lab;
mod log;
#[cfg(feature = "live")]
mod monitor;
mod plot;
mod roughness;
mod signals;
mod unit;
mod vehicle;

use std::path::PathBuf;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use clap_complete::Shell;
use itpms_console::options::{Speaking, one_of, positive};
use itpms_core::warning::Regulation;
use itpms_drive::EstimatorKind;
use itpms_road::{RoadPeriod, RoadRepetition};

pub(crate) use bench::{
    BenchOutput, BumpArgs, CalibrateArgs, DamperArgs, IdentifyArgs, IdentifyPart, SpringArgs,
};
pub(crate) use convert::ConvertArgs;
pub(crate) use fleet::FleetArgs;
#[cfg(feature = "fmu")]
pub(crate) use fmu::{FmiVersion, FmuArgs};
pub(crate) use lab::{Lab, LabArgs, Study, Tool};
pub(crate) use log::LogArgs;
#[cfg(feature = "live")]
pub(crate) use monitor::MonitorArgs;
pub(crate) use plot::PlotArgs;
pub(crate) use roughness::RoughnessArgs;
pub(crate) use signals::SignalsArgs;
pub(crate) use unit::UnitArgs;
pub(crate) use vehicle::{
    CheckArgs, InitArgs, KnownPressures, LearnArgs, ShowArgs, VehicleArgs, VehiclePart,
};

/// Indirect tire pressure monitoring: tire pressure and road from the accelerations of a car's body and wheels.
#[derive(Debug, Parser)]
#[command(name = "itpms", version = env!("ITPMS_VERSION"), max_term_width = 100, after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) speaking: Speaking,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Where the vehicle file is unless `--vehicle` tells it.
pub(crate) const VEHICLE: &str = "ITPMS_VEHICLE";

const EXAMPLES: &str = "\
Examples:
  itpms demo
  itpms lab simulate paper-drop --seed 1 -o drive.csv --vehicle-out car.toml
  itpms estimate drive.csv --vehicle car.toml -o est.csv --report report.html

Studies and their tools: itpms lab --help.

Exit codes: 0 complete; 1 goals missed in a study with --strict; 2 an input, option or output is unusable (one message says why); 130 interrupted.
Outputs are written beside their target and renamed when complete: no partial file is ever left.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Estimate(EstimateArgs),
    Fleet(FleetArgs),
    #[cfg(feature = "live")]
    Monitor(MonitorArgs),
    Roughness(RoughnessArgs),
    Signals(SignalsArgs),
    Plot(PlotArgs),
    Convert(ConvertArgs),
    Vehicle(VehicleArgs),
    #[cfg(feature = "fmu")]
    Fmu(FmuArgs),
    Lab(LabArgs),
    #[command(flatten)]
    Tool(Tool),
    #[command(flatten)]
    Study(Study),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

impl Args {
    /// The arguments, or the end of the program with a message.
    pub(crate) fn read() -> Self {
        let matches = Self::shown().get_matches();
        Self::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
    }

    /// All commands, with those in the list that most people need.
    pub(crate) fn shown() -> clap::Command {
        lab::without_studies(with_negative_numbers(Self::command()))
    }
}

/// A number below zero is not an unknown option: whoever takes the value says what is expected.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let takes_value = |arg: &clap::Arg| arg.get_action().takes_values() && !arg.is_positional();
    command
        .mut_args(move |arg| if takes_value(&arg) { arg.allow_negative_numbers(true) } else { arg })
        .mut_subcommands(with_negative_numbers)
}

/// Simulate a drive with a puncture, estimate it, and write the report: the quickest way to see what this is.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms demo --out /tmp/demo")]
pub(crate) struct DemoArgs {
    /// Where the drive, the estimate and the report go.
    #[arg(long, value_name = "DIR", default_value = "itpms-demo")]
    pub(crate) out: PathBuf,
    /// Seed of the drive.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) unit: UnitArgs,
}

/// Estimate tire pressures (and the road) from a drive log.
///
/// The log needs time_s and, per corner c of fl fr rl rr, {c}_body_accel_m_s2 and {c}_wheel_accel_m_s2; speed_m_s is
/// worth having. Or it needs {c}_wheel_speed_m_s (or _rad_s) of all four wheels: then what is found is which tires differ from the
/// others since a calibration. Where {c}_pressure_kpa is there, too, the summary and the report show the errors.
#[derive(Debug, clap::Args)]
#[command(after_help = ESTIMATE_EXAMPLES)]
pub(crate) struct EstimateArgs {
    /// The drive log: .csv, .parquet, .mf4, .dat, .mcap, or a CAN log (.log, .asc, .blf, .trc, .mf4) with --dbc.
    pub(crate) log: PathBuf,
    /// Masses, springs, dampers and tires of the corners.
    #[arg(long, value_name = "V.toml", env = VEHICLE, hide_env_values = true)]
    pub(crate) vehicle: PathBuf,
    /// Where the pressures go: .csv or .parquet, or - for standard output; without it there is the summary alone.
    #[arg(short, long, value_name = "EST")]
    pub(crate) output: Option<PathBuf>,
    /// Where the road under each wheel goes, at the log's rate: .csv or .parquet.
    #[arg(long, value_name = "ROAD")]
    pub(crate) road_out: Option<PathBuf>,
    /// Where a page about the drive goes: .html, complete in itself.
    #[arg(long, value_name = "HTML")]
    pub(crate) report: Option<PathBuf>,
    /// Which estimator. The two as published are there to be looked at: they cannot find the stiffness.
    #[arg(long, value_name = "NAME", default_value = EstimatorKind::default().label(), value_parser = one_of(EstimatorKind::ALL, EstimatorKind::label))]
    pub(crate) estimator: EstimatorKind,
    /// The first S seconds are driven at placard pressure: a calibration.
    #[arg(long, value_name = "S", value_parser = positive, group = "taught")]
    pub(crate) calibrate_s: Option<f64>,
    /// Where what the calibration teaches of this car goes, for later drives. With --reference: that reference with what this day has shown
    /// of the wheel speeds; it may be the same file.
    #[arg(long, value_name = "FILE", requires = "taught")]
    pub(crate) save_reference: Option<PathBuf>,
    /// What a calibration taught of this car on an earlier drive. A file that is damaged, of a newer format, of another car or
    /// implausible is refused, with exit code 2.
    #[arg(long, value_name = "FILE", group = "taught")]
    pub(crate) reference: Option<PathBuf>,
    /// Pressures of the tires in the calibration, gauge, where they were measured and are not the placards': one for all wheels or one for
    /// each. For wheel speeds alone.
    #[arg(long, value_name = "KPA|fl=KPA,...", requires = "calibrate_s")]
    pub(crate) pressure_kpa: Option<KnownPressures>,
    /// When the teeth of the wheel speed sensors passed: a table of time_s and wheel (fl fr rl rr) by the log's clock, in steps of 1 us or
    /// less, .csv or .parquet. They show by torsion what each tire has lost since a calibration, and so all four, too. The log needs wheel
    /// speeds.
    #[arg(long, value_name = "PULSES")]
    pub(crate) pulses: Option<PathBuf>,
    /// Which loss is warned of: un-r141 20 % of the warm pressure found by a calibration in this drive, else of the placard's;
    /// fmvss-138 25 % of the placard's.
    #[arg(long, value_name = "NAME", default_value = Regulation::default().label(), value_parser = one_of(Regulation::ALL, Regulation::label))]
    pub(crate) regulation: Regulation,
    /// Numbers of the monitor that are not to have their defaults: priors, probabilities and times of its warnings (TOML).
    /// itpms lab tuning prints all of them with what they mean.
    #[arg(long, value_name = "FILE")]
    pub(crate) tuning: Option<PathBuf>,
    /// Where warnings and malfunctions go as they come and go: a line of JSON each.
    #[arg(long, value_name = "EVENTS")]
    pub(crate) events: Option<PathBuf>,
    /// Where the drive, its pressures, roads and warnings go together, for Foxglove and PlotJuggler: .mcap.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "MCAP")]
    pub(crate) mcap: Option<PathBuf>,
    /// Whether the road repeats itself, as on a test bed: after S seconds, never, or to be looked for.
    #[arg(long, value_name = "S|never|auto", default_value = "auto", value_parser = road_repetition)]
    pub(crate) road_repeats: RoadRepetition,
    /// Rows per second of the output.
    #[arg(long, value_name = "HZ", default_value_t = 10.0, value_parser = positive)]
    pub(crate) rate: f64,
    /// Threads: with more than 1 the log is read ahead and files are written beside the estimating, on three at most. As many as
    /// there are processors unless given; the result is the same.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    #[command(flatten)]
    pub(crate) unit: UnitArgs,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Print the summary as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const ESTIMATE_EXAMPLES: &str = "\
Examples:
  itpms estimate drive.csv --vehicle car.toml -o est.csv
  itpms estimate drive.parquet --vehicle car.toml -o est.parquet --road-out road.parquet --report report.html
  itpms estimate first.csv --vehicle car.toml -o est.csv --calibrate-s 600 --save-reference car.reference
  itpms estimate drive.csv --vehicle car.toml -o est.csv --reference car.reference
  # Wheel speeds, each day: the reference learns what the day has shown, and a slow leak shows over days
  itpms estimate today.csv --vehicle wheels.toml -o est.csv --reference car.reference --save-reference car.reference
  itpms estimate drive.csv --vehicle car.toml -o est.csv --events events.jsonl
  itpms estimate drive.csv --vehicle car.toml --mcap drive.mcap
  itpms estimate bus.log --dbc car.dbc --vehicle wheels.toml -o est.csv --calibrate-s 600 --save-reference car.reference
  itpms estimate bus.csv --pulses teeth.csv --vehicle wheels.toml -o est.csv --calibrate-s 1200
  itpms estimate drive.csv --vehicle car.toml -o est.csv --estimator aekf-ui --rate 50 --json";

fn road_repetition(text: &str) -> Result<RoadRepetition, String> {
    match text {
        "auto" => Ok(RoadRepetition::Detect),
        "never" => Ok(RoadRepetition::Never),
        seconds => match seconds.parse().map(RoadPeriod::new) {
            Ok(Ok(period)) => Ok(RoadRepetition::Every(period)),
            Ok(Err(error)) => Err(error.to_string()),
            Err(_) => Err("expected seconds, never or auto".to_owned()),
        },
    }
}

/// Simulate a drive and write its log, with the true pressure and road beside the measurements.
#[derive(Debug, clap::Args)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub(crate) struct SimulateArgs {
    /// A built-in scenario or a TOML file. An unknown name lists the built-in ones.
    pub(crate) scenario: String,
    /// Seed of the road, the sensors' noise and losses: the same seed gives the same drive.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) seed: u64,
    /// Where the log goes: .csv, .parquet or .mf4.
    #[arg(short, long, value_name = "LOG")]
    pub(crate) output: PathBuf,
    /// Drive this vehicle instead of the scenario's own.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// Also write the vehicle file that belongs to the log.
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle_out: Option<PathBuf>,
    /// Also write the tooth pulses of the four wheels, time_s and wheel: .csv or .parquet.
    #[arg(long, value_name = "PULSES")]
    pub(crate) pulses_out: Option<PathBuf>,
    /// Leave the true pressure and road out of the log.
    #[arg(long)]
    pub(crate) no_truth: bool,
    /// Print what was written as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

const SIMULATE_EXAMPLES: &str = "\
Examples:
  itpms lab simulate paper-drop --seed 7 -o drive.csv
  itpms lab simulate drive-puncture --seed 1 -o drive.parquet --vehicle-out car.toml
  itpms lab simulate my-scenario.toml -o drive.csv --vehicle my-car.toml";

/// Write a manual page for each command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms man --out ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// The folder of the pages: itpms.1, itpms-estimate.1 and so on.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Print a completion script for a shell.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: itpms completions bash > ~/.local/share/bash-completion/completions/itpms")]
pub(crate) struct CompletionsArgs {
    /// Which shell.
    pub(crate) shell: Shell,
}
