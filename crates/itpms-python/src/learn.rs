//! A vehicle's parameters from drives at known pressures.

use std::path::PathBuf;

use itpms_core::model::Corner;
use itpms_data::LogReader;
use itpms_drive::{DriveError, KnownDrive, LearnedVehicle, learn_with};
use pyo3::prelude::*;
use pyo3::types::PyIterator;

use crate::errors;
use crate::pieces::{self, Pieces, Raised};
use crate::vehicle::Vehicle;
use crate::work::{self, Meanwhile, Progress};

/// A drive: a path, or a name and what gives its pieces anew for every pass; and the pressures in kPa of the corners that were given.
#[derive(FromPyObject)]
pub(crate) struct Given {
    #[pyo3(item)]
    log: PathBuf,
    #[pyo3(item)]
    table: Option<(Vec<String>, Option<usize>, Py<PyAny>)>,
    #[pyo3(item)]
    pressures_kpa: std::collections::HashMap<String, f64>,
}

/// Learns what drives at known pressures tell of a car.
#[pyfunction]
pub(crate) fn learn(
    py: Python<'_>,
    vehicle: &Vehicle,
    drives: Vec<Given>,
    trust_units: bool,
    dbc: Option<PathBuf>,
    signals: Option<PathBuf>,
    rows_where: Vec<String>,
    progress: Progress,
) -> PyResult<Learned> {
    let options = pieces::reading(py, trust_units, dbc, signals, &rows_where)?;
    let known: Vec<KnownDrive> = drives
        .iter()
        .map(|given| KnownDrive {
            log: given.log.clone(),
            options: options.clone(),
            pressures_kpa: Corner::ALL
                .map(|corner| given.pressures_kpa.get(corner.label()).copied().unwrap_or(f64::NAN)),
        })
        .collect();
    let mut raised = Raised::default();
    let result = work::run(py, &progress, |meanwhile: &Meanwhile| {
        let open = &mut |number: usize| -> Result<LogReader, DriveError> {
            let (given, drive) = (&drives[number], &known[number]);
            let Some((names, rows, pieces)) = &given.table else {
                return Ok(LogReader::open_with(&drive.log, &drive.options)?);
            };
            let again = Python::attach(|py| -> PyResult<Py<PyIterator>> {
                Ok(pieces.bind(py).call0()?.cast_into::<PyIterator>()?.unbind())
            });
            let pieces = again.map(|pieces| Pieces::new(names.clone(), *rows, pieces));
            let pieces = pieces.map_err(|error| {
                let sentence = error.to_string();
                raised.keep(error);
                DriveError::Mismatch(sentence)
            })?;
            raised = pieces.raised();
            Ok(pieces.open(&drive.log, &drive.options)?)
        };
        learn_with(&vehicle.0, &known, open, &mut |share| meanwhile.done(share))
    })?;
    raised.or(result.map(Learned).map_err(|error| errors::drive(py, &error)))
}

#[pyclass(frozen, module = "itpms._itpms")]
pub(crate) struct Learned(LearnedVehicle);

#[pymethods]
impl Learned {
    /// The vehicle to go on with.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle(self.0.vehicle.clone())
    }

    /// What `itpms vehicle learn --json` prints.
    fn document(&self) -> String {
        self.0.document().to_string()
    }

    /// The vehicle file with its comments; `began_with` is what it calls the one before.
    fn to_toml(&self, began_with: &str) -> String {
        self.0.to_toml(began_with)
    }
}
