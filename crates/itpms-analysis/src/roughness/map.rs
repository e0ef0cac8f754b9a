//! The road as a page: its course as the car drove it, colored by roughness, with holes and bumps. Drawn from the map as GeoJSON, without
//! tiles of anybody: nothing is asked of a network.
//!
//! Called by the roughness command.

use std::fmt::Write as _;

use serde_json::Value;

use crate::page::figures_page;
use crate::plot::escape;

/// Width of the picture, and its least and largest height; what is left free at its edges.
const WIDTH: f64 = 1000.0;
const HEIGHTS: [f64; 2] = [260.0, 1000.0];
const EDGE: f64 = 40.0;
/// Meters in a degree of latitude.
const PER_DEGREE_M: f64 = 111_195.0;
/// Upper ends in m/km of the classes of roughness, the last one without; their styles and words.
const CLASSES: [(f64, &str, &str); 4] = [
    (1.5, "smooth", "below 1.5"),
    (2.5, "fair", "1.5 to 2.5"),
    (4.0, "rough", "2.5 to 4"),
    (f64::INFINITY, "bad", "above 4 m/km"),
];

const STYLE: &str = "
.road-map { display: block; width: 100%; height: auto; max-height: 82vh; }
.road-map polyline { fill: none; stroke-width: 5; stroke-linecap: round; stroke-linejoin: round; stroke: var(--quiet); }
.road-map .smooth, .key .smooth { stroke: var(--fine); } .road-map .fair, .key .fair { stroke: var(--estimate); }
.road-map .rough, .key .rough { stroke: var(--warn); } .road-map .bad, .key .bad { stroke: var(--low); stroke-width: 7; }
.road-map .spot, .key .spot { fill: var(--panel); stroke: var(--ink); stroke-width: 2; }
.road-map rect { fill: var(--quiet); } .road-map rect.smooth { fill: var(--fine); } .road-map rect.fair { fill: var(--estimate); }
.road-map rect.rough { fill: var(--warn); } .road-map rect.bad { fill: var(--low); }
.road-map text { font-size: 14px; fill: var(--soft); }
.road-map .scale { fill: none; stroke: var(--soft); stroke-width: 2; }
.key { list-style: none; display: flex; flex-wrap: wrap; gap: 4px 20px; margin: 10px 0 0; padding: 0; font-size: 14px; color: var(--soft); }
.key li { display: flex; align-items: center; gap: 7px; }
.key path { fill: none; stroke-width: 4; }
";

/// Where degrees are on the picture: north is up, and a meter as long in all directions.
struct Projection {
    west_deg: f64,
    north_deg: f64,
    per_degree_m: f64,
    per_m: f64,
    left: f64,
    top: f64,
    height: f64,
}

impl Projection {
    /// Of all places, longitude first; `None` where there are none.
    fn of(places: &[[f64; 2]]) -> Option<Self> {
        let end = |of: fn(f64, f64) -> f64, at: usize| places.iter().map(|place| place[at]).reduce(of);
        let (west_deg, east_deg) = (end(f64::min, 0)?, end(f64::max, 0)?);
        let (south_deg, north_deg) = (end(f64::min, 1)?, end(f64::max, 1)?);
        let per_degree_m = PER_DEGREE_M * (0.5 * (south_deg + north_deg)).to_radians().cos();
        let wide_m = ((east_deg - west_deg) * per_degree_m).max(1.0);
        let high_m = ((north_deg - south_deg) * PER_DEGREE_M).max(1.0);
        let [least, most] = HEIGHTS;
        let per_m = ((WIDTH - 2.0 * EDGE) / wide_m).min((most - 2.0 * EDGE) / high_m);
        let height = (per_m * high_m + 2.0 * EDGE).max(least);
        Some(Self {
            west_deg,
            north_deg,
            per_degree_m,
            per_m,
            left: 0.5 * (WIDTH - per_m * wide_m),
            top: 0.5 * (height - per_m * high_m),
            height,
        })
    }

