//! Many drives of many cars: each estimated as `itpms estimate` would, finished ones kept when the run is stopped, a
//! table and a page about all of them at the end.
//!
//! | module | idea |
//! |---|---|
//! | [`found`] | which files are meant, in which order |
//! | [`cars`] | whose drive a file is |
//! | `copies` | files that hold a drive once more |
//! | [`record`] | what is kept of a drive, and the file that keeps it |
//! | `one` | one drive |
//! | `crew` | several at a time |
//! | [`days`] | slow leaks, over a car's drives |
//! | `dampers` | dampers that are not as they were, over a car's drives |
//! | `beside_cell`, `damper_cell` | load, cold pressures, what turns, tire sensors; dampers: cells of the page |
//! | `tables` | `fleet.csv`, `fleet.parquet`, `failed.csv` |
//! | [`standing`] | how each car stands after its last drive |
//! | [`wheels`] | what a drive showed of each wheel |
//! | [`road_map`], `align`, `squares` | roughness in squares of 20 m, with a factor for each car; how far off each drive's positions are; where the squares lie |
//! | `page`, `names`, `histogram` | `index.html` |
//!
//! Calibration drives come first, because they need no others; what each taught of its car is stored, and every later
//! drive of that car starts with it. So all drives of a stage are independent of each other. The same files give the same
//! results, whatever the number of threads and however often the run was stopped.

mod align;
mod beside_cell;
pub mod cars;
mod copies;
mod crew;
mod damper_cell;
mod dampers;
pub mod days;
pub mod found;
mod histogram;
mod names;
mod one;
mod page;
pub mod record;
pub mod road_map;
mod squares;
pub mod standing;
mod tables;
pub mod wheels;

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use itpms_data::log::LogOptions;
use itpms_data::reference::crc64;
use serde_json::{Value, json};

pub use glob::{Pattern, PatternError};

use crate::error::DriveError;
use crate::settings::Settings;
use cars::{Car, Cars};
use crew::Progress;
use found::Found;
use one::Errand;
use record::{DriveRecord, Inputs, Records};
use road_map::FleetRoads;

/// The plan of a fleet's run.
#[derive(Debug)]
pub struct Plan {
    pub files: Vec<Found>,
    pub cars: Cars,
    /// How each drive is estimated; its calibration and its reference are set drive by drive.
    pub settings: Settings,
    /// Which drives are calibration drives; `None`: none is.
    pub calibration: Option<Calibration>,
    pub options: LogOptions,
    pub out: PathBuf,
    pub reports: bool,
    /// Whether every drive leaves its estimates as CSV.
    pub estimates: bool,
    /// Whether roads are mapped from positions; nothing of these is kept otherwise.
    pub map: bool,
    pub jobs: usize,
    /// Identifies this build, as another one might compute otherwise.
    pub program: String,
}

/// Which drives begin at placard pressure, and for how long.
#[derive(Debug, Clone)]
pub struct Calibration {
    pub seconds: f64,
    /// Those whose path this fits; `None`: each car's first.
    pub drives: Option<Pattern>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// Share of the bytes, 0 to 1.
    pub share: f64,
    /// Drives that are done, those of earlier runs included.
    pub done: usize,
    pub drives: usize,
}

/// Callback for progress, on any thread; its result says whether to go on.
pub type Watch<'a> = &'a (dyn Fn(Standing) -> ControlFlow<()> + Sync);

/// A drive that could not be estimated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failed {
    pub file: PathBuf,
    pub car: Option<String>,
    pub why: String,
}

#[derive(Debug, Default)]
pub struct Outcome {
    /// Every drive that was estimated, in the order of the files.
    pub drives: Vec<DriveRecord>,
    pub failed: Vec<Failed>,
    /// How many of the drives an earlier run had done.
    pub kept: usize,
    /// Lines of earlier runs in `drives.jsonl` that were not as they were written; their drives were estimated again.
    pub damaged: usize,
}

/// A file with its car, and what it is in the car's history.
struct Assigned<'a> {
    number: usize,
    file: &'a Found,
    car: &'a Car,
    calibrate: bool,
}

