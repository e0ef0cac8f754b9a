//! The curves as JSON for the page's script: rounded, missing values `null`, nothing that could end a script.
//!
//! Called by the page's writer.

use std::io;

use itpms_core::model::{Corner, PressureUnit};
use serde::Serialize;

use super::digits::{Digits, Number, axis, position, value, values};
use super::wheels::{self, WheelsJson};
use super::words::{Status, corner_name};
use super::{AlertSpan, CornerReport, ReportData, RoadReport, TimeCurves};
use crate::spectrum::{IsoClass, RoadFit};

#[derive(Serialize)]
struct Page<'a> {
    title: String,
    unit: UnitJson,
    t: Digits<'a>,
    speed: Digits<'a>,
    corners: Vec<CornerJson<'a>>,
    classes: Vec<ClassJson>,
    alerts: Vec<AlertJson>,
    wheels: Option<WheelsJson<'a>>,
}

/// The unit in which the script draws pressures, which come in kPa.
#[derive(Serialize)]
struct UnitJson {
    symbol: &'static str,
    kpa: f64,
    more_places: usize,
}

#[derive(Serialize)]
struct AlertJson {
    wheels: Vec<&'static str>,
    reported: Number,
    kind: &'static str,
}

#[derive(Serialize)]
struct ClassJson {
    label: &'static str,
    upper: f64,
}

#[derive(Serialize)]
struct CornerJson<'a> {
    id: &'static str,
    name: &'static str,
    status: &'static str,
    side: &'static str,
    placard: Number,
    state: Vec<[Number; 3]>,
    time: TimeJson<'a>,
    road: Option<RoadJson<'a>>,
}

#[derive(Serialize)]
struct TimeJson<'a> {
    p: Digits<'a>,
    #[serde(rename = "notValid")]
    not_valid: Digits<'a>,
    lo: Digits<'a>,
    hi: Digits<'a>,
    truth: Digits<'a>,
    sd: Digits<'a>,
    error: Digits<'a>,
    bound: Digits<'a>,
    #[serde(rename = "boundLo")]
    bound_lo: Digits<'a>,
    #[serde(rename = "boundHi")]
    bound_hi: Digits<'a>,
    forgetting: Digits<'a>,
    nis: Digits<'a>,
    #[serde(rename = "nisMean")]
    nis_mean: Digits<'a>,
    #[serde(rename = "nisCheck")]
    nis_check: Option<NisJson>,
    gate: Digits<'a>,
    change: Digits<'a>,
    validity: Vec<[Number; 3]>,
    warning: Vec<[Number; 3]>,
}

#[derive(Serialize)]
struct NisJson {
    window: Number,
    lower: Number,
    upper: Number,
}

#[derive(Serialize)]
struct RoadJson<'a> {
    x: Digits<'a>,
    z: Digits<'a>,
    truth: Digits<'a>,
    psd: Option<PsdJson<'a>>,
    iri: IriJson<'a>,
}

#[derive(Serialize)]
struct PsdJson<'a> {
    n: Digits<'a>,
    density: Digits<'a>,
    truth: Digits<'a>,
    fit: Option<FitJson>,
}

#[derive(Serialize)]
struct FitJson {
    level: Number,
    slope: Number,
    low: Number,
    high: Number,
    class: &'static str,
}

#[derive(Serialize)]
struct IriJson<'a> {
    x: Digits<'a>,
    iri: Digits<'a>,
    truth: Digits<'a>,
    segment: Number,
}

/// The curves of the page, safe inside a `script` element.
pub(super) fn curves(data: &ReportData) -> io::Result<String> {
    let page = Page {
        title: super::title::title(data),
        unit: unit(data.pressure_unit),
        t: axis(&data.time_s),
        speed: values(&data.speed_m_s),
        corners: data.corners.iter().map(|one| corner(one, data)).collect(),
        classes: IsoClass::ALL
            .into_iter()
            .map(|class| ClassJson { label: class.label(), upper: class.upper_limit_m3() })
            .collect(),
        alerts: data.watch.iter().flat_map(|watch| &watch.alerts).map(alert).collect(),
        wheels: wheels::json(data),
    };
    Ok(serde_json::to_string(&page)?.replace('<', "\\u003c"))
}

fn unit(unit: PressureUnit) -> UnitJson {
    UnitJson { symbol: unit.symbol(), kpa: unit.kpa(), more_places: unit.more_places() }
}

fn alert(span: &AlertSpan) -> AlertJson {
    AlertJson {
        wheels: span.alert.wheels.iter().map(Corner::label).collect(),
        reported: position(span.alert.reported_s),
        kind: span.alert.cause.label(),
    }
}

fn runs(runs: &[(f64, f64, f64)]) -> Vec<[Number; 3]> {
    runs.iter().map(|r| [position(r.0), position(r.1), value(r.2)]).collect()
}

fn corner<'a>(corner: &'a CornerReport, data: &ReportData) -> CornerJson<'a> {
    let state = data.watch.as_ref().map(|watch| runs(&watch.states[corner.corner.index()]));
    CornerJson {
        side: match corner.corner {
            Corner::FrontLeft | Corner::RearLeft => "left",
            Corner::FrontRight | Corner::RearRight => "right",
        },
        state: state.unwrap_or_default(),
        id: corner.corner.label(),
        name: corner_name(corner.corner),
        status: Status::of(corner).class(),
        placard: value(corner.placard_kpa),
        time: time(&corner.curves),
        road: corner.road.as_ref().map(road),
    }
}

fn time(c: &TimeCurves) -> TimeJson<'_> {
    TimeJson {
        p: values(&c.pressure_kpa),
        not_valid: values(&c.not_valid_kpa),
        lo: values(&c.band_kpa[0]),
        hi: values(&c.band_kpa[1]),
        truth: values(&c.truth_kpa),
        sd: values(&c.sd_kpa),
        error: values(&c.error_kpa),
        bound: values(&c.bound_sd_kpa),
        bound_lo: values(&c.bound_band_kpa[0]),
        bound_hi: values(&c.bound_band_kpa[1]),
        forgetting: values(&c.forgetting),
        nis: values(&c.nis),
        nis_mean: values(&c.nis_mean),
        nis_check: c.nis_check.map(|check| NisJson {
            window: value(check.window_s),
            lower: value(check.lower),
            upper: value(check.upper),
        }),
        gate: values(&c.gate),
        change: values(&c.change_probability),
        validity: runs(&c.validity),
        warning: runs(&c.warning),
    }
}

fn road(road: &RoadReport) -> RoadJson<'_> {
    let fit = |fit: &RoadFit| FitJson {
        level: value(fit.law.gd_n0_m3),
        slope: value(fit.law.waviness),
        low: value(fit.band_per_m.0),
        high: value(fit.band_per_m.1),
        class: fit.class.label(),
    };
    RoadJson {
        x: axis(&road.profile.distance_m),
        z: values(&road.profile.height_m),
        truth: values(&road.profile.truth_m),
        psd: road.spectrum.as_ref().map(|s| PsdJson {
            n: axis(&s.frequency_per_m),
            density: values(&s.density_m3),
            truth: values(&s.truth_m3),
            fit: road.fit.as_ref().map(fit),
        }),
        iri: IriJson {
            x: axis(&road.roughness.distance_m),
            iri: values(&road.roughness.iri_m_per_km),
            truth: values(&road.roughness.truth_m_per_km),
            segment: value(road.roughness.segment_m),
        },
    }
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
