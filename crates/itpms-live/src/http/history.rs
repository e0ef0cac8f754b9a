//! The past as columns: much smaller than a list of snapshots, and what charts want.
//!
//! Made for `/api/history` and for the start of a stream.

use std::sync::Arc;

use serde_json::{Value, json};

use crate::snapshot::{Snapshot, Wheel};

/// Snapshots turned on their side; all lists are as long as `time_s`.
pub(super) fn columns(snapshots: &[Arc<Snapshot>]) -> Value {
    let all = |value: fn(&Snapshot) -> f64, digits| -> Vec<f64> {
        snapshots.iter().map(|s| round(value(s), digits)).collect()
    };
    let corners = snapshots.last().map_or(&[][..], |newest| &newest.wheels);
    json!({
        "time_s": all(|s| s.time_s, 3),
        "unix_s": all(|s| s.unix_s, 3),
        "speed_m_s": all(|s| s.speed_m_s, 2),
        "distance_m": all(|s| s.distance_m, 1),
        "wheels": corners.iter().map(|wheel| of_wheel(wheel.corner, snapshots)).collect::<Vec<_>>(),
    })
}

/// Pressure and its deviation are there only where they may be shown.
fn of_wheel(corner: &str, snapshots: &[Arc<Snapshot>]) -> Value {
    let wheels =
        || snapshots.iter().map(|snapshot| snapshot.wheels.iter().find(|wheel| wheel.corner == corner));
    let always = |number: fn(&Wheel) -> f64, digits| -> Vec<f64> {
        wheels().map(|wheel| round(wheel.map_or(f64::NAN, number), digits)).collect()
    };
    let valid = |number: fn(&Wheel) -> f64| -> Vec<f64> {
        let shown = wheels().map(|wheel| wheel.filter(|wheel| wheel.valid).map_or(f64::NAN, number));
        shown.map(|value| round(value, 2)).collect()
    };
    json!({
        "corner": corner,
        "state": wheels().map(|wheel| wheel.map_or("unknown", |wheel| wheel.state)).collect::<Vec<_>>(),
        "pressure_kpa": valid(|wheel| wheel.pressure_kpa),
        "pressure_sd_kpa": valid(|wheel| wheel.pressure_sd_kpa),
        "gate": always(|wheel| wheel.gate, 2),
        "iri_m_per_km": always(|wheel| wheel.iri_m_per_km, 2),
        "road_m": always(|wheel| wheel.road_m, 5),
    })
}

/// Digits that are not seen are not sent.
fn round(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_keeps_the_unknown_unknown() {
        assert_eq!(round(241.2949, 2), 241.29);
        assert!(round(f64::NAN, 2).is_nan());
    }
}
