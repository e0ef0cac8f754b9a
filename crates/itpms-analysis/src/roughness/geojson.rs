//! The road as GeoJSON (RFC 7946): a line per segment, a point per hole or bump.

use serde_json::{Value, json};

use super::anomaly::SideAnomaly;
use super::place::Way;
use super::table::RoughnessTable;

/// Points of a segment's line.
const POINTS: u32 = 10;
/// Resolution of a written degree: 1e-7 is a centimeter.
const PER_DEGREE: f64 = 1e7;

/// The road's segments and anomalies where they are on earth; what has no place is left out and counted.
pub fn geojson(table: &RoughnessTable, sides: &[(&str, &[SideAnomaly])], way: &Way) -> (Value, usize) {
    let mut features = Vec::new();
    let mut left_out = 0;
    for segment in table.places() {
        let points =
            (0..=POINTS).map(|i| segment.start_m + f64::from(i) / f64::from(POINTS) * segment.length_m);
        let Some(line) = points.map(|at_m| coordinates(way, at_m)).collect::<Option<Vec<_>>>() else {
            left_out += 1;
            continue;
        };
        let mut properties = json!({
            "kind": "roughness",
            "start_m": segment.start_m,
            "end_m": segment.start_m + segment.length_m,
            "iri_m_per_km": segment.iri_m_per_km,
        });
        for (track, iri) in segment.tracks {
            properties[format!("{track}_iri_m_per_km")] = json!(iri);
        }
        features.push(feature("LineString", json!(line), properties));
    }
    for (track, anomalies) in sides {
        for SideAnomaly { anomaly, passes } in *anomalies {
            let Some(place) = coordinates(way, anomaly.at_m) else {
                left_out += 1;
                continue;
            };
            let properties = json!({
                "kind": anomaly.kind(),
                "height_mm": 1e3 * anomaly.height_m,
                "height_sd_mm": 1e3 * anomaly.height_sd_m,
                "length_m": anomaly.length_m,
                "track": track,
                "passes": passes,
                "distance_m": anomaly.at_m,
                "time_s": anomaly.time_s,
            });
            features.push(feature("Point", place, properties));
        }
    }
    (json!({ "type": "FeatureCollection", "features": features }), left_out)
}

/// Longitude first, as GeoJSON has it.
fn coordinates(way: &Way, at_m: f64) -> Option<Value> {
    let [latitude, longitude] = way.at(at_m)?.map(|degrees| (PER_DEGREE * degrees).round() / PER_DEGREE);
    Some(json!([longitude, latitude]))
}

fn feature(kind: &str, coordinates: Value, properties: Value) -> Value {
    json!({
        "type": "Feature",
        "geometry": { "type": kind, "coordinates": coordinates },
        "properties": properties,
    })
}
