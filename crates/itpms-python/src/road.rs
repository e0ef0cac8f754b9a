//! Roughness of a road profile.

use itpms_analysis::roughness::{Enveloping, iri_m_per_km, segment_iri_m_per_km};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::columns::{bytes, numbers};
use crate::errors::{Kind, raise};

/// IRI in m/km of evenly spaced heights in m: of the whole, or of each whole segment.
#[pyfunction]
#[pyo3(signature = (heights, spacing_m, segment_m=None, enveloping=true))]
pub(crate) fn iri<'py>(
    py: Python<'py>,
    heights: &[u8],
    spacing_m: f64,
    segment_m: Option<f64>,
    enveloping: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let heights_m = numbers(py, "profile", heights)?;
    let enveloping = if enveloping { Enveloping::MovingAverage } else { Enveloping::Done };
    let found = match segment_m {
        None => iri_m_per_km(&heights_m, spacing_m, enveloping).map(|iri| vec![iri.unwrap_or(f64::NAN)]),
        Some(segment_m) => segment_iri_m_per_km(&heights_m, spacing_m, enveloping, segment_m),
    };
    bytes(py, &found.map_err(|error| raise(py, Kind::Setting, error))?)
}
