//! The record of a drive, and its file: a line of JSON for every drive that is done, under a line that
//! says by what program and with what settings.

use std::collections::BTreeMap;
use std::path::Path;

use itpms_core::wheel_speed::RadiusDay;
use itpms_data::out::Ledger;
use itpms_data::reference::crc64;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Plan;
use crate::error::DriveError;
use crate::reference::Taught;

/// Key of the lines that say what the lines after them were computed with.
const KEY: &str = "itpms_fleet";

/// The radii of a drive's day since the calibration with which it began.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DayRecord {
    pub day: f64,
    /// Changes of the three ratios of radii in thousandths, with their covariance.
    pub change_1e3: [f64; 3],
    /// 00, 10, 11, 20, 21, 22.
    pub covariance_1e6: [f64; 6],
}

impl DayRecord {
    /// That of a drive which has a date, and has shown something.
    pub(super) fn of(taught: &Taught) -> Option<Self> {
        let days = taught.days?.ok().filter(|days| !days.is_empty())?;
        let RadiusDay { day, change_1e3, covariance_1e6 } = days.newest;
        Some(Self { day, change_1e3, covariance_1e6 })
    }
}

/// The inputs of a drive's results; with the same ones it is not estimated again.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Inputs {
    pub bytes: u64,
    pub modified: String,
    pub vehicle: String,
    pub calibrate: bool,
    /// Checksum of the stored reference it starts with, if it does.
    pub reference: Option<String>,
    /// Length and time of the table of tooth pulses beside it, if there is one.
    pub pulses: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pressure {
    pub time_s: f64,
    pub pressure_kpa: f64,
    pub sd_kpa: f64,
}

/// The loss of a tire since the calibration by wheel speeds alone, as shares of its pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Loss {
    pub share: f64,
    pub sd: f64,
    /// The smallest loss that would have shown.
    pub detectable: f64,
}

/// The results of one wheel in a drive.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct WheelRecord {
    /// `fl`, `fr`, `rl` or `rr`.
    pub wheel: String,
    pub placard_kpa: f64,
    /// The monitor's word at the end: `unknown`, `uncertain`, `fine`, `low`, `over` or `malfunction`.
    pub state: String,
    /// The last row's warning: `none`, `low` or `malfunction`.
    pub warning: String,
    pub last: Option<Pressure>,
    /// The valid pressure with the lowest upper end of its 95 % interval.
    pub lowest: Option<Pressure>,
    /// Share of the rows in which the pressure was valid.
    pub share_valid: f64,
    /// How often `low` was begun to be warned of, and when first, in s.
    pub warnings: u32,
    pub first_warning_s: Option<f64>,
    /// How often `malfunction` was begun to be warned of.
    pub malfunctions: u32,
    pub first_malfunction_s: Option<f64>,
    /// Its result by wheel speeds alone at the end.
    pub lost: Option<Loss>,
    /// Mean roughness of the road under it, in m/km.
    pub iri_m_per_km: Option<f64>,
    /// How well body and wheel go together.
    pub fit: Option<FitRecord>,
    #[serde(default)]
    pub damper: Option<DamperRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DamperRecord {
    /// `learning`, `fine`, `weak`, `worn`, `stiff` or `unknown`.
    pub state: String,
    /// Damping over that after the calibration.
    pub over_reference: Option<f64>,
    /// Left over right of its axle, less one.
    pub left_right: Option<f64>,
    /// Drives in a row that found it, and whether it is reported.
    #[serde(skip)]
    pub row: u32,
    /// See above.
    #[serde(skip)]
    pub reported: bool,
}

/// How well body and wheel of a corner go together; what was not seen long enough is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitRecord {
    /// Share of the body's acceleration, 5 to 16 Hz, that does not go with the wheel's.
    pub incoherence: Option<f64>,
    /// Share of the body's acceleration, 5 to 20 Hz, that the forces of all four corners leave unexplained.
    pub unexplained: Option<f64>,
    /// How much more front and rear disagree about their road near wheel hop than beside it.
    pub hop_excess: Option<f64>,
    pub friction_n: f64,
    /// The misfit: `incoherent`, `unexplained` or `hop`.
    pub misfit: Option<String>,
}

/// Roughness of a piece of road by one drive: latitude and longitude of its middle in 1e-7 degrees, mean roughness in m/km, and the length in m
/// that it rests on, of all wheels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RoadPiece(pub [i32; 2], pub f32, pub f32);

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DriveRecord {
    pub file: String,
    pub car: String,
    pub vehicle: String,
    pub inputs: Inputs,
    /// Whether it is a calibration drive that taught something, for later drives to start with.
    pub taught: bool,
    pub start_s: f64,
    /// The log's time in s that all times count from: 0, or the first row's if that is more than a day.
    pub origin_s: f64,
    /// From the first row to the last, in s.
    pub duration_s: f64,
    pub rate_hz: f64,
    /// Distance in m; `None` where the speed was never known.
    pub distance_m: Option<f64>,
    pub wheels: Vec<WheelRecord>,
    /// The wheels of the vehicle file that were not.
    #[serde(default)]
    pub not_estimated: Vec<String>,
    /// The monitor's reports, a sentence each.
    pub alerts: Vec<String>,
    pub concerns: Vec<String>,
    /// The radii of its day since the calibration, by wheel speeds and where it has a date.
    pub day: Option<DayRecord>,
    /// Findings beside pressures and dampers as text, each with whether it needs attention.
    #[serde(default)]
    pub beside: Vec<(String, bool)>,
    /// The roads it drove on, piece by piece in the order of its way, where a map was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub road: Option<Vec<RoadPiece>>,
    /// Its report and its estimates, as paths within the folder of the results.
    pub report: Option<String>,
    pub estimates: Option<String>,
}