/// Estimates all drives that are not done, and writes the tables and the page.
/// Errors: the folder cannot be used, or [`DriveError::Stopped`]: what is finished is kept. A drive that fails is no error.
pub fn survey(plan: &Plan, watch: Watch<'_>) -> Result<Outcome, DriveError> {
    let mut records = Records::open(&plan.out.join("drives.jsonl"), heading(plan)?)?;
    let mut failed = BTreeMap::new();
    let assigned = assign(plan, &mut failed);
    let progress = Progress::new(plan, watch);
    let mut kept = 0;
    for calibrating in [true, false] {
        let mut errands = Vec::new();
        for drive in assigned.iter().filter(|drive| drive.calibrate == calibrating) {
            match errand(plan, drive, &assigned, &records) {
                Ok(errand) if records.holds(&errand.name, &errand.inputs, &plan.out, plan) => {
                    kept += 1;
                    progress.finished(drive.file.bytes);
                }
                Ok(errand) => errands.push(errand),
                Err(error) => {
                    failed.insert(drive.number, failure(drive, error.to_string()));
                    progress.finished(drive.file.bytes);
                }
            }
        }
        failed.extend(crew::run(plan, errands, &mut records, &progress)?);
    }
    let drives: Vec<DriveRecord> = assigned
        .iter()
        .filter(|drive| !failed.contains_key(&drive.number))
        .filter_map(|drive| records.of(&drive.file.name()).cloned())
        .collect();
    let mut drives = in_order(drives);
    days::judge(&mut drives, plan.settings.pressure_unit, |record| {
        let drive = assigned.iter().find(|drive| drive.file.name() == record.file)?;
        let reference = carried(plan, drive, &assigned, &records).or_else(|| drive.car.reference.clone())?;
        Some((drive.car.vehicle.as_ref().ok()?, reference))
    });
    dampers::judge(&mut drives);
    let outcome = Outcome { drives, failed: failed.into_values().collect(), kept, damaged: records.damaged };
    tables::write(&plan.out, &outcome)?;
    let roads = plan.map.then(|| FleetRoads::of(&outcome.drives));
    roads.as_ref().map_or(Ok(()), |roads| road_map::write(&plan.out, roads))?;
    page::write(plan, &outcome, roads.as_ref())?;
    Ok(outcome)
}

fn failure(drive: &Assigned<'_>, why: String) -> Failed {
    Failed { file: drive.file.path.clone(), car: Some(drive.car.id.clone()), why }
}

/// Every file whose car is known; the others fail.
fn assign<'a>(plan: &'a Plan, failed: &mut BTreeMap<usize, Failed>) -> Vec<Assigned<'a>> {
    let mut assigned: Vec<Assigned<'a>> = Vec::new();
    for (number, file) in plan.files.iter().enumerate() {
        if let Some(why) = file.unusable {
            let why = format!("{}: {why}", file.path.display());
            failed.insert(number, Failed { file: file.path.clone(), car: None, why });
            continue;
        }
        match plan.cars.of(&file.path) {
            Ok(car) => {
                let earlier = assigned.iter().filter(|earlier| std::ptr::eq(earlier.car, car));
                if let Some(why) = copies::copy_of(file, earlier.map(|earlier| earlier.file)) {
                    let why = format!("{}: {why}", file.path.display());
                    failed.insert(number, Failed { file: file.path.clone(), car: Some(car.id.clone()), why });
                    continue;
                }
                let calibrate = match &plan.calibration {
                    None => false,
                    Some(Calibration { drives: Some(pattern), .. }) => pattern.matches_path(&file.path),
                    Some(Calibration { drives: None, .. }) => {
                        !assigned.iter().any(|earlier| std::ptr::eq(earlier.car, car))
                    }
                };
                assigned.push(Assigned { number, file, car, calibrate });
            }
            Err(why) => {
                failed.insert(number, Failed { file: file.path.clone(), car: None, why });
            }
        }
    }
    assigned
}

/// The work for a drive, and its inputs.
fn errand<'a>(
    plan: &'a Plan,
    drive: &Assigned<'a>,
    all: &[Assigned<'_>],
    records: &Records,
) -> Result<Errand<'a>, DriveError> {
    let mut settings = plan.settings.clone();
    if let Some(calibration) = plan.calibration.as_ref().filter(|_| drive.calibrate) {
        settings.calibrate_s = Some(calibration.seconds);
    } else {
        settings.reference = carried(plan, drive, all, records).or_else(|| drive.car.reference.clone());
    }
    settings.pulses = drive.file.pulses.as_ref().map(|table| table.path.clone());
    let inputs = Inputs {
        bytes: drive.file.bytes,
        modified: drive.file.modified.clone(),
        vehicle: drive.car.fingerprint.clone(),
        calibrate: drive.calibrate,
        reference: settings.reference.as_deref().map(fingerprint).transpose()?,
        pulses: drive.file.pulses.as_ref().map(|table| table.version.clone()),
    };
    let (name, bytes) = (drive.file.name(), drive.file.bytes);
    Ok(Errand { number: drive.number, name, path: &drive.file.path, bytes, car: drive.car, settings, inputs })
}

