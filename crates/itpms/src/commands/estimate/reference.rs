//! The learned reference of a car: told to the estimator before the drive, stored after a reset.
//!
//! A reference that was asked for and cannot be used ends the command: whoever names a file wants its contents to count.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use itpms_core::estimator::EstimatorKind;
use itpms_core::model::{CalibrationError, VehicleCalibration};
use itpms_core::monitor::MonitoredCar;
use itpms_data::Vehicle;
use itpms_data::out::AtomicFile;
use itpms_data::reference::StoredReference;

use crate::args::EstimateArgs;
use crate::exit::Failure;
use crate::screen::Screen;

/// Loads what the car learned on an earlier drive, if `--reference` names a file.
pub(super) fn load(
    args: &EstimateArgs,
    vehicle: &Vehicle,
    car: &mut MonitoredCar<f64>,
) -> Result<(), Failure> {
    let Some(path) = &args.reference else { return Ok(()) };
    expect_informed(args, "--reference")?;
    let stored = StoredReference::read(path)?;
    let reference = stored.for_vehicle(vehicle).map_err(|problem| refused(path, problem))?;
    car.load_calibration(reference).map_err(|error: CalibrationError| {
        refused(path, format!("the learned reference does not fit the drive: {error}"))
    })
}

fn refused(path: &Path, why: impl std::fmt::Display) -> Failure {
    Failure::Usage(format!("{}: {why}", path.display()))
}

fn expect_informed(args: &EstimateArgs, option: &str) -> Result<(), Failure> {
    if args.estimator == EstimatorKind::Informed {
        return Ok(());
    }
    let (used, learns) = (args.estimator.label(), EstimatorKind::Informed.label());
    Err(Failure::Usage(format!("{option} with --estimator {used}: only {learns} learns from a reset")))
}

/// The file of `--save-reference` in the making.
pub(super) struct Saving {
    file: AtomicFile,
    vehicle: Vehicle,
}

impl Saving {
    /// Starts the file, if it is wanted.
    pub(super) fn create(args: &EstimateArgs, vehicle: &Vehicle) -> Result<Option<Self>, Failure> {
        let Some(path) = &args.save_reference else { return Ok(None) };
        expect_informed(args, "--save-reference")?;
        Ok(Some(Self { file: AtomicFile::create(path)?, vehicle: vehicle.clone() }))
    }

    /// The complete file, to be given its name together with the others.
    pub(super) fn complete(
        mut self,
        args: &EstimateArgs,
        learned: Option<VehicleCalibration<f64>>,
    ) -> Result<AtomicFile, Failure> {
        let target = self.file.target().to_owned();
        let Some(learned) = learned else {
            return Err(refused(
                &target,
                format!(
                    "nothing was learned: expected a drive that goes on after the reset of {} s, and in it a road to learn from",
                    args.calibrate_s.unwrap_or_default()
                ),
            ));
        };
        let stored = StoredReference::new(&self.vehicle, learned, now_unix_s());
        let stored = stored.map_err(|problem| refused(&target, problem))?;
        self.file.append(stored.to_text().as_bytes())?;
        self.file.settle()?;
        Ok(self.file)
    }
}

/// What a person should know of the references of this drive.
pub(super) fn remark(args: &EstimateArgs, screen: &Screen) {
    if let Some(path) = &args.save_reference {
        screen.remark(format!(
            "{}: holds what the reset taught of this car; valid until tires, springs, dampers or sensors are changed",
            path.display()
        ));
    }
}

/// The only clock of the program. One that is wrong, before 1970 even, makes a reference with a wrong date, not a wrong
/// reference.
fn now_unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