impl DriveRecord {
    /// Its part in the calibration: `drive` (it taught the car), `carried` (it starts with what an earlier one taught) or `none`.
    pub fn calibration(&self) -> &'static str {
        match (self.taught, &self.inputs.reference) {
            (true, _) => "drive",
            (false, Some(_)) => "carried",
            (false, None) => "none",
        }
    }
}

#[derive(Debug)]
pub(super) struct Records {
    ledger: Ledger,
    drives: BTreeMap<String, DriveRecord>,
    /// Lines that are not as they were written.
    pub(super) damaged: usize,
}

impl Records {
    /// Opens or begins the file. What was computed with another program or other settings is not taken, and stays there.
    pub(super) fn open(path: &Path, heading: Value) -> Result<Self, DriveError> {
        let (ledger, lines) = Ledger::open(path)?;
        let mut records = Self { ledger, drives: BTreeMap::new(), damaged: 0 };
        let mut ours = false;
        for line in &lines {
            let found: Value = serde_json::from_str(line).unwrap_or(Value::Null);
            if found.get(KEY).is_some() {
                ours = found == heading;
            } else if ours {
                let drive = unsealed(line).and_then(|text| serde_json::from_str::<DriveRecord>(&text).ok());
                match drive {
                    Some(drive) => drop(records.drives.insert(drive.file.clone(), drive)),
                    None => records.damaged += 1,
                }
            }
        }
        if !ours {
            records.ledger.append(&heading.to_string())?;
        }
        Ok(records)
    }

    /// Whether this drive is done, from these inputs, and its files are there where they are wanted. With a report, or a map, its roughness is
    /// another one than without.
    pub(super) fn holds(&self, name: &str, inputs: &Inputs, out: &Path, plan: &Plan) -> bool {
        let there = |file: &Option<String>| file.as_ref().is_some_and(|file| out.join(file).is_file());
        self.of(name).is_some_and(|drive| {
            drive.inputs == *inputs
                && drive.road.is_some() == plan.map
                && (if plan.reports { there(&drive.report) } else { drive.report.is_none() })
                && (!plan.estimates || there(&drive.estimates))
                && (!drive.taught || super::reference_path(out, Path::new(name)).is_file())
        })
    }

    pub(super) fn of(&self, name: &str) -> Option<&DriveRecord> {
        self.drives.get(name)
    }

    pub(super) fn add(&mut self, drive: DriveRecord) -> Result<(), DriveError> {
        let text = serde_json::to_string(&drive);
        let text = text.map_err(|error| DriveError::Mismatch(format!("{}: no JSON: {error}", drive.file)))?;
        self.ledger.append(&sealed(&text))?;
        self.drives.insert(drive.file.clone(), drive);
        Ok(())
    }
}

/// How the checksum ends a line of JSON.
const SEAL: &str = ",\"checksum\":\"";

/// An object of JSON with the checksum of its text as its last key.
fn sealed(object: &str) -> String {
    let open = object.strip_suffix('}').unwrap_or(object);
    format!("{open}{SEAL}{:016x}\"}}", crc64(&[object.as_bytes()]))
}

/// The object without the checksum, if that fits.
fn unsealed(line: &str) -> Option<String> {
    let (open, seal) = line.rsplit_once(SEAL)?;
    let object = format!("{open}}}");
    let expected = format!("{:016x}\"}}", crc64(&[object.as_bytes()]));
    (seal == expected).then_some(object)
}

/// A drive that says this of one damper and nothing else.
#[cfg(test)]
pub(super) fn sample(name: &str, state: &str, over: f64) -> DriveRecord {
    let (state, over_reference, left_right) = (state.to_owned(), Some(over), Some(over - 1.0));
    let wheel = WheelRecord {
        wheel: name.to_owned(),
        placard_kpa: 240.0,
        state: "fine".to_owned(),
        warning: "none".to_owned(),
        share_valid: 1.0,
        damper: Some(DamperRecord { state, over_reference, left_right, row: 0, reported: false }),
        ..WheelRecord::default()
    };
    DriveRecord {
        file: "d.csv".to_owned(),
        car: "car".to_owned(),
        vehicle: "car".to_owned(),
        duration_s: 200.0,
        rate_hz: 200.0,
        wheels: vec![wheel],
        ..DriveRecord::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_changed_character_of_a_line_is_believed() {
        let object = r#"{"file":"a.csv","pressure_kpa":138.25}"#;
        let line = sealed(object);
        assert_eq!(unsealed(&line).as_deref(), Some(object));
        assert!(serde_json::from_str::<Value>(&line).is_ok());
        for place in 0..line.len() {
            let mut bytes = line.clone().into_bytes();
            bytes[place] ^= 1;
            let text = String::from_utf8_lossy(&bytes);
            assert_eq!(unsealed(&text), None, "{text}");
        }
        assert_eq!(unsealed(object), None);
    }
}
