//! Whose drive a file is.
//!
//! One vehicle file: all drives are of that car. A folder of them: each `CAR.toml` is a car, with `CAR.reference` beside it
//! where it was calibrated before. A drive is a car's if one of the folders above it has the car's name, or if its own
//! name is the car's, alone or followed by `_`, `-`, `.` or a space. A drive of no car, or of two, belongs to no car.

use std::fs;
use std::path::{Path, PathBuf};

use itpms_data::Vehicle;
use itpms_data::reference::crc64;

use super::found::natural;
use crate::error::DriveError;

#[derive(Debug)]
pub struct Car {
    pub id: String,
    /// Its parameters, or why they cannot be used.
    pub vehicle: Result<Vehicle, String>,
    pub fingerprint: String,
    /// The result of an earlier calibration drive.
    pub reference: Option<PathBuf>,
}

#[derive(Debug)]
pub enum Cars {
    One(Box<Car>),
    /// A car per vehicle file, in natural order.
    Many(Vec<Car>),
}

impl Cars {
    /// The car that one vehicle file describes; it is called by its id, or else its name. Errors: the file cannot be used.
    pub fn one(path: &Path) -> Result<Self, DriveError> {
        let vehicle = Vehicle::read(path)?;
        let id = vehicle.id.clone().unwrap_or_else(|| vehicle.name.clone());
        Ok(Self::One(Box::new(Car {
            id,
            fingerprint: fingerprint(path),
            vehicle: Ok(vehicle),
            reference: None,
        })))
    }

    /// The cars whose vehicle files lie in a folder. A file that cannot be used is no error: its car's drives fail.
    /// Errors: the folder cannot be read, or holds no vehicle file.
    pub fn folder(path: &Path) -> Result<Self, DriveError> {
        let unreadable = |error| DriveError::Mismatch(format!("{}: cannot be read: {error}", path.display()));
        let mut cars = Vec::new();
        for entry in fs::read_dir(path).map_err(unreadable)? {
            let file = entry.map_err(unreadable)?.path();
            let (Some(stem), Some("toml")) = (file.file_stem(), file.extension().and_then(|e| e.to_str()))
            else {
                continue;
            };
            let reference = file.with_extension("reference");
            cars.push(Car {
                id: stem.to_string_lossy().into_owned(),
                vehicle: Vehicle::read(&file).map_err(|error| error.to_string()),
                fingerprint: fingerprint(&file),
                reference: reference.exists().then_some(reference),
            });
        }
        if cars.is_empty() {
            let path = path.display();
            return Err(DriveError::Mismatch(format!(
                "{path}: holds no vehicle file, expected CAR.toml for each car"
            )));
        }
        cars.sort_by(|a, b| natural(&a.id, &b.id));
        Ok(Self::Many(cars))
    }

    /// The car of a drive. Errors: a sentence about the drive: no car, or more than one.
    pub fn of(&self, drive: &Path) -> Result<&Car, String> {
        let cars = match self {
            Self::One(car) => return Ok(car),
            Self::Many(cars) => cars,
        };
        let folders: Vec<_> = drive.iter().rev().skip(1).map(|name| name.to_string_lossy()).collect();
        let stem = drive.file_stem().unwrap_or_default().to_string_lossy();
        // Of `A` and `A_1`, a file `A_1_drive` means the longer.
        let by_name = cars.iter().filter(|car| begins_with(&stem, &car.id)).max_by_key(|car| car.id.len());
        let by_folder = cars.iter().filter(|car| folders.iter().any(|folder| *folder == car.id));
        let mut found: Vec<&Car> = by_name.into_iter().chain(by_folder).collect();
        found.dedup_by_key(|car| &car.id);
        match found[..] {
            [car] => Ok(car),
            [] => Err(format!(
                "{}: no car's, expected a folder of the name of one of the {} vehicle files, or a file name that begins with it",
                drive.display(),
                cars.len()
            )),
            [one, other, ..] => {
                let [path, one, other] = [drive.to_string_lossy(), (&one.id).into(), (&other.id).into()];
                Err(format!("{path}: could be of {one:?} and of {other:?}, expected the name of one car"))
            }
        }
    }
}

/// Whether a file's name begins with a car's, and the next character is no part of one.
fn begins_with(stem: &str, id: &str) -> bool {
    stem.strip_prefix(id).is_some_and(|rest| rest.is_empty() || rest.starts_with(['_', '-', '.', ' ']))
}

fn fingerprint(path: &Path) -> String {
    fs::read(path).map(|bytes| format!("{:016x}", crc64(&[&bytes]))).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cars(ids: &[&str]) -> Cars {
        let car = |id: &&str| Car {
            id: (*id).to_owned(),
            vehicle: Ok(Vehicle::paper()),
            fingerprint: String::new(),
            reference: None,
        };
        Cars::Many(ids.iter().map(car).collect())
    }

    #[test]
    fn a_drive_is_the_car_of_its_folder_or_of_its_name() {
        let cars = cars(&["12", "123", "van", "van_2"]);
        let of = |path: &str| cars.of(Path::new(path)).map(|car| car.id.as_str());
        assert_eq!(of("logs/van/2026/drive.csv"), Ok("van"));
        assert_eq!(of("logs/12_drive.csv"), Ok("12"));
        assert_eq!(of("logs/123-drive.csv"), Ok("123"));
        assert_eq!(of("van.csv"), Ok("van"));
        assert_eq!(of("van_2_7.csv"), Ok("van_2"));
        assert_eq!(of("van/van_7.csv"), Ok("van"));
    }

    #[test]
    fn a_drive_of_no_car_or_of_two_is_nobodys() {
        let cars = cars(&["12", "van"]);
        let of = |path: &str| cars.of(Path::new(path)).unwrap_err();
        assert!(of("logs/120_drive.csv").starts_with("logs/120_drive.csv: no car's"));
        assert!(of("vans/drive.csv").contains("one of the 2 vehicle files"));
        assert_eq!(
            of("van/12_drive.csv"),
            "van/12_drive.csv: could be of \"12\" and of \"van\", expected the name of one car"
        );
        assert!(of("van/12/drive.csv").contains("could be of"));
    }
}
