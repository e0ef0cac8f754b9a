//! A drive that Python hands over piece by piece.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use itpms_data::log::{LogOptions, Piece, UnitCheck};
use itpms_data::{DataError, LogReader, Problem};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyIterator};

use crate::columns::numbers;
use crate::errors::{Kind, raise};

pub(crate) fn reading(
    py: Python<'_>,
    trust_units: bool,
    dbc: Option<PathBuf>,
    signals: Option<PathBuf>,
    rows: &[String],
) -> PyResult<LogOptions> {
    let units = if trust_units { UnitCheck::Trusting } else { UnitCheck::Suspicious };
    let rows = rows.iter().map(|row| row.parse()).collect::<Result<_, String>>();
    Ok(LogOptions {
        units,
        dbc,
        signals,
        rows: rows.map_err(|why| raise(py, Kind::Setting, format!("where: {why}")))?,
    })
}

/// An iterator over the columns, in the order of their names, that is asked for the next piece when the last one is used up. A column
/// is bytes, or a sentence on why it holds no numbers.
pub(crate) struct Pieces {
    names: Vec<String>,
    /// How many there are in all, where that is known.
    rows: Option<usize>,
    pieces: Py<PyIterator>,
    raised: Raised,
}

/// What an iterator raised, if it did.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    /// This, or else the result: what an iterator raised says more than that there was no further piece.
    pub(crate) fn or<T>(&self, result: PyResult<T>) -> PyResult<T> {
        let raised = self.0.lock().ok().and_then(|mut raised| raised.take());
        raised.map_or(result, Err)
    }

    pub(crate) fn keep(&self, error: PyErr) {
        if let Ok(mut raised) = self.0.lock() {
            *raised = Some(error);
        }
    }
}

/// A column of a piece.
#[derive(FromPyObject)]
enum Column<'py> {
    Numbers(Bound<'py, PyBytes>),
    Words(String),
}

impl Pieces {
    pub(crate) fn new(names: Vec<String>, rows: Option<usize>, pieces: Py<PyIterator>) -> Self {
        Self { names, rows, pieces, raised: Raised::default() }
    }

    /// What the iterator will have raised.
    pub(crate) fn raised(&self) -> Raised {
        self.raised.clone()
    }

    /// The drive, called `name` in messages. To be read without the interpreter's lock.
    pub(crate) fn open(self, name: &Path, options: &LogOptions) -> Result<LogReader, DataError> {
        let (names, rows) = (self.names.clone(), self.rows);
        let more = move || {
            Python::attach(|py| {
                self.next(py).map_err(|error| {
                    let sentence = error.to_string();
                    self.raised.keep(error);
                    Problem::Refused(sentence)
                })
            })
        };
        LogReader::from_pieces(name, &names, rows, Box::new(more), options)
    }

    fn next(&self, py: Python<'_>) -> PyResult<Option<Piece>> {
        let Some(piece) = self.pieces.bind(py).clone().next().transpose()? else { return Ok(None) };
        let piece = piece.extract::<Vec<Column<'_>>>()?;
        let column = |(name, column): (&String, &Column<'_>)| match column {
            Column::Numbers(bytes) => numbers(py, name, bytes.as_bytes()).map(Ok),
            Column::Words(why) => Ok(Err(why.clone())),
        };
        self.names.iter().zip(&piece).map(column).collect::<PyResult<Piece>>().map(Some)
    }
}
