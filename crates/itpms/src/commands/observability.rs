//! `itpms observability`: what the accelerations of a vehicle's corner can tell of its tire, and what they cannot.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use itpms_core::sample::Corner;
use itpms_data::Vehicle;
use itpms_data::out::AtomicFile;
use itpms_study::observability::{Observability, StudyError, Subject, study};

use crate::args::ObservabilityArgs;
use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::screen::Screen;

pub(crate) fn run(args: &ObservabilityArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let vehicle = Vehicle::read(&args.vehicle)?;
    let subject = subject(&vehicle, args.corner)?;
    let look = |_| match interrupt.check() {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    let result = study(&subject, &look).map_err(|error| match error {
        StudyError::Stopped => Failure::Interrupted,
        other => Failure::Usage(format!("{}: {other}", args.vehicle.display())),
    })?;
    let json = serde_json::to_string_pretty(&result)
        .map_err(|error| Failure::Usage(format!("the study is no JSON: {error}")))?;
    if let Some(directory) = &args.out {
        write(directory, &result, &json)?;
    }
    if args.json {
        screen.print(json);
    } else {
        screen.print(result.summary().trim_end());
        if let Some(directory) = &args.out {
            screen.print(format!("See {} for the figures.", directory.join("observability.html").display()));
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

/// Everything into a directory; the files get their names when all are complete.
fn write(directory: &Path, result: &Observability, json: &str) -> Result<(), Failure> {
    fs::create_dir_all(directory).map_err(|error| Failure::Directory(directory.to_owned(), error))?;
    let mut contents = vec![
        ("observability.json".to_owned(), format!("{json}\n")),
        ("observability.html".to_owned(), result.page()),
    ];
    contents.extend(result.tables().into_iter().map(|(name, text)| (format!("{name}.csv"), text)));
    contents
        .extend(result.figures().into_iter().map(|figure| (format!("{}.svg", figure.name()), figure.svg())));
    let mut files = Vec::new();
    for (name, content) in contents {
        let mut file = AtomicFile::create(&directory.join(name))?;
        file.append(content.as_bytes())?;
        file.settle()?;
        files.push(file);
    }
    for file in files {
        file.commit()?;
    }
    Ok(())
}
