//! One drive of the fleet, estimated as `itpms estimate` estimates it.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use itpms_data::out::{EstimateRow, WheelSpeedUse};
use itpms_data::{LogReader, LogRow};

use super::cars::Car;
use super::record::{DayRecord, DriveRecord, Inputs};
use super::road_map::DriveRoad;
use super::wheels::{Begun, wheels};
use super::{Plan, beneath, beside_cell, reference_path};
use crate::concerns::common_corners;
use crate::error::DriveError;
use crate::files::{FilePaths, Files};
use crate::reference;
use crate::road::LateRow;
use crate::run::{Done, Heights, Job, Sink, estimate};
use crate::settings::Settings;
use crate::wheel_speeds::wheel_speed_use;

/// A drive to be estimated.
pub(super) struct Errand<'a> {
    /// Its place among the files.
    pub(super) number: usize,
    pub(super) name: String,
    pub(super) path: &'a Path,
    pub(super) bytes: u64,
    pub(super) car: &'a Car,
    pub(super) settings: Settings,
    pub(super) inputs: Inputs,
}

/// Does it. `watch` receives the share of the log that is done.
pub(super) fn run(
    plan: &Plan,
    errand: &Errand<'_>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<DriveRecord, DriveError> {
    let vehicle = errand.car.vehicle.as_ref().map_err(|why| DriveError::Mismatch(why.clone()))?;
    let mut log = LogReader::open_with(errand.path, &plan.options)?;
    let corners = common_corners(&log, vehicle)?;
    let wheel_speeds = wheel_speed_use(log.columns(), vehicle, &corners).unwrap_or_default();
    let mut settings = errand.settings.clone();
    // A table without the wheel speeds to which it belongs was not asked for.
    let usable = wheel_speeds != WheelSpeedUse::None && vehicle.torsion_config().is_ok();
    let unused = settings.pulses.take_if(|_| !usable);
    let settings = &settings;
    let paths = FilePaths {
        estimates: plan.estimates.then(|| place(plan, "estimates", errand.path, "csv")).transpose()?,
        report: plan.reports.then(|| place(plan, "reports", errand.path, "html")).transpose()?,
        ..FilePaths::default()
    };
    let mut sink = Counting {
        files: Files::create(&paths, settings, vehicle, &log, &corners, wheel_speeds)?,
        first_s: None,
        begun: Begun::default(),
        road: plan
            .map
            .then(|| DriveRoad::new(&corners, vehicle.wheelbase_m, log.survey().estimator_rate_hz()))
            .transpose()
            .map_err(|error| DriveError::Mismatch(error.to_string()))?,
    };
    let reading = &plan.options;
    // Of the road the table has its roughness alone.
    let road = if plan.reports || plan.map { Heights::Smoothed } else { Heights::Causal };
    let job = Job { vehicle, corners: &corners, settings, reading, road, report: plan.reports };
    let mut done = estimate(&mut log, &job, &mut sink, watch)?;
    done.concerns.extend(unused.map(|path| {
        format!(
            "{}: tooth pulses count together with wheel speeds and are not used: expected the speeds of all four wheels in the log, and in the vehicle file placard_kpa of all four corners, [tire] rolling_radius_m and what wheel speeds need",
            path.display()
        )
    }));
    let taught = teach(plan, errand, &mut done)?;
    sink.files.complete(&done)?;
    let within = |path: &Option<PathBuf>| {
        let path = path.as_ref()?.strip_prefix(&plan.out).ok()?;
        Some(path.iter().map(|name| name.to_string_lossy()).collect::<Vec<_>>().join("/"))
    };
    let (drive, road) = (&done.data.drive, sink.road.map(DriveRoad::finish));
    Ok(DriveRecord {
        file: errand.name.clone(),
        car: errand.car.id.clone(),
        vehicle: vehicle.name.clone(),
        inputs: errand.inputs.clone(),
        taught,
        start_s: sink.first_s.unwrap_or(0.0),
        origin_s: drive.origin_s,
        duration_s: drive.duration_s,
        rate_hz: drive.rate_hz,
        distance_m: Some(drive.distance_m).filter(|distance| distance.is_finite()),
        wheels: wheels(&done, &sink.begun),
        not_estimated: done.not_estimated.iter().map(|(corner, _)| corner.label().to_owned()).collect(),
        alerts: done.alerts.sentences(drive.origin_s, settings.pressure_unit).collect(),
        concerns: std::mem::take(&mut done.concerns),
        day: DayRecord::of(&done.learned),
        beside: beside_cell::lines(&done, settings.pressure_unit),
        road,
        report: within(&paths.report),
        estimates: within(&paths.estimates),
    })
}

/// The place of one of the drive's files, its folder made.
fn place(plan: &Plan, kind: &str, drive: &Path, extension: &str) -> Result<PathBuf, DriveError> {
    let place = beneath(&plan.out.join(kind), drive, extension);
    make_folder_of(&place)?;
    Ok(place)
}

fn make_folder_of(file: &Path) -> Result<(), DriveError> {
    let Some(folder) = file.parent() else { return Ok(()) };
    fs::create_dir_all(folder)
        .map_err(|error| DriveError::Mismatch(format!("{}: cannot be made: {error}", folder.display())))
}

/// Stores what a calibration drive taught; whether it did. One that taught nothing is a drive all the same.
fn teach(plan: &Plan, errand: &Errand<'_>, done: &mut Done) -> Result<bool, DriveError> {
    if errand.settings.calibrate_s.is_none() {
        return Ok(false);
    }
    let path = reference_path(&plan.out, errand.path);
    make_folder_of(&path)?;
    let Ok(vehicle) = &errand.car.vehicle else { return Ok(false) };
    if let Some(why) = done.calibration_doubt() {
        done.concerns.push(format!("{why}: later drives start without it"));
        return Ok(false);
    }
    let nothing = reference::teach(&path, &errand.settings, vehicle, done.learned)?;
    let taught = nothing.is_none();
    done.concerns.extend(nothing);
    Ok(taught)
}

/// The drive's files, and how often each wheel's warnings began.
struct Counting {
    files: Files,
    first_s: Option<f64>,
    begun: Begun,
    road: Option<DriveRoad>,
}

impl Sink for Counting {
    fn row(&mut self, row: &LogRow, known: &EstimateRow<'_>) -> Result<(), DriveError> {
        self.first_s.get_or_insert(row.time_s);
        self.begun.take(known.estimates);
        self.files.row(row, known)
    }

    fn road(&mut self, late: &LateRow) -> Result<(), DriveError> {
        if let Some(road) = &mut self.road {
            road.take(late);
        }
        self.files.road(late)
    }
}
