//! Files that Python writes: completely or not at all, as the command's are.

use std::path::{Path, PathBuf};

use itpms_data::DataError;
use itpms_data::out::AtomicFile;
use pyo3::prelude::*;

use crate::errors::{self, Kind};

#[pyfunction]
pub(crate) fn write(py: Python<'_>, path: PathBuf, content: Vec<u8>) -> PyResult<()> {
    file(py, &path, &content)
}

pub(crate) fn file(py: Python<'_>, path: &Path, content: &[u8]) -> PyResult<()> {
    let write = || -> Result<(), DataError> { Ok(AtomicFile::save(path, content)?) };
    py.detach(write).map_err(|error| errors::data(py, Kind::Output, &error))
}
