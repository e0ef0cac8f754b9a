//! The past as columns: much smaller than a list of snapshots, and what charts want.
//!
//! Made for `/api/history` and for the start of a stream.

use std::sync::Arc;

use serde::Serialize;

use crate::snapshot::Snapshot;

/// Snapshots turned on their side; all lists are as long as `time_s`.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Columns {
    time_s: Vec<f64>,
    unix_s: Vec<f64>,
    speed_m_s: Vec<f64>,
    distance_m: Vec<f64>,
    wheels: Vec<WheelColumns>,
}

#[derive(Debug, Clone, Serialize)]
struct WheelColumns {
    corner: &'static str,
    state: Vec<&'static str>,
    /// Pressure and its deviation only where they may be shown.
    pressure_kpa: Vec<f64>,
    pressure_sd_kpa: Vec<f64>,
    gate: Vec<f64>,
    iri_m_per_km: Vec<f64>,
    road_m: Vec<f64>,
}

impl Columns {
    pub(super) fn of(snapshots: &[Arc<Snapshot>]) -> Self {
        let all =
            |value: fn(&Snapshot) -> f64, digits| snapshots.iter().map(|s| round(value(s), digits)).collect();
        let corners = snapshots.last().map_or(&[][..], |newest| &newest.wheels);
        Self {
            time_s: all(|s| s.time_s, 3),
            unix_s: all(|s| s.unix_s, 3),
            speed_m_s: all(|s| s.speed_m_s, 2),
            distance_m: all(|s| s.distance_m, 1),
            wheels: corners.iter().map(|wheel| WheelColumns::of(wheel.corner, snapshots)).collect(),
        }
    }
}

impl WheelColumns {
    fn of(corner: &'static str, snapshots: &[Arc<Snapshot>]) -> Self {
        let wheels =
            || snapshots.iter().map(|snapshot| snapshot.wheels.iter().find(|wheel| wheel.corner == corner));
        let valid = |number: fn(&crate::snapshot::Wheel) -> f64| {
            let shown = wheels().map(|wheel| wheel.filter(|wheel| wheel.valid).map_or(f64::NAN, number));
            shown.map(|value| round(value, 2)).collect()
        };
        let always = |number: fn(&crate::snapshot::Wheel) -> f64, digits| {
            wheels().map(|wheel| round(wheel.map_or(f64::NAN, number), digits)).collect()
        };
        Self {
            corner,
            state: wheels().map(|wheel| wheel.map_or("unknown", |wheel| wheel.state)).collect(),
            pressure_kpa: valid(|wheel| wheel.pressure_kpa),
            pressure_sd_kpa: valid(|wheel| wheel.pressure_sd_kpa),
            gate: always(|wheel| wheel.gate, 2),
            iri_m_per_km: always(|wheel| wheel.iri_m_per_km, 2),
            road_m: always(|wheel| wheel.road_m, 5),
        }
    }
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
