//! The learned reference of a car: given to the estimator before the drive, stored after a calibration.
//!
//! A reference that was asked for and cannot be used ends the command: whoever names a file wants its contents to count.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use itpms_core::model::{CalibrationError, VehicleCalibration};
use itpms_core::wheel_speed::{RadiusCalibration, RadiusDays};
use itpms_data::Vehicle;
use itpms_data::out::AtomicFile;
use itpms_data::reference::{LearnedTorsion, ReferenceProblem, StoredReference, SuspensionReference};

use crate::car::AnyCar;
use crate::error::DriveError;
use crate::settings::{LOG_END_S, Settings};

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Taught {
    pub corners: Option<VehicleCalibration<f64>>,
    pub wheel_speeds: Option<RadiusCalibration<f64>>,
    pub torsion: LearnedTorsion,
    pub suspension: Option<SuspensionReference>,
    /// The radii of the days since the calibration of the wheel speeds, with this one, or why it does not count; `None` without one.
    pub days: Option<Result<RadiusDays<f64>, &'static str>>,
}

impl Taught {
    pub fn is_nothing(&self) -> bool {
        self.corners.is_none() && self.wheel_speeds.is_none()
    }
}

/// The reference of an earlier drive, if `--reference` names a file, and the vehicle that it counts from.
pub(crate) fn read(
    settings: &Settings,
    vehicle: &Vehicle,
) -> Result<Option<(Vehicle, StoredReference)>, DriveError> {
    let Some(path) = &settings.reference else { return Ok(None) };
    settings.expect_learning("--reference")?;
    let stored = StoredReference::read(path)?;
    let (vehicle, _) = stored.for_vehicle(vehicle).map_err(|problem| refused(path, problem))?;
    Ok(Some((vehicle, stored)))
}

/// Tells the estimator of it.
pub(crate) fn load(
    settings: &Settings,
    reference: &VehicleCalibration<f64>,
    car: &mut AnyCar,
) -> Result<(), DriveError> {
    car.load_calibration(reference).map_err(|error: CalibrationError| {
        let why = format!("the learned reference does not fit the drive: {error}");
        refused(settings.reference.as_deref().unwrap_or(Path::new("--reference")), why)
    })
}

fn refused(path: &Path, why: impl std::fmt::Display) -> DriveError {
    DriveError::Mismatch(format!("{}: {why}", path.display()))
}

/// The file with the result of a calibration drive, or an earlier one with another day, in the making.
#[derive(Debug)]
pub struct Saving {
    file: AtomicFile,
    vehicle: Vehicle,
    /// That of the drive, to which it adds its day.
    before: Option<StoredReference>,
}

impl Saving {
    /// Starts the file. Errors: it cannot be written, or the estimator does not learn.
    pub fn create(path: &Path, settings: &Settings, vehicle: &Vehicle) -> Result<Self, DriveError> {
        settings.expect_learning("--save-reference")?;
        let before = read(settings, vehicle)?.map(|(_, stored)| stored);
        Ok(Self { file: AtomicFile::create(path)?, vehicle: vehicle.clone(), before })
    }

    /// Whether it is an earlier reference with the drive's day, and no calibration's.
    pub(crate) fn adds_a_day(&self) -> bool {
        self.before.is_some()
    }

    /// The error of a file that is not written.
    pub(crate) fn refused(&self, why: String) -> DriveError {
        refused(self.file.target(), why)
    }

    /// The complete file, to be given its name together with the others.
    /// Errors: nothing was learned in the drive of `driven_s`, or what was learned is not plausible; the file cannot be written.
    pub fn complete(
        mut self,
        calibrate_s: Option<f64>,
        driven_s: f64,
        learned: Taught,
    ) -> Result<AtomicFile, DriveError> {
        let target = self.file.target().to_owned();
        if let Some(before) = self.before.take() {
            let days = learned.days.unwrap_or(Err("expected wheel speeds in the drive and in the reference"));
            let days =
                days.map_err(|why| refused(&target, format!("no day was added to the reference: {why}")))?;
            self.file.append(before.with_days(&days).to_text().as_bytes())?;
            self.file.settle()?;
            return Ok(self.file);
        }
        if learned.is_nothing() {
            let seconds = calibrate_s.unwrap_or_default();
            let why = if driven_s + LOG_END_S < seconds {
                format!(
                    "the calibration of {seconds} s is longer than the drive of {driven_s:.1} s; expected --calibrate-s {} or a longer drive",
                    driven_s.floor()
                )
            } else {
                let assumed = if self.vehicle.assumes_wheelbase() {
                    ", and a wheelbase nearer than the one that the vehicle file assumes: itpms vehicle learn finds it in this drive"
                } else {
                    ""
                };
                format!("expected a road to learn from during the calibration of {seconds} s{assumed}")
            };
            return Err(refused(&target, format!("nothing was learned: {why}")));
        }
        let stored = self.stored(&learned).map_err(|problem| refused(&target, problem))?;
        self.file.append(stored.to_text().as_bytes())?;
        self.file.settle()?;
        Ok(self.file)
    }
}

impl Saving {
    fn stored(&self, learned: &Taught) -> Result<StoredReference, itpms_data::error::Problem> {
        let Taught { corners, wheel_speeds, torsion, suspension, days } = *learned;
        // By the log's date, where it has one: days are counted from there.
        let dated_s = days.and_then(Result::ok).map_or(0.0, |days| days.calibrated_unix_s);
        let learned_unix_s = if dated_s > 0.0 { dated_s as u64 } else { now_unix_s() };
        let torsion = if wheel_speeds.is_some() { torsion } else { [None; 4] };
        let stored = match (corners, wheel_speeds) {
            (None, Some(wheel_speeds)) => {
                StoredReference::of_wheel_speeds(&self.vehicle, wheel_speeds, learned_unix_s)
            }
            (corners, wheel_speeds) => {
                let corners = corners.ok_or(ReferenceProblem::Lacks("a corner"))?;
                StoredReference::new(&self.vehicle, corners, learned_unix_s)?
                    .with_wheel_speeds(wheel_speeds)
                    .with_suspension(suspension)
            }
        };
        Ok(stored.with_torsion(torsion))
    }
}

/// Stores what a fleet's calibration drive taught, or says why it taught nothing: it is a drive all the same.
/// Errors: the file cannot be written, or what was learned is not plausible.
pub fn teach(
    path: &Path,
    settings: &Settings,
    vehicle: &Vehicle,
    learned: Taught,
) -> Result<Option<String>, DriveError> {
    if learned.is_nothing() {
        let seconds = settings.calibrate_s.unwrap_or_default();
        return Ok(Some(format!(
            "a calibration drive of {seconds} s that taught nothing of the car: later drives start without it"
        )));
    }
    Saving::create(path, settings, vehicle)?
        .complete(settings.calibrate_s, f64::INFINITY, learned)?
        .commit()?;
    Ok(None)
}

/// The only clock of the program, for logs without a date. One that is wrong, before 1970 even, makes a reference with a wrong date, not a wrong
/// reference.
fn now_unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
