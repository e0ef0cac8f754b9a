//! `itpms vehicle`: a vehicle file of typical values, what a file says, and whether a drive agrees.

mod check;
mod learn;
mod show;

use itpms_data::out::AtomicFile;
use itpms_data::vehicle::typical::TypicalCar;

use super::former;
use crate::args::{InitArgs, VehiclePart};
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;

pub(crate) fn run(part: &VehiclePart, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    match part {
        VehiclePart::Init(args) => init(args, screen),
        VehiclePart::Learn(args) => learn::run(args, screen, interrupt),
        VehiclePart::Show(args) => show::run(args, screen),
        VehiclePart::Check(args) => check::run(args, screen, interrupt),
    }
}

fn init(args: &InitArgs, screen: &Screen) -> Result<(), Failure> {
    let car = TypicalCar {
        name: args.name.clone(),
        mass_kg: args.mass,
        front_share: args.front_share,
        tire: args.tire,
        class: args.class,
        placard_kpa: args.placard_kpa,
        wheelbase_m: args.wheelbase_m,
    };
    let (text, _) = car.vehicle_file().map_err(|error| Failure::Usage(error.to_string()))?;
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
