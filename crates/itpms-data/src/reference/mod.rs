//! Calibration of a car, kept in a file from one drive to the next: which car, when, what, and a checksum.
//!
//! Called by the binary, and by whoever stores references on a vehicle. Knows files and vehicles, nothing of how a
//! reference is learned or used. What it hands out is whole, plausible and the very car's; anything else is refused with
//! the reason, and the caller decides whether to go on without a reference.
//!
//! ```text
//! itpms-reference 9 f6d0c1f2a5a1b1c3      format, checksum of the format and of everything below
//! [vehicle]
//! name = "mid-size sedan"
//! id = "WXY00000000000001"               # where the vehicle file has one
//! parameters = "5c0a9d4be1f20377"        # fingerprint of masses, springs, dampers, tires, placards, wheelbase
//! [learned]
//! unix_s = "1900000000"                  # when
//! driving_s = 600.0                      # from how much useful driving
//! wheelbase_m = 2.61                     # where the vehicle file's was assumed: the one the deviation counts from
//! wheelbase = 0.004                      # every quantity with its standard deviation
//! wheelbase_sd = 0.001
//! front_bar = 0.28                       # anti-roll bars, and rear_bar, rear_axle_coupling
//! front_bar_sd = 0.02
//! [learned.left]                         # and right: gain, skew_s
//! [corner.fl]                            # placard_kpa, unsprung_mass, damping, spring, spectrum_bias_kpa, shared_road_bias
//! [wheel_speeds]                         # of a car whose wheel speeds were read: how the tires' radii differ, with covariances
//! [days]                                 # what the days since then have shown of its wheel speeds, as sums over them
//! [suspension]                           # of a car with four corners: struts and body, for dampers and load
//! [torsion.fl]                           # of one whose tooth pulses were: resonance and shape of each wheel's spectrum over the speed
//! ```
//!
//! A reference of wheel speeds alone has no corners. A later program may change everything but the first line's shape, so that an older one can say that it is too old.

mod days;
mod identity;
pub(crate) mod problem;
mod suspension;
mod text;
mod torsion;
mod wheel_speeds;

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use itpms_core::model::{CalibrationError, Learned, VehicleCalibration};
use itpms_core::torsion::TorsionCalibration;
use itpms_core::wheel_speed::{RadiusCalibration, RadiusDays};
use itpms_files::AtomicFile;

use crate::error::{DataError, FileProblem, Problem};
use crate::vehicle::Vehicle;
pub use identity::VehicleIdentity;
pub use itpms_files::{Unsealed, crc64, seal, unsealed};
pub use problem::ReferenceProblem;
pub use suspension::{FRICTION_ELEMENTS, SuspensionReference};
pub use text::day;

/// The newest format that is read, and that of a reference with corners.
pub const FORMAT: u32 = 9;
/// The format of one of wheel speeds alone, with days and without.
const WITH_DAYS: u32 = 7;
const WITH_WHEEL_SPEEDS: u32 = 6;

/// Calibration of each wheel by tooth pulses, with the kPa by which its pressure was above the placard's.
pub type LearnedTorsion = [Option<(TorsionCalibration<f64>, f64)>; 4];

/// A file longer than this is not read to its end: it is something else.
const LONGEST_BYTES: u64 = 64 * 1024;

/// A kart's and a long truck's wheelbase in m.
fn is_a_cars(wheelbase_m: f64) -> bool {
    (1.0..=10.0).contains(&wheelbase_m)
}

