//! A drive kept in a file from one start of the monitor to the next, bit by bit.
//!
//! ```text
//! itpms-live-state 32 f6d0c1f2a5a1b1c3\n     format, checksum of the format and of everything below
//! postcard of the vehicle's identity, the regulation and the drive
//! ```
//!
//! Made and read by the engine's thread, written by the monitor. What is damaged, of another format, of another vehicle or
//! with other options is refused in words; its caller begins afresh and says so. The format carries the layout of the
//! estimator: a program with another layout has another number.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::out::{AtomicFile, RateGate};
use itpms_data::reference::{Unsealed, VehicleIdentity, seal, unsealed};
use itpms_drive::Drive;
use serde::{Deserialize, Serialize};

use crate::beside::BesideWatch;
use crate::drive::{Clock, DriveOptions, LiveDrive, Progress};
use crate::error::LiveError;
use crate::roughness::Roughness;

/// The format that is written, and the only one that is read.
pub const FORMAT: u32 = 36;

const MAGIC: &str = "itpms-live-state ";
/// The largest car takes some 400 kB.
const LONGEST_BYTES: u64 = 8 << 20;

/// Everything a drive needs to go on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SavedDrive {
    vehicle: (String, Option<String>, String),
    /// Settings that cannot change within a drive.
    regulation: String,
    pub(crate) sample_rate_hz: f64,
    pub(crate) corners: Vec<Corner>,
    gate: (f64, Option<f64>, f64),
    iri_m_per_km: [f64; 4],
    progress: Progress,
    drive: Box<Drive>,
}

impl SavedDrive {
    pub(crate) fn of(drive: &LiveDrive, options: &DriveOptions) -> Self {
        Self {
            vehicle: Default::default(),
            regulation: options.settings.regulation.label().to_owned(),
            sample_rate_hz: drive.clock.sample_rate_hz,
            corners: drive.clock.corners.clone(),
            gate: (options.settings.rate_hz, drive.gate.start_s, drive.gate.due),
            iri_m_per_km: drive.roughness.iri_m_per_km,
            progress: drive.progress.clone(),
            drive: drive.drive.clone(),
        }
    }

    /// The bytes of its file; `None` if they cannot be made, which a drive of ours always can.
    pub(crate) fn to_bytes(&self, vehicle: &Vehicle) -> Option<Vec<u8>> {
        let VehicleIdentity { name, id, parameters } = VehicleIdentity::of(vehicle);
        let saved = Self { vehicle: (name, id, parameters), ..self.clone() };
        let body = postcard::to_allocvec(&saved).ok()?;
        Some([seal(MAGIC, &FORMAT.to_string(), &body).as_bytes(), &body].concat())
    }

    /// The drive in the bytes of a file. Errors: in words: another file, a damaged one, another format, another vehicle, other options.
    pub fn parse(bytes: &[u8], vehicle: &Vehicle, options: &DriveOptions) -> Result<Self, String> {
        let (format, body) = unsealed(MAGIC, bytes).map_err(|error| match error {
            Unsealed::Foreign(found) => {
                format!("is no saved state: its beginning is {found:?}, expected {MAGIC:?}")
            }
            Unsealed::Damaged { found, expected } => {
                format!("is damaged: its checksum says {found:?}, expected {expected:?}")
            }
        })?;
        if format != FORMAT.to_string() {
            return Err(format!("has format {format}, expected {FORMAT}: another version of itpms wrote it"));
        }
        let saved: Self = postcard::from_bytes(body).map_err(|error| {
            format!("does not fit this version of itpms ({error}), though its format is {FORMAT}")
        })?;
        let (name, id, parameters) = saved.vehicle.clone();
        let ours = VehicleIdentity::of(vehicle);
        if (VehicleIdentity { name: name.clone(), id, parameters }).expect(&ours).is_err() {
            return Err(if name == ours.name {
                format!("is of a vehicle {name:?} with another id or other parameters")
            } else {
                format!("is of the vehicle {name:?}, expected {:?}", ours.name)
            });
        }
        let wanted = options.settings.regulation.label();
        if saved.regulation != wanted {
            return Err(format!("was made with {}, expected {wanted}", saved.regulation));
        }
        Ok(saved)
    }

    /// Whether a file begins as a saved state does, damaged or not, is empty or begins with zeros as a power cut may leave it, or
    /// is not there yet: no other is to be written over.
    pub fn is_one(path: &Path) -> bool {
        let mut beginning = Vec::new();
        match File::open(path) {
            Ok(file) => {
                let read = file.take(MAGIC.len() as u64).read_to_end(&mut beginning);
                let zeros = beginning.iter().all(|byte| *byte == 0);
                read.is_ok() && (zeros || MAGIC.as_bytes().starts_with(&beginning))
            }
            Err(error) => error.kind() == io::ErrorKind::NotFound,
        }
    }

    /// Reads a file. `None` if there is none yet. Errors: in words: it cannot be read, or as [`SavedDrive::parse`].
    pub fn read(path: &Path, vehicle: &Vehicle, options: &DriveOptions) -> Result<Option<Self>, String> {
        let read = || {
            let mut bytes = Vec::new();
            // One byte more than is taken shows that there are more.
            File::open(path)?.take(LONGEST_BYTES + 1).read_to_end(&mut bytes).map(|_| bytes)
        };
        match read() {
            Ok(bytes) if bytes.len() as u64 > LONGEST_BYTES => {
                Err(format!("is no saved state: more than {LONGEST_BYTES} bytes"))
            }
            Ok(bytes) => Self::parse(&bytes, vehicle, options).map(Some),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(format!("cannot be read: {error}")),
        }
    }

    /// The drive, to go on with the next row.
    pub(crate) fn resume(&self, vehicle: &Vehicle, options: &DriveOptions) -> Result<LiveDrive, LiveError> {
        let clock = Clock {
            sample_rate_hz: self.sample_rate_hz,
            corners: self.corners.clone(),
            wheel_speeds: self.has_wheel_speeds(),
        };
        let mut roughness = Roughness::new(&clock)?;
        roughness.iri_m_per_km = self.iri_m_per_km;
        let mut gate = RateGate::new(options.settings.rate_hz);
        let (rate_hz, start_s, due) = self.gate;
        // Published at another rate, the estimates begin a new count.
        if rate_hz == options.settings.rate_hz {
            (gate.start_s, gate.due) = (start_s, due);
        }
        let (drive, progress) = (self.drive.clone(), self.progress.clone());
        let beside = BesideWatch::new(vehicle, &clock, options);
        Ok(LiveDrive { clock, drive, gate, progress, roughness, beside, latest: None })
    }

    pub(crate) fn has_wheel_speeds(&self) -> bool {
        self.drive.radii().is_some()
    }

    pub(crate) fn has_pulses(&self) -> bool {
        self.drive.torsion().is_some()
    }

    pub fn drive(&self) -> &Drive {
        &self.drive
    }
}

/// Writes the bytes of a state. Killed or without power at any moment, the file is the one before or this, whole.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), LiveError> {
    Ok(AtomicFile::save(path, bytes)?)
}
