//! A vehicle file held against a drive.

use std::path::{Path, PathBuf};

use itpms_data::{DataError, LogReader};
use itpms_drive::{CheckedVehicle, DriveError, check};
use pyo3::prelude::*;
use pyo3::types::PyIterator;

use crate::pieces::{Pieces, reading};
use crate::vehicle::Vehicle;
use crate::work::{self, Meanwhile, Progress};
use crate::{errors, output};

/// Holds a vehicle against the drive in a file.
#[pyfunction]
pub(crate) fn check_log(
    py: Python<'_>,
    path: PathBuf,
    vehicle: &Vehicle,
    trust_units: bool,
    dbc: Option<PathBuf>,
    signals: Option<PathBuf>,
    rows_where: Vec<String>,
    progress: Progress,
) -> PyResult<Checked> {
    let options = reading(py, trust_units, dbc, signals, &rows_where)?;
    run(py, vehicle, &progress, || LogReader::open_with(&path, &options))
}

/// Holds a vehicle against a drive given piece by piece, as [`Pieces`] takes them. `name` is what messages call the drive.
#[pyfunction]
pub(crate) fn check_pieces(
    py: Python<'_>,
    name: &str,
    names: Vec<String>,
    rows: Option<usize>,
    pieces: Bound<'_, PyIterator>,
    vehicle: &Vehicle,
    trust_units: bool,
    signals: Option<PathBuf>,
    rows_where: Vec<String>,
    progress: Progress,
) -> PyResult<Checked> {
    let options = reading(py, trust_units, None, signals, &rows_where)?;
    let pieces = Pieces::new(names, rows, pieces.unbind());
    let raised = pieces.raised();
    raised.or(run(py, vehicle, &progress, move || pieces.open(Path::new(name), &options)))
}

fn run(
    py: Python<'_>,
    vehicle: &Vehicle,
    progress: &Progress,
    open: impl FnOnce() -> Result<LogReader, DataError> + Send,
) -> PyResult<Checked> {
    let result = work::run(py, progress, |meanwhile: &Meanwhile| -> Result<CheckedVehicle, DriveError> {
        check(&vehicle.0, &mut open()?, &mut |share| meanwhile.done(share))
    })?;
    result.map(Checked).map_err(|error| errors::drive(py, &error))
}

/// A drive's check of a vehicle file.
#[pyclass(frozen, module = "itpms._itpms")]
pub(crate) struct Checked(CheckedVehicle);

#[pymethods]
impl Checked {
    /// What `itpms vehicle check --json` prints.
    fn document(&self) -> String {
        self.0.document().to_string()
    }

    /// What should be known before believing it.
    fn concerns(&self) -> Vec<String> {
        self.0.concerns.clone()
    }

    /// The response of a corner by its label: names and numbers over frequency, as measured and as the file says.
    fn curves(&self, label: &str) -> Vec<(String, Vec<f64>)> {
        let Some(corner) = self.0.corners.iter().find(|corner| corner.label == label) else { return vec![] };
        let (measured, coherences, of_file) = (corner.measured(), corner.coherences(), corner.of_file());
        let columns: [(&str, Vec<f64>); 8] = [
            ("hz", measured.iter().map(|(hz, ..)| *hz).collect()),
            ("gain", measured.iter().map(|(_, gain, _)| *gain).collect()),
            ("gain_se", measured.iter().map(|(.., error)| *error).collect()),
            ("coherence", coherences.iter().map(|(_, coherence)| *coherence).collect()),
            ("file_hz", of_file.iter().map(|(hz, _)| *hz).collect()),
            ("file_gain", of_file.iter().map(|(_, (gain, ..))| *gain).collect()),
            ("file_gain_low", of_file.iter().map(|(_, (_, low, _))| *low).collect()),
            ("file_gain_high", of_file.iter().map(|(_, (.., high))| *high).collect()),
        ];
        columns.map(|(name, values)| (name.to_owned(), values)).into()
    }

    /// Writes the page with a picture of each corner.
    fn report(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        output::file(py, &path, self.0.page().as_bytes())
    }
}