fn implausible(error: CalibrationError, vehicle: &Vehicle, found_m: Option<f64>) -> ReferenceProblem {
    match (error, vehicle.wheelbase_m, found_m) {
        (CalibrationError::Implausible("wheelbase"), Some(file_m), Some(found_m)) => {
            ReferenceProblem::Wheelbase { found_m, file_m }
        }
        _ => ReferenceProblem::Implausible(error),
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct StoredReference {
    pub vehicle: VehicleIdentity,
    /// When the calibration was over, in s since 1970-01-01 UTC, as the caller's clock had it.
    pub learned_unix_s: u64,
    /// The wheelbase in m that was found, where the vehicle file's was assumed: what was learned counts from it.
    pub wheelbase_m: Option<f64>,
    /// Calibration of corners with accelerations; of no corner where there were none.
    pub reference: VehicleCalibration<f64>,
    pub wheel_speeds: Option<RadiusCalibration<f64>>,
    /// Calibration by tooth pulses, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL); never without wheel speeds.
    pub torsion: LearnedTorsion,
    /// Results of the wheel speeds on the days since then; none without wheel speeds.
    pub days: RadiusDays<f64>,
    /// Reference of struts and body, for dampers and load; never without corners.
    pub suspension: Option<SuspensionReference>,
}

impl StoredReference {
    /// What `vehicle` was found to be at the given time.
    /// Errors: the reference is not plausible, or of no corner: a bad one is never stored.
    pub fn new(
        vehicle: &Vehicle,
        mut reference: VehicleCalibration<f64>,
        learned_unix_s: u64,
    ) -> Result<Self, Problem> {
        let found_m = vehicle.wheelbase_m.map(|m| m * (1.0 + reference.wheelbase.value));
        let wheelbase_m = found_m.filter(|found_m| vehicle.assumes_wheelbase() && is_a_cars(*found_m));
        if wheelbase_m.is_some() {
            reference.wheelbase.value = 0.0;
        }
        reference.check().map_err(|error| implausible(error, vehicle, found_m))?;
        if reference.corners.iter().all(Option::is_none) {
            return Err(ReferenceProblem::Lacks("a corner").into());
        }
        let vehicle = VehicleIdentity::of(vehicle);
        let (wheel_speeds, days) = (None, RadiusDays::since(learned_unix_s as f64));
        let torsion = [None; 4];
        let suspension = None;
        Ok(Self { vehicle, learned_unix_s, wheelbase_m, reference, wheel_speeds, torsion, days, suspension })
    }

    /// What the wheel speeds of `vehicle` were found to be at the given time, its accelerations not being known.
    pub fn of_wheel_speeds(vehicle: &Vehicle, learned: RadiusCalibration<f64>, learned_unix_s: u64) -> Self {
        Self {
            vehicle: VehicleIdentity::of(vehicle),
            learned_unix_s,
            wheelbase_m: None,
            reference: nothing_of_corners(),
            wheel_speeds: Some(learned),
            torsion: [None; 4],
            days: RadiusDays::since(learned_unix_s as f64),
            suspension: None,
        }
    }

    pub fn with_wheel_speeds(self, wheel_speeds: Option<RadiusCalibration<f64>>) -> Self {
        Self { wheel_speeds, ..self }
    }

    /// The same with what was learned of struts and body.
    pub fn with_suspension(self, suspension: Option<SuspensionReference>) -> Self {
        Self { suspension, ..self }
    }

    /// The same with what was learned of tooth pulses.
    pub fn with_torsion(self, torsion: LearnedTorsion) -> Self {
        Self { torsion, ..self }
    }

    /// The same after another day.
    pub fn with_days(self, days: &RadiusDays<f64>) -> Self {
        let calibrated_unix_s = self.days.calibrated_unix_s;
        Self { days: RadiusDays { calibrated_unix_s, ..*days }, ..self }
    }

    /// Whether anything was learned of corners with accelerations.
    pub fn has_corners(&self) -> bool {
        self.reference.corners.iter().any(Option::is_some)
    }

    /// What `vehicle` is to be given, if this was learned on it, and the vehicle from whose parameters that counts: itself, but for a
    /// wheelbase that was assumed.
    /// Errors: another name, another id, or other parameters: deviations from one set of parameters say nothing of another.
    pub fn for_vehicle(&self, vehicle: &Vehicle) -> Result<(Vehicle, &VehicleCalibration<f64>), Problem> {
        self.vehicle.expect(&VehicleIdentity::of(vehicle))?;
        let wheelbase_m = self.wheelbase_m.or(vehicle.wheelbase_m);
        Ok((Vehicle { wheelbase_m, ..vehicle.clone() }, &self.reference))
    }

    /// The bytes of its file.
    pub fn to_text(&self) -> String {
        text::sealed(self)
    }

    /// The reference in the bytes of a file. Checks everything but the vehicle, for which see
    /// [`StoredReference::for_vehicle`]. Errors: another file, a damaged one, a newer format, or numbers that no car has.
    pub fn parse(bytes: &[u8]) -> Result<Self, Problem> {
        let stored = text::opened(bytes)?;
        stored.reference.check().map_err(ReferenceProblem::Implausible)?;
        if !stored.wheel_speeds.as_ref().is_none_or(RadiusCalibration::is_sane) {
            return Err(ReferenceProblem::Lacks("wheel speeds that a car has").into());
        }
        if !stored
            .torsion
            .iter()
            .flatten()
            .all(|(learned, above_kpa)| learned.is_sane() && above_kpa.abs() < 1e4)
        {
            return Err(ReferenceProblem::Lacks("a torsion that a tire has").into());
        }
        Ok(stored)
    }

    /// Writes the file. Killed or without power at any moment, `path` holds what it held before or this, whole; what
    /// is left beside it does not disturb and goes with the next save.
    pub fn save(&self, path: &Path) -> Result<(), DataError> {
        Ok(AtomicFile::save(path, self.to_text().as_bytes())?)
    }

    /// Reads a file. Errors: it cannot be read; and as [`StoredReference::parse`].
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let read = || {
            let mut bytes = Vec::new();
            // One byte more than is taken shows that there are more.
            File::open(path)?.take(LONGEST_BYTES + 1).read_to_end(&mut bytes).map(|_| bytes)
        };
        let fail = |problem: Problem| DataError::new(path, problem);
        match read() {
            Ok(bytes) if bytes.len() as u64 > LONGEST_BYTES => {
                let found = format!("that of a file of more than {LONGEST_BYTES} bytes");
                Err(fail(ReferenceProblem::Foreign { found }.into()))
            }
            Ok(bytes) => Self::parse(&bytes).map_err(fail),
            Err(_) if path.is_dir() => Err(fail(FileProblem::IsDirectory.into())),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(fail(FileProblem::NotFound.into())),
            Err(error) => Err(fail(FileProblem::Read(error).into())),
        }
    }

    /// The day it was learned, `2026-03-01`, UTC.
    pub fn day(&self) -> String {
        text::day(self.learned_unix_s)
    }
}

/// The corners of a reference of a car without accelerations.
fn nothing_of_corners() -> VehicleCalibration<f64> {
    let nothing = Learned { value: 0.0, sd: 1.0 };
    VehicleCalibration {
        corners: [None; 4],
        bar: [nothing; 2],
        rear_axle_coupling: nothing,
        gain: [nothing; 2],
        wheelbase: nothing,
        skew_s: [nothing; 2],
        learned_s: 1.0,
    }
}