    fn at(&self, [longitude, latitude]: [f64; 2]) -> [f64; 2] {
        [
            self.left + self.per_m * (longitude - self.west_deg) * self.per_degree_m,
            self.top + self.per_m * (self.north_deg - latitude) * PER_DEGREE_M,
        ]
    }
}

fn place(value: &Value) -> Option<[f64; 2]> {
    Some([value.get(0)?.as_f64()?, value.get(1)?.as_f64()?])
}

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap_or(f64::NAN)
}

/// The page of a map in GeoJSON, as [`geojson`](super::geojson()) makes it; `about`: the name of the drive, and what was seen.
pub fn map_page(name: &str, about: &str, map: &Value) -> String {
    let features: Vec<&Value> = map["features"].as_array().into_iter().flatten().collect();
    let of = |kind: &'static str| features.iter().copied().filter(move |one| one["geometry"]["type"] == kind);
    let line = |one: &Value| -> Vec<[f64; 2]> {
        one["geometry"]["coordinates"].as_array().into_iter().flatten().filter_map(place).collect()
    };
    let spots: Vec<(&Value, [f64; 2])> = of("Point")
        .filter_map(|one| Some((&one["properties"], place(&one["geometry"]["coordinates"])?)))
        .collect();
    let lines: Vec<(&Value, Vec<[f64; 2]>)> =
        of("LineString").map(|one| (&one["properties"], line(one))).collect();
    let all: Vec<[f64; 2]> =
        lines.iter().flat_map(|(_, line)| line).chain(spots.iter().map(|(_, at)| at)).copied().collect();
    let mut content = format!("<p class=\"subline\">{}</p>\n", escape(about));
    match Projection::of(&all) {
        Some(projection) => {
            content.push_str(&picture(&projection, &lines, &spots));
            content.push_str(&table(&spots));
        }
        None => content.push_str("<p class=\"note\">No part of the road has a position.</p>"),
    }
    figures_page(&format!("The road of {name}"), STYLE, content)
}

/// A square of road.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCell {
    /// Its corners, longitude first, in degrees: south-west and north-east.
    pub corners_deg: [[f64; 2]; 2],
    pub iri_m_per_km: f64,
    pub title: String,
}

/// Style of the [`cells_picture`].
pub const MAP_STYLE: &str = STYLE;

/// Squares of road from above, by roughness, with a key; empty where there are none.
pub fn cells_picture(cells: &[MapCell]) -> String {
    let all: Vec<[f64; 2]> = cells.iter().flat_map(|cell| cell.corners_deg).collect();
    let Some(to) = Projection::of(&all) else { return String::new() };
    let mut out = format!(
        "<figure><svg class=\"road-map\" viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" aria-label=\"Roads from above, north up: {} squares by roughness\">\n",
        to.height,
        cells.len()
    );
    for cell in cells {
        let [[x0, y1], [x1, y0]] = cell.corners_deg.map(|corner| to.at(corner));
        // Squares that are hardly a point are drawn as one that can be seen.
        let grown = (0.5 * (LEAST_SQUARE - (x1 - x0))).max(0.0);
        let _ = writeln!(
            out,
            "<rect class=\"{}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"><title>{}</title></rect>",
            class(cell.iri_m_per_km),
            x0 - grown,
            y0 - grown,
            x1 - x0 + 2.0 * grown,
            y1 - y0 + 2.0 * grown,
            escape(&cell.title)
        );
    }
    out.push_str(&scale(&to));
    out.push_str("</svg>\n<ul class=\"key\" aria-label=\"Key\">");
    roughness_key(&mut out);
    out.push_str("</ul><figcaption>North is up.</figcaption></figure>\n");
    out
}

/// Side of the smallest square of a picture.
const LEAST_SQUARE: f64 = 6.0;

fn class(iri: f64) -> &'static str {
    CLASSES.iter().find(|(to, ..)| iri < *to).map_or("", |(_, class, _)| class)
}

