//! The car, its rows, and the files of which nothing may be lost: made once for all faults, in a folder that is gone afterwards.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::{env, fs};

use itpms_console::{Failure, Interrupt};
use itpms_core::model::Corner;
use itpms_data::out::WheelSpeedUse;
use itpms_data::{LogRow, Vehicle};
use itpms_drive::{Drive, Settings, reference, simulated};
use itpms_live::drive::DriveOptions;
use itpms_live::engine::Engine;
use itpms_live::input::{NoteSink, SourceName};
use itpms_live::state::SavedDrive;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use tempfile::TempDir;

/// Rows per second: enough for everything, and quick.
pub(super) const RATE_HZ: f64 = 200.0;

/// A car on which nothing is wrong in its first two minutes.
const DRIVE: &str = "drive-diffusion";
const DRIVE_S: f64 = 120.0;
/// Seconds of the older and of the newer calibration.
const CALIBRATIONS_S: [f64; 2] = [30.0, 60.0];

pub(super) struct Subject {
    pub(super) vehicle: Vehicle,
    pub(super) rows: Vec<LogRow>,
    /// An older and a newer state, and an older and a newer calibration.
    pub(super) states: [PathBuf; 2],
    pub(super) calibrations: [PathBuf; 2],
    folder: TempDir,
}

impl Subject {
    pub(super) fn new(interrupt: &Interrupt) -> Result<Self, Failure> {
        let made = TempDir::with_prefix("itpms-faults");
        let folder = made.map_err(|error| Failure::Directory(env::temp_dir(), error))?;
        let at = |name: &str| folder.path().join(name);
        let path = folder.path().to_owned();
        let failed = |error| Failure::Directory(path.clone(), error);
        let scenario = Scenario { rate_hz: RATE_HZ, duration_s: DRIVE_S, ..Scenario::builtin(DRIVE)? };
        let vehicle = simulated::vehicle_of(&scenario)?;
        let rows: Vec<LogRow> = Simulation::new(&scenario, 1)?.map(|row| simulated::log_row(&row)).collect();
        let calibrations = [at("old.calibration"), at("new.calibration")];
        for (length_s, path) in CALIBRATIONS_S.into_iter().zip(&calibrations) {
            interrupt.check()?;
            calibrate(&vehicle, &rows, length_s, path)?;
        }
        let subject =
            Self { vehicle, rows, states: [at("old.state"), at("new.state")], calibrations, folder };
        for (seconds, path) in [20.0, 40.0].into_iter().zip(&subject.states) {
            let mut engine = subject.engine(None, silent());
            for row in subject.rows.iter().take((seconds * RATE_HZ) as usize) {
                engine.take(row, None, &mut |_| {}).map_err(|error| Failure::Usage(error.to_string()))?;
            }
            fs::write(path, engine.saved().unwrap_or_default()).map_err(failed)?;
        }
        Ok(subject)
    }

    pub(super) fn engine(&self, saved: Option<SavedDrive>, notes: NoteSink) -> Engine {
        let source = SourceName { name: "faults".to_owned(), kind: "replay" };
        let mut engine = Engine::new(self.vehicle.clone(), options(), source, saved, notes);
        // Fails only for a car without these corners; the first row says so, too.
        let _ = engine.open(RATE_HZ, &Corner::ALL, false);
        engine
    }

    /// The older and the newer file of a kind.
    pub(super) fn files(&self, kind: &str) -> &[PathBuf; 2] {
        if kind == "state" { &self.states } else { &self.calibrations }
    }

    pub(super) fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

pub(super) fn options() -> DriveOptions {
    DriveOptions::default()
}

pub(super) fn silent() -> NoteSink {
    Arc::new(|_| {})
}

pub(super) fn program() -> Result<Command, Failure> {
    let own = env::current_exe().map_err(|error| Failure::Usage(format!("this program: {error}")))?;
    let mut command = Command::new(own);
    command.stdin(Stdio::null()).stdout(Stdio::null());
    Ok(command)
}

/// Drives `length_s` seconds as a calibration, and saves what they taught.
fn calibrate(vehicle: &Vehicle, rows: &[LogRow], length_s: f64, path: &Path) -> Result<(), Failure> {
    let settings = Settings { calibrate_s: Some(length_s), ..Settings::default() };
    let mut drive = Drive::new(&settings, vehicle, &Corner::ALL, WheelSpeedUse::default(), RATE_HZ)?;
    for mut row in rows.iter().copied() {
        drive.update(&mut row);
    }
    drive.finish(settings.calibrate_s);
    match reference::teach(path, &settings, vehicle, drive.learned())? {
        None => Ok(()),
        Some(why) => Err(Failure::Usage(why)),
    }
}
