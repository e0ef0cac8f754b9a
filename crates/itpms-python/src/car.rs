//! An estimator under its monitor, sample by sample, that can be saved and go on later.

use std::path::PathBuf;

use itpms_core::model::Corner;
use itpms_data::log::{Field, LogColumns, SLOTS, Slot};
use itpms_data::out::{EstimateRow, WheelSpeedUse, alert_object, state_label};
use itpms_data::reference::crc64;
use itpms_data::{LogRow, Vehicle as CarFile};
use itpms_drive::reference::Saving;
use itpms_drive::{Drive, Settings};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::{Value, json};

use crate::columns::{self, Packed, Words, numbers};
use crate::errors::{self, Kind, raise};
use crate::found::Found;
use crate::options::Options;
use crate::vehicle::Vehicle;
use crate::work;

/// Rows between two looks for Ctrl-C.
const ROWS_PER_LOOK: usize = 4096;
/// How a saved state begins: what it is, its format and the program's version, which has to be the same.
const MAGIC: &str = concat!("itpms-car 1 ", env!("CARGO_PKG_VERSION"), " ");

/// A running estimator.
#[pyclass(module = "itpms._itpms")]
pub(crate) struct Car {
    drive: Box<Drive>,
    corners: Vec<Corner>,
    rate_hz: f64,
    vehicle: CarFile,
    settings: Settings,
}

#[pymethods]
impl Car {
    #[new]
    fn new(
        py: Python<'_>,
        vehicle: &Vehicle,
        rate_hz: f64,
        corners: Vec<String>,
        options: Options,
    ) -> PyResult<Self> {
        let (settings, vehicle) = (options.settings(py)?, vehicle.0.clone());
        let corners = corners.iter().map(|name| corner(py, &vehicle, name)).collect::<PyResult<Vec<_>>>()?;
        let made = work::run(py, &None, |_| {
            Drive::new(&settings, &vehicle, &corners, wheel_speeds(&corners), rate_hz).map(Box::new)
        })?;
        let drive = made.map_err(|error| errors::drive(py, &error))?;
        Ok(Self { drive, corners, rate_hz, vehicle, settings })
    }

    /// Takes samples: names and bytes. Gives the estimates after each, names and bytes, and the warnings, names and words.
    fn update<'py>(&mut self, py: Python<'py>, given: Packed<'py>) -> PyResult<(Packed<'py>, Words)> {
        let samples = Samples::new(py, &self.corners, &given)?;
        let has_temperature = samples.there.motion.air.temperature;
        let mut found = Found::new(&self.corners, wheel_speeds(&self.corners), has_temperature, samples.rows);
        let mut from = 0;
        while from < samples.rows {
            py.check_signals()?;
            let to = (from + ROWS_PER_LOOK).min(samples.rows);
            py.detach(|| {
                for i in from..to {
                    let mut row = samples.row(i);
                    let estimate = self.drive.update(&mut row);
                    let states = self.drive.report().wheels.map(|wheel| wheel.map(|wheel| wheel.state));
                    found.push(&EstimateRow {
                        time_s: row.time_s,
                        estimates: &estimate.corners,
                        states: &states,
                        radii: self.drive.radii().as_ref(),
                    });
                }
            });
            from = to;
        }
        Ok((columns::all(py, &found.numbers)?, found.words))
    }

    /// Each wheel's state and the alerts that stand, as JSON.
    fn status(&self) -> String {
        let report = self.drive.report();
        let shown = if self.corners.is_empty() { &Corner::ALL[..] } else { &self.corners };
        let states: serde_json::Map<String, Value> = shown
            .iter()
            .map(|corner| {
                let state = state_label(report.wheels[corner.index()].map(|wheel| wheel.state));
                (corner.label().to_owned(), json!(state))
            })
            .collect();
        let alerts: Vec<Value> = report.alerts().map(|alert| Value::Object(alert_object(alert))).collect();
        json!({ "states": states, "alerts": alerts }).to_string()
    }

    /// Stores what the calibration drive taught.
    fn save_reference(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let saving = Saving::create(&path, &self.settings, &self.vehicle);
        let stored = saving
            .and_then(|saving| {
                saving.complete(self.settings.calibrate_s, self.drive.length_s(), self.drive.learned())
            })
            .and_then(|file| Ok(file.commit()?));
        stored.map_err(|error| errors::drive(py, &error))
    }

    /// All of it as bytes.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let labels: Vec<&str> = self.corners.iter().map(|corner| corner.label()).collect();
        let saved = (&self.drive, labels, self.rate_hz, self.settings.calibrate_s, self.vehicle.to_toml());
        let body = postcard::to_stdvec(&saved)
            .map_err(|error| raise(py, Kind::Output, format!("the state cannot be saved: {error}")))?;
        let head = format!("{MAGIC}{:016x}\n", crc64(&[&body]));
        Ok(PyBytes::new(py, &[head.as_bytes(), &body].concat()))
    }

    /// The estimator whose bytes these are; `name` is what messages call them.
    #[staticmethod]
    fn of_state(py: Python<'_>, name: &str, state: &[u8]) -> PyResult<Self> {
        let refuse = |what: String| raise(py, Kind::Setting, format!("{name}: {what}"));
        let known = state.strip_prefix(MAGIC.as_bytes());
        let Some((seal, body)) = known.and_then(|rest| rest.split_at_checked(17)) else {
            let version = env!("CARGO_PKG_VERSION");
            return Err(refuse(format!("is no car saved by itpms {version}, which is what this is")));
        };
        if seal != format!("{:016x}\n", crc64(&[body])).as_bytes() {
            return Err(refuse("the saved car is damaged: its checksum does not fit".to_owned()));
        }
        type Saved = (Box<Drive>, Vec<String>, f64, Option<f64>, String);
        let read = work::run(py, &None, |_| postcard::from_bytes::<Saved>(body))?;
        let (drive, corners, rate_hz, calibrate_s, vehicle) =
            read.map_err(|error| refuse(format!("the saved car cannot be read: {error}")))?;
        let vehicle = CarFile::parse(&vehicle).map_err(|problem| refuse(problem.to_string()))?;
        let corners = corners.iter().map(|name| corner(py, &vehicle, name)).collect::<PyResult<Vec<_>>>()?;
        let settings = Settings { calibrate_s, ..Settings::default() };
        Ok(Self { drive, corners, rate_hz, vehicle, settings })
    }

    /// The labels of the corners.
    fn corners(&self) -> Vec<&'static str> {
        self.corners.iter().map(|corner| corner.label()).collect()
    }

    #[getter]
    fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle(self.vehicle.clone())
    }
}

