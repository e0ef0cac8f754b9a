//! `itpms vehicle`: a vehicle file of typical values, what a file says, and whether a drive agrees.

mod check;
mod field;
mod learn;
mod show;

use std::path::Path;

use itpms_console::{Failure, Interrupt, Screen, former, names};
use itpms_data::out::AtomicFile;
use itpms_data::vehicle::typical::{AxleWheels, TypicalCar, WheelsOfACar};
use itpms_data::{LogReader, Vehicle};

use crate::args::{CheckArgs, InitArgs, VehiclePart};

pub(crate) fn run(part: &VehiclePart, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    match part {
        VehiclePart::Init(args) => init(args, screen),
        VehiclePart::Learn(args) => learn::run(args, screen, interrupt),
        VehiclePart::Show(args) => show::run(args, screen),
        VehiclePart::Check(args) if args.field => field::run(args, screen, interrupt),
        VehiclePart::Check(args) => check::run(args, screen, interrupt),
    }
}

/// The vehicle and the log of a check, whose output is none of its inputs.
fn opened(args: &CheckArgs, output: Option<&Path>) -> Result<(Vehicle, LogReader), Failure> {
    let [dbc, signals] = args.reading.inputs();
    let log = (Some(args.log.as_path()), "the log");
    let vehicle = (Some(args.vehicle.as_path()), "the vehicle file");
    names::check(&[log, vehicle, dbc, signals], &[output])?;
    Ok((Vehicle::read(&args.vehicle)?, LogReader::open_with(&args.log, &args.reading.options())?))
}

/// All that is not given and has to be, at once; empty: nothing.
fn lacking(args: &InitArgs) -> String {
    let axles = args.limited_slip || args.track_front_m.or(args.track_rear_m).is_some();
    let weighs = args.mass.or(args.front_share).is_some();
    let rolls = args.driven.is_some() || axles;
    let mass = [("--mass", args.mass.is_none()), ("--front-share", args.front_share.is_none())];
    let driven = ("--driven", args.driven.is_none());
    let wheelbase = ("--wheelbase-m", args.wheelbase_m.is_none());
    let mut wanted = vec![("--tire", args.tire.is_none())];
    match (weighs, rolls) {
        (true, false) => wanted.extend(mass),
        (true, true) => wanted.extend(mass.into_iter().chain([driven])),
        (false, true) => wanted.extend([driven, wheelbase]),
        (false, false) => {
            return "expected --tire, --mass and --front-share; for wheel speeds alone --tire, --driven and --wheelbase-m (itpms vehicle init --help)"
                .to_owned();
        }
    }
    let names: Vec<&str> = wanted.into_iter().filter_map(|(name, lacks)| lacks.then_some(name)).collect();
    let of = if weighs { "a car" } else { "wheel speeds alone" };
    if names.is_empty() { String::new() } else { format!("of {of} expected, too: {}", names.join(", ")) }
}

/// The file of a car whose mass is known, else of one whose wheel speeds alone are read.
fn typical(args: &InitArgs) -> Result<String, Failure> {
    let axles = args.driven.map(|driven| AxleWheels {
        track_m: [args.track_front_m, args.track_rear_m],
        driven,
        limited_slip: args.limited_slip,
    });
    let (name, placard_kpa) = (args.name.clone(), args.placard_kpa);
    let lacking = lacking(args);
    let (Some(tire), "") = (args.tire, lacking.as_str()) else {
        return Err(Failure::Usage(lacking));
    };
    let file = match (args.mass, args.front_share, axles, args.wheelbase_m) {
        (Some(mass_kg), Some(front_share), wheels, wheelbase_m) => {
            let class = args.class;
            TypicalCar { name, mass_kg, front_share, tire, class, placard_kpa, wheelbase_m, wheels }
                .vehicle_file()
        }
        (_, _, Some(axles), Some(wheelbase_m)) => {
            WheelsOfACar { name, tire, wheelbase_m, axles, placard_kpa }.vehicle_file()
        }
        _ => return Err(Failure::Usage(lacking)),
    };
    Ok(file.map_err(|error| Failure::Usage(error.to_string()))?.0)
}

fn init(args: &InitArgs, screen: &Screen) -> Result<(), Failure> {
    let text = typical(args)?;
    let Some(path) = &args.output else {
        screen.print_lines(text.trim_end());
        return Ok(());
    };
    let mut file = AtomicFile::create(path)?;
    former::keep(path, &text, screen)?;
    file.append(text.as_bytes())?;
    file.commit()?;
    screen.remark(format!("{}: typical values; look at them with itpms vehicle show", path.display()));
    if args.wheelbase_m.is_none() {
        screen.warn("the wheelbase is that of other cars until itpms vehicle learn finds it; measure it and give it with --wheelbase-m");
    }
    Ok(())
}
