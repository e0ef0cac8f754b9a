//! `itpms fleet`: many drives of many cars, kept drive by drive, going on where it was stopped.

use std::{env, fs};

use itpms_console::{Failure, Interrupt, Screen, fingerprint, threads};
use itpms_core::model::PressureUnit;
use itpms_drive::fleet::cars::Cars;
use itpms_drive::fleet::standing::{CarStanding, State};
use itpms_drive::fleet::{self, Calibration, Outcome, Plan, found};
use itpms_drive::{DriveError, Settings};
use serde_json::json;

use crate::args::{FleetArgs, VEHICLE};

/// Cars and failures that are reported; the files have all.
const LISTED: usize = 10;

pub(crate) fn run(args: &FleetArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let cars = match (&args.vehicle, &args.vehicle_dir) {
        (Some(file), _) => Cars::one(file)?,
        (None, Some(folder)) => Cars::folder(folder)?,
        (None, None) => match env::var_os(VEHICLE) {
            Some(file) => Cars::one(file.as_ref())?,
            None => return Err(Failure::Usage("expected --vehicle or --vehicle-dir".to_owned())),
        },
    };
    let files = found::files(&args.drives, &args.out)?;
    fs::create_dir_all(&args.out).map_err(|error| Failure::Directory(args.out.clone(), error))?;
    let plan = Plan {
        files,
        cars,
        settings: Settings {
            estimator: args.estimator,
            regulation: args.regulation,
            pressure_unit: args.unit.pressure_unit,
            program: concat!("itpms ", env!("ITPMS_VERSION")).to_owned(),
            ..Settings::default()
        },
        calibration: args
            .calibrate_s
            .map(|seconds| Calibration { seconds, drives: args.calibration_drives.clone() }),
        options: args.reading.options(),
        out: args.out.clone(),
        reports: args.reports,
        estimates: args.estimates,
        map: args.map,
        jobs: threads::at_a_time(args.jobs),
        program: fingerprint()?,
    };
    let progress = screen.progress("estimating");
    let outcome = fleet::survey(&plan, &|at| {
        progress.say(&format!("{} of {} drives", at.done, at.drives));
        progress.set(at.share);
        interrupt.flow()
    });
    drop(progress);
    let outcome = outcome.map_err(|error| match error {
        DriveError::Stopped => Failure::Paused,
        other => other.into(),
    })?;
    report(args, screen, &outcome)
}

/// The result: the cars that need attention, failures, and a line of counts.
fn report(args: &FleetArgs, screen: &Screen, outcome: &Outcome) -> Result<(), Failure> {
    let cars = CarStanding::of_all(&outcome.drives, &outcome.failed);
    if outcome.damaged > 0 {
        let lines = counted(outcome.damaged, "line");
        let file = at(args, "drives.jsonl");
        screen
            .warn(format!("{file}: {lines} damaged, by their checksums: what they held was estimated again"));
    }
    for failed in outcome.failed.iter().take(LISTED) {
        screen.warn(&failed.why);
    }
    let (drives, failed) = (outcome.drives.len(), outcome.failed.len());
    let total = drives + failed;
    if failed > LISTED {
        screen.warn(format!("and {} more drives failed: see {}", failed - LISTED, at(args, "failed.csv")));
    }
    if drives == 0 {
        let why = outcome.failed.first().map_or("", |failed| &failed.why);
        return Err(Failure::Usage(format!("none of {total} drives could be estimated; the first: {why}")));
    }
    let calibrations = || outcome.drives.iter().filter(|drive| drive.inputs.calibrate);
    let useless = calibrations().filter(|drive| !drive.taught).count();
    if useless > 0 {
        let all = counted(calibrations().count(), "calibration drive");
        let table = at(args, "fleet.csv");
        screen.warn(format!(
            "{useless} of {all} taught nothing, and later drives start without: see the column concerns of {table}"
        ));
    }
    if args.json {
        screen.print_lines(as_json(args, outcome, &cars));
    } else {
        for car in cars.iter().filter(|car| car.state != State::Fine).take(LISTED) {
            screen.print(car_line(car, args.unit.pressure_unit));
        }
        let warned = outcome.drives.iter().filter(|drive| !drive.alerts.is_empty()).count();
        if warned > 0 {
            screen.print(format!("{} with a warning", counted(warned, "drive")));
        }
        screen.print(format!(
            "See {} for the whole fleet, {} for the numbers.",
            at(args, "index.html"),
            at(args, "fleet.csv")
        ));
        let kept =
            if outcome.kept > 0 { format!(" ({} of them before)", outcome.kept) } else { String::new() };
        let failures = match failed {
            0 => "none failed".to_owned(),
            n => format!("{n} failed: {}", at(args, "failed.csv")),
        };
        screen.print(format!(
            "{drives} of {total} drives of {} estimated{kept}; {failures}",
            counted(cars.len(), "car")
        ));
    }
    if args.strict && failed > 0 {
        return Err(Failure::Usage(format!("{failed} of {total} drives failed, and --strict was given")));
    }
    Ok(())
}

fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn at(args: &FleetArgs, name: &str) -> String {
    args.out.join(name).display().to_string()
}

/// `car-7: low in logs/car-7/d3.csv: fl 138.2 of 241.3 kPa`.
fn car_line(car: &CarStanding<'_>, unit: PressureUnit) -> String {
    let Some(last) = car.last() else {
        let drives = if car.failed == 1 { "its only drive" } else { "none of its drives" };
        let could = if car.failed == 1 { "could not" } else { "could" };
        return format!("{}: unknown, {drives} {could} be estimated", car.car);
    };
    let wheels = last.wheels.iter().filter(|wheel| State::of_wheel(wheel) == car.state);
    let words: Vec<String> = wheels
        .map(|wheel| match wheel.last {
            Some(at) => {
                let [now, placard] = [at.pressure_kpa, wheel.placard_kpa].map(|kpa| unit.number(kpa, 1));
                format!("{} {now} of {placard} {unit}", wheel.wheel)
            }
            None => format!("{} unknown", wheel.wheel),
        })
        .collect();
    format!("{}: {} in {}: {}", car.car, car.state.label(), last.file, words.join(", "))
}

fn as_json(args: &FleetArgs, outcome: &Outcome, cars: &[CarStanding<'_>]) -> serde_json::Value {
    let states: serde_json::Map<String, serde_json::Value> = State::ALL
        .into_iter()
        .map(|state| (state.label().to_owned(), json!(cars.iter().filter(|car| car.state == state).count())))
        .collect();
    let failed: Vec<_> = outcome
        .failed
        .iter()
        .map(|failed| json!({ "file": failed.file.display().to_string(), "car": failed.car, "error": failed.why }))
        .collect();
    json!({
        "drives": outcome.drives.len(),
        "kept": outcome.kept,
        "cars": cars.len(),
        "cars_by_state": states,
        "failed": failed,
        "outputs": {
            "table": at(args, "fleet.csv"),
            "failed": at(args, "failed.csv"),
            "page": at(args, "index.html"),
            "road": args.map.then(|| at(args, "road.geojson")),
        },
    })
}