fn roughness_key(out: &mut String) {
    for (_, class, words) in CLASSES {
        let _ = write!(
            out,
            "<li><svg width=\"26\" height=\"10\" aria-hidden=\"true\"><path class=\"{class}\" d=\"M2 5H24\"/></svg>IRI {words}</li>"
        );
    }
}

fn picture(to: &Projection, lines: &[(&Value, Vec<[f64; 2]>)], spots: &[(&Value, [f64; 2])]) -> String {
    let mut out = format!(
        "<figure><svg class=\"road-map\" viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" aria-label=\"The road from above, north up: \
         {} segments by roughness, {} holes and bumps\">\n",
        to.height,
        lines.len(),
        spots.len()
    );
    for (about, line) in lines {
        let points: Vec<String> =
            line.iter().map(|at| to.at(*at)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let iri = number(about, "iri_m_per_km");
        let class = class(iri);
        let says = if iri.is_finite() { format!("{iri:.2} m/km") } else { "not known".to_owned() };
        let _ = writeln!(
            out,
            "<polyline class=\"{class}\" points=\"{}\"><title>{:.0} to {:.0} m: {says}</title></polyline>",
            points.join(" "),
            number(about, "start_m"),
            number(about, "end_m"),
        );
    }
    for (about, at) in spots {
        let [x, y] = to.at(*at);
        let _ = writeln!(
            out,
            "<path class=\"spot\" transform=\"translate({x:.1} {y:.1})\" d=\"{}\"><title>{} at {:.0} m, {} track: {:.0} ± {:.0} mm</title></path>",
            sign(about["kind"] == "hole"),
            if about["kind"] == "hole" { "hole" } else { "bump" },
            number(about, "distance_m"),
            escape(about["track"].as_str().unwrap_or_default()),
            number(about, "height_mm"),
            number(about, "height_sd_mm"),
        );
    }
    out.push_str(&scale(to));
    out.push_str("</svg>\n<ul class=\"key\" aria-label=\"Key\">");
    roughness_key(&mut out);
    for (is_hole, word) in [(true, "hole"), (false, "bump")] {
        let _ = write!(
            out,
            "<li><svg width=\"18\" height=\"18\" viewBox=\"-9 -9 18 18\" aria-hidden=\"true\"><path class=\"spot\" d=\"{}\"/></svg>{word}</li>",
            sign(is_hole)
        );
    }
    out.push_str("</ul><figcaption>North is up. Positions as the log has them, the car's course between them as straight lines.</figcaption></figure>\n");
    out
}

/// A hole points down, a bump up.
fn sign(is_hole: bool) -> &'static str {
    if is_hole { "M-7 -5H7L0 7Z" } else { "M-7 5H7L0 -7Z" }
}

/// A length that is 1, 2 or 5 times a power of ten, of a tenth to a quarter of the picture.
fn scale(to: &Projection) -> String {
    let most_m = 0.25 * WIDTH / to.per_m;
    let ten = 10f64.powf(most_m.log10().floor());
    let length_m = [5.0, 2.0, 1.0].into_iter().map(|n| n * ten).find(|m| *m <= most_m).unwrap_or(ten);
    let words =
        if length_m < 1000.0 { format!("{length_m:.0} m") } else { format!("{:.0} km", length_m / 1000.0) };
    let (x, y) = (EDGE * 0.5, to.height - 12.0);
    format!(
        "<path class=\"scale\" d=\"M{x} {top:.1}V{y:.1}H{end:.1}V{top:.1}\"/><text x=\"{middle:.1}\" y=\"{text:.1}\">{words}</text>\n",
        top = y - 6.0,
        end = x + length_m * to.per_m,
        middle = x + 6.0,
        text = y - 8.0,
    )
}

