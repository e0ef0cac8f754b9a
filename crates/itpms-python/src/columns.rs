//! Numbers as bytes: little-endian `f64`, one after the other.

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{Kind, raise};

pub(crate) fn numbers(py: Python<'_>, name: &str, bytes: &[u8]) -> PyResult<Vec<f64>> {
    let (whole, rest) = bytes.as_chunks::<8>();
    if !rest.is_empty() {
        let found = bytes.len();
        return Err(raise(
            py,
            Kind::Setting,
            format!("{name}: found {found} bytes, expected eight per number"),
        ));
    }
    Ok(whole.iter().map(|eight| f64::from_le_bytes(*eight)).collect())
}

pub(crate) fn bytes<'py>(py: Python<'py>, numbers: &[f64]) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, 8 * numbers.len(), |out| {
        for (eight, number) in out.as_chunks_mut::<8>().0.iter_mut().zip(numbers) {
            *eight = number.to_le_bytes();
        }
        Ok(())
    })
}

pub(crate) type Columns = Vec<(String, Vec<f64>)>;

/// The same as Python has them: names and bytes.
pub(crate) type Packed<'py> = Vec<(String, Bound<'py, PyBytes>)>;

/// Words over time, with their names.
pub(crate) type Words = Vec<(String, Vec<&'static str>)>;

pub(crate) fn all<'py>(py: Python<'py>, columns: &Columns) -> PyResult<Packed<'py>> {
    columns.iter().map(|(name, numbers)| Ok((name.clone(), bytes(py, numbers)?))).collect()
}
