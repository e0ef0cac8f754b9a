//! `itpms lab observability`: what the accelerations of a vehicle's corner can tell of its tire, and what they cannot.

use itpms_console::{Failure, Folder, Interrupt, Screen, threads};
use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_lab::observability::{Observability, Subject, study};
use itpms_lab::runner::StudyError;

use super::json;
use crate::args::ObservabilityArgs;

pub(crate) fn run(args: &ObservabilityArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let vehicle = Vehicle::read(&args.vehicle)?;
    let subject = subject(&vehicle, args.corner)?;
    let folder = args.out.as_deref().map(Folder::open).transpose()?;
    let look = |_| interrupt.flow();
    let result = study(&subject, &look).map_err(|error| match error {
        StudyError::Stopped => Failure::Interrupted,
        StudyError::Refused(why) => Failure::Usage(format!("{}: {why}", args.vehicle.display())),
    })?;
    let json = json(&result)?;
    if let Some(folder) = &folder {
        write(folder, &result, &json, screen)?;
    }
    if args.json {
        screen.print_lines(json);
    } else {
        screen.print_lines(result.summary().trim_end());
        if let Some(folder) = &folder {
            screen.print(format!("See {} for the figures.", folder.at("observability.html").display()));
        }
    }
    Ok(())
}

/// The corner asked for, else the vehicle's first, and the one on the same side of the other axle.
fn subject(vehicle: &Vehicle, asked: Option<Corner>) -> Result<Subject, Failure> {
    let first = || Corner::ALL.into_iter().find(|&corner| vehicle.corner(corner).is_some());
    let found = asked.or_else(first).and_then(|corner| Some((corner, vehicle.corner(corner)?)));
    let (corner, config) = found.ok_or_else(|| {
        let has: Vec<&str> =
            Corner::ALL.into_iter().filter(|&c| vehicle.corner(c).is_some()).map(Corner::label).collect();
        Failure::Usage(format!(
            "the vehicle {:?} has no corner {}, expected one of {}",
            vehicle.name,
            asked.map_or("", Corner::label),
            has.join(", ")
        ))
    })?;
    let partner = match corner {
        Corner::FrontLeft => Corner::RearLeft,
        Corner::FrontRight => Corner::RearRight,
        Corner::RearLeft => Corner::FrontLeft,
        Corner::RearRight => Corner::FrontRight,
    };
    Ok(Subject::new(&vehicle.name, corner.label(), config, vehicle.corner(partner)))
}

fn write(folder: &Folder, result: &Observability, json: &str, screen: &Screen) -> Result<(), Failure> {
    let mut contents = vec![
        ("observability.json".to_owned(), format!("{json}\n")),
        ("observability.html".to_owned(), result.page()),
    ];
    contents
        .extend(result.figures().into_iter().map(|figure| (format!("{}.svg", figure.name()), figure.svg())));
    folder.fill(contents, screen)
}