/// A car without corners with accelerations is one of wheel speeds.
fn wheel_speeds(corners: &[Corner]) -> WheelSpeedUse {
    if corners.is_empty() { WheelSpeedUse::Alone } else { WheelSpeedUse::None }
}

/// The corner of this label, if the vehicle has it.
fn corner(py: Python<'_>, vehicle: &CarFile, label: &str) -> PyResult<Corner> {
    let named = Corner::ALL.into_iter().find(|corner| corner.label() == label);
    let refuse = |what: String| raise(py, Kind::Setting, what);
    let corner = named.ok_or_else(|| refuse(format!("corner {label:?}, expected fl, fr, rl or rr")))?;
    if vehicle.corner(corner).is_none() {
        return Err(refuse(format!("corner {label} is not in the vehicle {:?}", vehicle.name)));
    }
    Ok(corner)
}

/// Samples by the slots of a log's row.
struct Samples {
    there: LogColumns,
    columns: [Option<Vec<f64>>; SLOTS],
    rows: usize,
}

impl Samples {
    fn new(py: Python<'_>, corners: &[Corner], given: &[(String, Bound<'_, PyBytes>)]) -> PyResult<Self> {
        let refuse = |what: String| Err(raise(py, Kind::Setting, what));
        let mut columns = [const { None }; SLOTS];
        for (name, bytes) in given {
            if let Some(slot) = Slot::all().find(|slot| slot.name() == *name) {
                columns[slot.index()] = Some(numbers(py, name, bytes.as_bytes())?);
            }
        }
        let Some(rows) = columns[Slot::Time.index()].as_ref().map(Vec::len) else {
            return refuse("time_s is missing".to_owned());
        };
        let needed = corners.iter().flat_map(|corner| {
            [Field::BodyAccel, Field::WheelAccel].map(|field| Slot::Corner(*corner, field))
        });
        if let Some(missing) = needed.into_iter().find(|slot| columns[slot.index()].is_none()) {
            return refuse(format!("{} is missing; where a sample has none, it is NaN", missing.name()));
        }
        if let Some(odd) = columns.iter().flatten().find(|column| column.len() != rows) {
            return refuse(format!(
                "time_s has {rows} values and another column {}, expected the same",
                odd.len()
            ));
        }
        let given: Vec<Slot> = Slot::all().filter(|slot| columns[slot.index()].is_some()).collect();
        let mut there = LogColumns::of(&given);
        for corner in Corner::ALL.into_iter().filter(|corner| !corners.contains(corner)) {
            there.corners[corner.index()] = None;
        }
        Ok(Self { there, columns, rows })
    }

    fn row(&self, i: usize) -> LogRow {
        let value = |slot: Slot| self.columns[slot.index()].as_ref().map_or(f64::NAN, |column| column[i]);
        let mut values = [f64::NAN; SLOTS];
        for slot in Slot::all() {
            values[slot.index()] = value(slot);
        }
        LogRow::from_values(&values, &self.there)
    }
}
