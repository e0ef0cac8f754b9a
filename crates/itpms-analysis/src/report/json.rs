//! The curves as JSON for the page's script: rounded, missing values `null`, nothing that could end a script.
//!
//! Called by the page's writer.

use std::io;

use itpms_core::model::Corner;
use serde_json::{Value, json};

use super::digits::{Number, axis, position, value, values};
use super::wheels;
use super::words::{Status, corner_name};
use super::{AlertSpan, CornerReport, ReportData, RoadReport, SpectrumCurves, TimeCurves};
use crate::spectrum::{IsoClass, RoadFit};

/// The curves of the page, safe inside a `script` element.
pub(super) fn curves(data: &ReportData) -> io::Result<String> {
    let class = |class: IsoClass| json!({ "label": class.label(), "upper": class.upper_limit_m3() });
    let unit = data.pressure_unit;
    let page = json!({
        "title": super::title::title(data),
        // The unit in which the script draws pressures, which come in kPa.
        "unit": { "symbol": unit.symbol(), "kpa": unit.kpa(), "more_places": unit.more_places() },
        "t": axis(&data.time_s),
        "speed": values(&data.speed_m_s),
        "corners": data.corners.iter().map(|one| corner(one, data)).collect::<Vec<_>>(),
        "classes": IsoClass::ALL.map(class),
        "alerts": data.watch.iter().flat_map(|watch| &watch.alerts).map(alert).collect::<Vec<_>>(),
        "wheels": wheels::json(data),
    });
    Ok(serde_json::to_string(&page)?.replace('<', "\\u003c"))
}

fn alert(span: &AlertSpan) -> Value {
    let wheels: Vec<_> = span.alert.wheels.iter().map(Corner::label).collect();
    json!({ "wheels": wheels, "reported": position(span.alert.reported_s), "kind": span.alert.cause.label() })
}

fn runs(runs: &[(f64, f64, f64)]) -> Vec<[Number; 3]> {
    runs.iter().map(|r| [position(r.0), position(r.1), value(r.2)]).collect()
}

fn corner(corner: &CornerReport, data: &ReportData) -> Value {
    let state = data.watch.as_ref().map(|watch| runs(&watch.states[corner.corner.index()]));
    json!({
        "side": match corner.corner {
            Corner::FrontLeft | Corner::RearLeft => "left",
            Corner::FrontRight | Corner::RearRight => "right",
        },
        "state": state.unwrap_or_default(),
        "id": corner.corner.label(),
        "name": corner_name(corner.corner),
        "status": Status::of(corner).class(),
        "placard": value(corner.placard_kpa),
        "time": time(&corner.curves),
        "road": corner.road.as_ref().map(road),
    })
}

fn time(c: &TimeCurves) -> Value {
    json!({
        "p": values(&c.pressure_kpa),
        "notValid": values(&c.not_valid_kpa),
        "lo": values(&c.band_kpa[0]),
        "hi": values(&c.band_kpa[1]),
        "truth": values(&c.truth_kpa),
        "sd": values(&c.sd_kpa),
        "error": values(&c.error_kpa),
        "bound": values(&c.bound_sd_kpa),
        "boundLo": values(&c.bound_band_kpa[0]),
        "boundHi": values(&c.bound_band_kpa[1]),
        "forgetting": values(&c.forgetting),
        "nis": values(&c.nis),
        "nisMean": values(&c.nis_mean),
        "nisCheck": c.nis_check.map(|check| {
            json!({ "window": value(check.window_s), "lower": value(check.lower), "upper": value(check.upper) })
        }),
        "gate": values(&c.gate),
        "change": values(&c.change_probability),
        "validity": runs(&c.validity),
        "warning": runs(&c.warning),
    })
}

fn road(road: &RoadReport) -> Value {
    let fit = |fit: &RoadFit| {
        json!({
            "level": value(fit.law.gd_n0_m3),
            "slope": value(fit.law.waviness),
            "low": value(fit.band_per_m.0),
            "high": value(fit.band_per_m.1),
            "class": fit.class.label(),
        })
    };
    let psd = |s: &SpectrumCurves| {
        json!({
            "n": axis(&s.frequency_per_m),
            "density": values(&s.density_m3),
            "truth": values(&s.truth_m3),
            "fit": road.fit.as_ref().map(fit),
        })
    };
    json!({
        "x": axis(&road.profile.distance_m),
        "z": values(&road.profile.height_m),
        "truth": values(&road.profile.truth_m),
        "psd": road.spectrum.as_ref().map(psd),
        "iri": {
            "x": axis(&road.roughness.distance_m),
            "iri": values(&road.roughness.iri_m_per_km),
            "truth": values(&road.roughness.truth_m_per_km),
            "segment": value(road.roughness.segment_m),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_missing_ones_null() {
        let text = serde_json::to_string(&values(&[
            139.423_456_7,
            f64::NAN,
            f64::INFINITY,
            0.0,
            -241.0,
            1.234_567e-5,
            987_654_321.0,
            5e-324,
        ]));
        assert_eq!(text.unwrap(), "[139.42,null,null,0,-241,0.000012346,987650000,0]");
        // Ten hours in steps of a millisecond keep their milliseconds.
        assert_eq!(serde_json::to_string(&axis(&[35_999.999])).unwrap(), "[35999.999]");
    }
}
