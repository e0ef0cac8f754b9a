//! What is known at the end of a drive, as JSON.

use itpms_core::estimator::EstimatorKind;
use itpms_study::report::{CornerReport, Reading};
use serde_json::{Map, Value, json};

use crate::run::{Done, Fit};

/// The drive, its corners and what was said: what `itpms estimate --json` prints, but for the names of its files.
#[must_use]
pub fn summary_json(done: &Done, estimator: EstimatorKind, rows: u64) -> Map<String, Value> {
    let Done { data, alerts, concerns, .. } = done;
    let corner = |corner: &CornerReport| {
        let fit = done.fits[corner.corner.index()].as_ref();
        (corner.corner.label().to_owned(), corner_json(corner, fit))
    };
    let corners: Map<String, Value> = data.corners.iter().map(corner).collect();
    [
        ("vehicle", json!(data.provenance.vehicle)),
        ("estimator", json!(estimator.label())),
        ("duration_s", json!(data.drive.duration_s)),
        ("rate_hz", json!(data.drive.rate_hz)),
        ("distance_m", json!(data.drive.distance_m)),
        ("corners", Value::Object(corners)),
        ("alerts", alerts.json()),
        ("rows", json!(rows)),
        ("warnings", json!(concerns)),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into_iter()
    .collect()
}

fn corner_json(corner: &CornerReport, fit: Option<&Fit>) -> Value {
    let figures = &corner.figures;
    let reading = |reading: Option<Reading>| {
        reading.map(|r| json!({ "time_s": r.time_s, "pressure_kpa": r.pressure_kpa, "sd_kpa": r.sd_kpa }))
    };
    json!({
        "placard_kpa": corner.placard_kpa,
        "last": reading(figures.last),
        "lowest": reading(figures.lowest),
        "warning": figures.warning.label(),
        "low_since_s": figures.low_since_s,
        "malfunction_since_s": figures.malfunction_since_s,
        "share_valid": figures.share_valid,
        "truth": figures.truth.filter(|_| figures.last.is_some()).map(|t| json!({
            "rmse_kpa": t.rmse_kpa,
            "bias_kpa": t.bias_kpa,
            "coverage": t.coverage,
            "settle_s": t.settle_s,
        })),
        "fit": fit.map(fit_json),
        "road": corner.road.as_ref().map(|road| json!({
            "iri_m_per_km": road.iri_m_per_km,
            "truth_iri_m_per_km": road.truth_iri_m_per_km,
            "relative_error": road.relative_error,
        })),
    })
}

/// How well body and wheel go together, and what does not.
pub(crate) fn fit_json((fit, misfit): &Fit) -> Value {
    json!({
        "incoherence": fit.incoherence,
        "unexplained": fit.unexplained,
        "hop_excess": fit.hop_excess,
        "friction_n": fit.friction_n,
        "misfit": misfit.map(|misfit| misfit.to_string()),
    })
}
