//! `itpms vehicle`: a vehicle file of typical values, what a file says, and whether a drive agrees.

mod check;
mod learn;
mod show;

use itpms_console::{Failure, Interrupt, Screen, former};
use itpms_data::out::AtomicFile;
use itpms_data::vehicle::typical::{AxleWheels, TypicalCar, WheelsOfACar};

use crate::args::{InitArgs, VehiclePart};

pub(crate) fn run(part: &VehiclePart, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    match part {
        VehiclePart::Init(args) => init(args, screen),
        VehiclePart::Learn(args) => learn::run(args, screen, interrupt),
        VehiclePart::Show(args) => show::run(args, screen),
        VehiclePart::Check(args) => check::run(args, screen, interrupt),
    }
}

/// The file of a car whose mass is known, else of one whose wheel speeds alone are read.
fn typical(args: &InitArgs) -> Result<String, Failure> {
    let axles = args.driven.map(|driven| AxleWheels {
        track_m: [args.track_front_m, args.track_rear_m],
        driven,
        limited_slip: args.limited_slip,
    });
    let (name, tire, placard_kpa) = (args.name.clone(), args.tire, args.placard_kpa);
    let file = match (args.mass, args.front_share, axles, args.wheelbase_m) {
        (Some(mass_kg), Some(front_share), wheels, wheelbase_m) => {
            let class = args.class;
            TypicalCar { name, mass_kg, front_share, tire, class, placard_kpa, wheelbase_m, wheels }
                .vehicle_file()
        }
        (_, _, Some(axles), Some(wheelbase_m)) => {
            WheelsOfACar { name, tire, wheelbase_m, axles, placard_kpa }.vehicle_file()
        }
        _ => {
            let what =
                "expected --mass and --front-share, or --wheelbase-m and --driven for wheel speeds alone";
            return Err(Failure::Usage(what.to_owned()));
        }
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