/// The result of the car's last calibration drive before this one, if there is one.
fn carried(plan: &Plan, drive: &Assigned<'_>, all: &[Assigned<'_>], records: &Records) -> Option<PathBuf> {
    let taught = |earlier: &&Assigned<'_>| {
        earlier.calibrate
            && earlier.car.id == drive.car.id
            && records.of(&earlier.file.name()).is_some_and(|record| record.taught)
    };
    let mut earlier = all.iter().filter(|earlier| earlier.number < drive.number);
    let last = earlier.rfind(taught)?;
    Some(reference_path(&plan.out, &last.file.path))
}

/// Where what a calibration drive taught is kept.
fn reference_path(out: &Path, drive: &Path) -> PathBuf {
    beneath(&out.join("references"), drive, "reference")
}

/// A place in `folder` that is the drive's alone: its path, its name with one more extension.
fn beneath(folder: &Path, drive: &Path, extension: &str) -> PathBuf {
    use std::path::Component;
    let mut place = folder.to_owned();
    for component in drive.components() {
        match component {
            Component::Normal(name) => place.push(name),
            Component::ParentDir => place.push("__"),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    place.as_mut_os_string().push(format!(".{extension}"));
    let name = place.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if name.len() > LONGEST_NAME {
        let kept: String = name.chars().take(LONGEST_NAME / 8).collect();
        place.set_file_name(format!("{kept}-{:016x}.{extension}", crc64(&[name.as_bytes()])));
    }
    place
}

/// Bytes of a file's name, at most: file systems have 255.
const LONGEST_NAME: usize = 255;

/// A checksum of a file's contents.
fn fingerprint(path: &Path) -> Result<String, DriveError> {
    let unreadable = |error| DriveError::Mismatch(format!("{}: cannot be read: {error}", path.display()));
    Ok(format!("{:016x}", crc64(&[&fs::read(path).map_err(unreadable)?])))
}

/// Inputs of the results besides those of each drive.
fn heading(plan: &Plan) -> Result<Value, DriveError> {
    let content = |path: &Option<PathBuf>| path.as_deref().map(fingerprint).transpose();
    let Plan { settings, options, .. } = plan;
    Ok(json!({
        "itpms_fleet": 2,
        "program": plan.program,
        "estimator": settings.estimator.label(),
        "regulation": settings.regulation.label(),
        "road_repeats": format!("{:?}", settings.road_repeats),
        "rate_hz": settings.rate_hz,
        "pressure_unit": settings.pressure_unit.label(),
        "calibrate_s": plan.calibration.as_ref().map(|calibration| calibration.seconds),
        "units": format!("{:?}", options.units),
        "dbc": content(&options.dbc)?,
        "signals": content(&options.signals)?,
    }))
}

/// Drives in the order of their cars; a drive that begins before the one before it, or before that has ended, by a clock that counts from
/// an epoch, says so.
fn in_order(mut drives: Vec<DriveRecord>) -> Vec<DriveRecord> {
    let mut last: BTreeMap<String, (f64, f64, String)> = BTreeMap::new();
    for drive in &mut drives {
        if drive.origin_s == 0.0 {
            continue;
        }
        let end_s = drive.start_s + drive.duration_s;
        if let Some((start_s, until_s, file)) = last.get(&drive.car) {
            // Seconds that two logs share are how a logger cuts them.
            let shared_s = until_s.min(end_s) - start_s.max(drive.start_s);
            if shared_s > SHARED * drive.duration_s.min(until_s - start_s) {
                drive.concerns.push(format!(
                    "{shared_s:.0} s of it are at the same time as {file}: a car has one drive at a time, so one of the two is a copy, or another car's; give one"
                ));
            } else if drive.start_s < *start_s {
                drive.concerns.push(format!(
                    "begins before {file}, whose name comes first: the drives of a car are taken in the order of their names"
                ));
            }
        }
        last.insert(drive.car.clone(), (drive.start_s, end_s, drive.file.clone()));
    }
    drives
}

/// Share of the shorter of two drives that the two have in common, at most.
const SHARED: f64 = 0.5;
