//! The roads under the tracks as a table: roughness, class and slope of every wheel, and the mean of the sides.
//!
//! Called by the page's writer where there are several corners.

use std::fmt::Write as _;

use itpms_core::model::Corner;

use super::words::{corner_name, level};
use super::{CornerReport, ReportData, RoadReport};

/// The table; empty without a road.
pub(super) fn table(data: &ReportData) -> String {
    let roads: Vec<(Corner, &RoadReport)> = data
        .corners
        .iter()
        .filter_map(|corner: &CornerReport| Some((corner.corner, corner.road.as_ref()?)))
        .collect();
    if roads.is_empty() {
        return String::new();
    }
    let truth = roads.iter().any(|(_, road)| road.truth_iri_m_per_km.is_some());
    let mut out = String::from(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Roads\"><table class=\"roads\"><thead><tr><th scope=\"col\">Track</th><th scope=\"col\">Wheel</th>\
         <th scope=\"col\">IRI m/km</th>",
    );
    if truth {
        out.push_str("<th scope=\"col\">True IRI</th>");
    }
    out.push_str("<th scope=\"col\">ISO 8608 class</th><th scope=\"col\">Slope w</th><th scope=\"col\">Waves</th></tr></thead><tbody>\n");
    for (side, corners) in SIDES {
        let of_side: Vec<&(Corner, &RoadReport)> =
            roads.iter().filter(|(c, _)| corners.contains(c)).collect();
        for (i, (corner, road)) in of_side.iter().enumerate() {
            out.push_str("<tr>");
            if i == 0 {
                let _ = write!(out, "<th scope=\"rowgroup\" rowspan=\"{}\">{side}</th>", of_side.len());
            }
            row(&mut out, *corner, road, truth);
        }
    }
    let mean = |iri: fn(&RoadReport) -> Option<f64>| mean_of_sides(&roads, iri);
    if let Some(mri) = mean(|road| road.iri_m_per_km) {
        let _ = write!(
            out,
            "<tr><th scope=\"row\">Both</th><td class=\"wheel\">mean (MRI)</td><td data-label=\"IRI m/km\">{mri:.2}</td>"
        );
        if truth {
            let text =
                mean(|road| road.truth_iri_m_per_km).map_or("–".to_owned(), |mri| format!("{mri:.2}"));
            let _ = write!(out, "<td data-label=\"true IRI\">{text}</td>");
        }
        out.push_str("<td></td><td></td><td></td></tr>\n");
    }
    out.push_str("</tbody></table></div>");
    out
}

const SIDES: [(&str, [Corner; 2]); 2] =
    [("Left", [Corner::FrontLeft, Corner::RearLeft]), ("Right", [Corner::FrontRight, Corner::RearRight])];

fn row(out: &mut String, corner: Corner, road: &RoadReport, truth: bool) {
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.2}"));
    let _ = write!(
        out,
        "<td class=\"wheel\">{}</td><td data-label=\"IRI m/km\">{}</td>",
        corner_name(corner),
        number(road.iri_m_per_km)
    );
    if truth {
        let _ = write!(out, "<td data-label=\"true IRI\">{}</td>", number(road.truth_iri_m_per_km));
    }
    match &road.fit {
        Some(fit) => {
            let (low, high) = fit.band_per_m;
            let _ = writeln!(
                out,
                "<td data-label=\"class\">{} <small>{} ± {:.0} %</small></td><td data-label=\"slope w\">{:.2} ± {:.2}</td>\
                 <td data-label=\"waves\">{:.1} – {:.0} m</td></tr>",
                fit.class.label(),
                level(fit.law.gd_n0_m3),
                100.0 * fit.level_sd_ln,
                fit.law.waviness,
                fit.waviness_sd,
                1.0 / high,
                1.0 / low
            );
        }
        None => out.push_str("<td data-label=\"class\">–</td><td data-label=\"slope w\">–</td><td>less than 51 m of road</td></tr>\n"),
    }
}

/// The mean over left and right of the mean over each side's wheels; `None` unless both have one.
fn mean_of_sides(roads: &[(Corner, &RoadReport)], iri: fn(&RoadReport) -> Option<f64>) -> Option<f64> {
    let of = |corners: &[Corner]| {
        let found: Vec<f64> =
            roads.iter().filter(|(c, _)| corners.contains(c)).filter_map(|(_, road)| iri(road)).collect();
        (!found.is_empty()).then(|| found.iter().sum::<f64>() / found.len() as f64)
    };
    Some(0.5 * (of(&SIDES[0].1)? + of(&SIDES[1].1)?))
}
