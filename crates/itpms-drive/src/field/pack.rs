//! The archive that an owner hands on: the log's known columns, the vehicle file and a manifest, without what tells whose car it is and where
//! it was.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use itpms_data::Vehicle;
use itpms_data::log::{LogColumns, LogRow, PositionColumns, Slot};
use serde_json::Value;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::error::DriveError;

pub(super) const LOG: &str = "drive.csv";
pub(super) const VEHICLE: &str = "vehicle.toml";
pub(super) const MANIFEST: &str = "manifest.json";
/// Decimals of a value: a millionth of a second, of a metre per second and of a metre per second squared are below what any sensor shows.
const DECIMALS: usize = 6;
/// Letters and digits of a vehicle identification number (ISO 3779).
const VIN_LENGTH: usize = 17;

/// An archive in the making: rows first, the rest when all is known.
pub(super) struct Pack {
    archive: ZipWriter<Cursor<Vec<u8>>>,
    columns: LogColumns,
    line: String,
}

impl Pack {
    pub(super) fn begin(columns: &LogColumns) -> Result<Self, DriveError> {
        let columns = without_places(*columns);
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        archive.start_file(LOG, options()).map_err(failed)?;
        let names: Vec<String> = columns.slots().map(Slot::name).collect();
        writeln!(archive, "{}", names.join(",")).map_err(|error| failed(error.into()))?;
        Ok(Self { archive, columns, line: String::new() })
    }

    pub(super) fn columns(&self) -> Vec<String> {
        self.columns.slots().map(Slot::name).collect()
    }

    /// Adds a row, at this time in s since the first one.
    pub(super) fn row(&mut self, row: &LogRow, time_s: f64) -> Result<(), DriveError> {
        self.line.clear();
        for (i, slot) in self.columns.slots().enumerate() {
            if i > 0 {
                self.line.push(',');
            }
            let value = if slot == Slot::Time { time_s } else { row.value(slot) };
            if value.is_finite() {
                let _ = write!(self.line, "{value:.DECIMALS$}");
                self.line.truncate(self.line.trim_end_matches('0').trim_end_matches('.').len());
            }
        }
        self.line.push('\n');
        self.archive.write_all(self.line.as_bytes()).map_err(|error| failed(error.into()))
    }

    pub(super) fn finish(mut self, vehicle: &Vehicle, manifest: &Value) -> Result<Vec<u8>, DriveError> {
        for (name, text) in [(VEHICLE, anonymous(vehicle).to_toml()), (MANIFEST, format!("{manifest:#}\n"))] {
            self.archive.start_file(name, options()).map_err(failed)?;
            self.archive.write_all(text.as_bytes()).map_err(|error| failed(error.into()))?;
        }
        Ok(self.archive.finish().map_err(failed)?.into_inner())
    }
}

/// The archive of the same log is the same bytes: no clock.
fn options() -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
}

fn failed(error: ZipError) -> DriveError {
    DriveError::Log(format!("the archive cannot be made: {error}"))
}

/// Columns without those that tell where the car was: with a map of heights, its altitude does.
fn without_places(mut columns: LogColumns) -> LogColumns {
    columns.motion.position = PositionColumns::Absent;
    columns.motion.air.altitude = false;
    columns
}

/// Names of the parts of a log and a vehicle file that are not in the archive.
pub(super) fn left_out(columns: &LogColumns, vehicle: &Vehicle) -> Vec<String> {
    let mut out = Vec::new();
    if columns.motion.position != PositionColumns::Absent {
        out.extend(["latitude_deg", "longitude_deg"].map(str::to_owned));
    }
    if columns.motion.air.altitude {
        out.push("altitude_m".to_owned());
    }
    if vehicle.id.is_some() {
        out.push("the vehicle file's id".to_owned());
    }
    if without_vin(&vehicle.name) != vehicle.name {
        out.push("the identification number in the vehicle's name".to_owned());
    }
    if vehicle.learned.is_some() {
        out.push("the names of the drives that the vehicle file was learned from".to_owned());
    }
    if vehicle.details.home_altitude_m.is_some() {
        out.push("the vehicle file's home_altitude_m".to_owned());
    }
    out
}

/// The same vehicle without what tells which one it is, and where it lives.
fn anonymous(vehicle: &Vehicle) -> Vehicle {
    let mut vehicle = vehicle.clone();
    vehicle.id = None;
    vehicle.name = without_vin(&vehicle.name);
    vehicle.learned = vehicle.learned.map(|_| "drives at known pressures".to_owned());
    vehicle.details.home_altitude_m = None;
    vehicle
}

/// A text in which every word that may be a vehicle identification number is `(removed)`.
pub(super) fn without_vin(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while !rest.is_empty() {
        let word = rest.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(rest.len());
        out.push_str(if is_vin(&rest[..word]) { "(removed)" } else { &rest[..word] });
        let next =
            rest[word..].find(|c: char| c.is_ascii_alphanumeric()).map_or(rest.len(), |next| word + next);
        out.push_str(&rest[word..next]);
        rest = &rest[next..];
    }
    out
}

/// Seventeen letters and digits without I, O and Q, a digit among them.
fn is_vin(word: &str) -> bool {
    word.len() == VIN_LENGTH
        && word
            .chars()
            .all(|c| c.is_ascii_alphanumeric() && !matches!(c.to_ascii_uppercase(), 'I' | 'O' | 'Q'))
        && word.chars().any(|c| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identification_numbers_are_found_within_names() {
        // The example of ISO 3779's check digit in 49 CFR 565, and a common test number.
        for vin in ["1M8GDM9AXKP042788", "wvwzzz1jzxw000001"] {
            assert_eq!(without_vin(&format!("Golf ({vin}), blue")), "Golf ((removed)), blue");
            assert_eq!(without_vin(&format!("{vin}.csv")), "(removed).csv");
        }
        for text in ["mid-size sedan", "205/55R16 on 7J", "ABCDEFGHJKLMNPRST", "12345678901234567890", "é 1"]
        {
            assert_eq!(without_vin(text), text);
        }
    }
}
