//! The car, its rows, and the files of which nothing may be lost: made once for all faults, in a folder that is gone afterwards.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::{env, fs};

use itpms_core::model::Corner;
use itpms_data::{LogReader, LogRow, Vehicle};
use itpms_live::drive::DriveOptions;
use itpms_live::engine::Engine;
use itpms_live::input::{Say, SourceName};
use itpms_live::state::SavedDrive;
use tempfile::TempDir;

use crate::exit::Failure;
use crate::interrupt::Interrupt;

/// Rows per second: enough for everything, and quick.
pub(super) const RATE_HZ: f64 = 200.0;

/// Two minutes of a car on which nothing is wrong yet.
const DRIVE: &str = include_str!("../../../../../itpms-sim/scenarios/drive-diffusion.toml");

/// What faults are tried on.
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
        let mut drive: Vec<String> = DRIVE.lines().map(str::to_owned).collect();
        for line in &mut drive {
            if line.starts_with("rate_hz") {
                *line = format!("rate_hz = {RATE_HZ:.1}");
            } else if line.starts_with("duration_s") {
                *line = "duration_s = 120.0".to_owned();
            }
        }
        fs::write(at("drive.toml"), drive.join("\n")).map_err(failed)?;
        run(&folder, "simulate drive.toml -o drive.csv --vehicle-out car.toml --no-truth")?;
        for (length_s, name) in [(30, "old"), (60, "new")] {
            interrupt.check()?;
            run(
                &folder,
                &format!(
                    "estimate drive.csv --vehicle car.toml -o est.csv --calibrate-s {length_s} --save-reference {name}.calibration"
                ),
            )?;
        }
        let vehicle = Vehicle::read(&at("car.toml"))?;
        let rows: Vec<LogRow> = LogReader::open(&at("drive.csv"))?.collect::<Result<_, _>>()?;
        let subject = Self {
            vehicle,
            rows,
            states: [at("old.state"), at("new.state")],
            calibrations: [at("old.calibration"), at("new.calibration")],
            folder,
        };
        for (seconds, path) in [20.0, 40.0].into_iter().zip(&subject.states) {
            let mut engine = subject.engine(None, silent());
            for row in subject.rows.iter().take((seconds * RATE_HZ) as usize) {
                engine.take(row, None, &mut |_| {}).map_err(|error| Failure::Usage(error.to_string()))?;
            }
            fs::write(path, engine.saved().unwrap_or_default()).map_err(failed)?;
        }
        Ok(subject)
    }

    /// An engine of this car that waits for rows.
    pub(super) fn engine(&self, saved: Option<SavedDrive>, say: Say) -> Engine {
        let source = SourceName { name: "faults".to_owned(), kind: "replay" };
        let mut engine = Engine::new(self.vehicle.clone(), options(), source, saved, say);
        // Fails only for a car without these corners; the first row says so, too.
        let _ = engine.open(RATE_HZ, &Corner::ALL, false);
        engine
    }

    /// A new name in the folder of the subject.
    pub(super) fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

pub(super) fn options() -> DriveOptions {
    DriveOptions::default()
}

/// What is said to nobody.
pub(super) fn silent() -> Say {
    Arc::new(|_| {})
}

/// This very program, with other words.
pub(super) fn program() -> Result<Command, Failure> {
    let own = env::current_exe().map_err(|error| Failure::Usage(format!("this program: {error}")))?;
    let mut command = Command::new(own);
    command.stdin(Stdio::null()).stdout(Stdio::null());
    Ok(command)
}

fn run(folder: &TempDir, line: &str) -> Result<(), Failure> {
    let mut command = program()?;
    let output = command.current_dir(folder.path()).args(line.split_whitespace()).output();
    let output = output.map_err(|error| Failure::Usage(format!("this program: {error}")))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(Failure::Usage(format!("itpms {line}: {said}")))
}