/// Holes and bumps in the order of the road.
fn table(spots: &[(&Value, [f64; 2])]) -> String {
    if spots.is_empty() {
        return "<p>No hole or bump stands out of this road.</p>\n".to_owned();
    }
    let mut spots: Vec<&Value> = spots.iter().map(|(about, _)| *about).collect();
    spots.sort_by(|a, b| number(a, "distance_m").total_cmp(&number(b, "distance_m")));
    let mut out = String::from(
        "<h2>Holes and bumps</h2><div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Holes and bumps\">\
         <table class=\"numbers\"><thead><tr><th scope=\"col\" class=\"words\">What</th><th scope=\"col\">At, m</th><th scope=\"col\">Time, s</th>\
         <th scope=\"col\">Track</th><th scope=\"col\">Height, mm</th><th scope=\"col\">Length, m</th><th scope=\"col\">Wheels</th></tr></thead><tbody>\n",
    );
    for about in spots {
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{:.0}</td><td>{:.1}</td><td>{}</td><td>{:.0} ± {:.0}</td><td>{:.1}</td><td>{}</td></tr>",
            escape(about["kind"].as_str().unwrap_or_default()),
            number(about, "distance_m"),
            number(about, "time_s"),
            escape(about["track"].as_str().unwrap_or_default()),
            number(about, "height_mm"),
            number(about, "height_sd_mm"),
            number(about, "length_m"),
            about["passes"],
        );
    }
    out.push_str("</tbody></table></div>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_meter_is_as_long_in_all_directions_and_north_is_up() {
        // At 60 degrees a degree of longitude is half as long as one of latitude.
        let to = Projection::of(&[[10.0, 60.0], [10.02, 60.01]]).unwrap();
        let ([x0, y0], [x1, y1]) = (to.at([10.0, 60.0]), to.at([10.02, 60.01]));
        assert!(x1 > x0 && y1 < y0);
        assert!(((x1 - x0) / (y0 - y1) - 1.0).abs() < 1e-3);
        for [x, y] in [[x0, y0], [x1, y1]] {
            assert!((0.0..=WIDTH).contains(&x) && (0.0..=to.height).contains(&y));
        }
        assert!(Projection::of(&[]).is_none());
        // A road due north, and one place.
        for places in [vec![[10.0, 60.0], [10.0, 60.1]], vec![[10.0, 60.0]]] {
            let to = Projection::of(&places).unwrap();
            assert!(places.iter().all(|at| to.at(*at).iter().all(|v| v.is_finite() && *v >= 0.0)));
        }
    }

    #[test]
    fn the_page_has_roughness_holes_and_a_scale_and_takes_names_as_text() {
        let feature = |kind: &str, coordinates: Value, properties: Value| json!({ "type": "Feature", "geometry": { "type": kind, "coordinates": coordinates }, "properties": properties });
        let map = json!({ "type": "FeatureCollection", "features": [
            feature("LineString", json!([[11.0, 48.0], [11.0, 48.0009]]), json!({ "kind": "roughness", "start_m": 0.0, "end_m": 100.0, "iri_m_per_km": 4.4 })),
            feature("LineString", json!([[11.0, 48.0009], [11.0, 48.0018]]), json!({ "start_m": 100.0, "end_m": 200.0, "iri_m_per_km": null })),
            feature("Point", json!([11.0, 48.0004]), json!({ "kind": "hole", "height_mm": -24.0, "height_sd_mm": 5.0, "length_m": 0.6, "track": "<left>",
                "passes": 2, "distance_m": 44.0, "time_s": 2.2 })),
        ] });
        let page = map_page("<b>drive</b>", "two wheels", &map);
        for says in [
            "The road of &lt;b&gt;drive&lt;/b&gt;",
            "class=\"bad\"",
            "0 to 100 m: 4.40 m/km",
            "100 to 200 m: not known",
            "hole at 44 m, &lt;left&gt; track: -24 ± 5 mm",
            "<td>-24 ± 5</td>",
            // 200 m are 920 high: the longest of 1, 2, 5 times a power of ten within 54 m.
            ">50 m</text>",
        ] {
            assert!(page.contains(says), "{says}");
        }
        assert!(
            map_page("x", "y", &json!({ "features": [] })).contains("No part of the road has a position")
        );
    }
}
