//! What is said at the end: a line for the drive, one per corner and one per alert, or the same as JSON.

use itpms_core::estimate::Warning;
use itpms_data::LogReader;
use itpms_study::report::{CornerReport, Reading, ReportData};
use serde_json::{Value, json};

use super::Done;
use super::events::Alerts;
use crate::args::EstimateArgs;
use crate::screen::Screen;

pub(super) fn print(args: &EstimateArgs, screen: &Screen, done: &Done) {
    let Done { log, data, alerts } = done;
    if args.json {
        screen.print(as_json(args, log, data, alerts));
        return;
    }
    let drive = &data.drive;
    let distance =
        if drive.distance_m.is_finite() { format!(", {:.0} m", drive.distance_m) } else { String::new() };
    screen.print(format!(
        "{}: {:.1} s at {:.0} Hz{distance}, {}",
        args.log.display(),
        drive.duration_s,
        drive.rate_hz,
        args.estimator.label()
    ));
    print_corners(screen, done);
}

/// A line per corner, and one for each alert of the monitor.
pub(crate) fn print_corners(screen: &Screen, done: &Done) {
    for corner in &done.data.corners {
        screen.print(corner_line(corner));
    }
    for sentence in done.alerts.sentences() {
        screen.print(sentence);
    }
}

fn corner_line(corner: &CornerReport) -> String {
    let figures = &corner.figures;
    let mut line = format!("{}  ", corner.corner.label());
    line += &match figures.last {
        Some(Reading { pressure_kpa, sd_kpa, .. }) => format!("{pressure_kpa:.1} kPa, sd {sd_kpa:.1}"),
        None => "no valid estimate".to_owned(),
    };
    line += &format!(" (placard {})", corner.placard_kpa);
    if let Some(since_s) = figures.low_since_s {
        let now = if figures.warning == Warning::Low { "" } else { ", now over" };
        line += &format!("; LOW since {since_s:.1} s{now}");
    }
    if let Some(since_s) = figures.malfunction_since_s {
        line += &format!("; MALFUNCTION since {since_s:.1} s");
    }
    if let Some(truth) = &figures.truth {
        line += &format!(
            "; against the truth after {} s: RMSE {:.1} kPa, bias {:+.1}, {:.0} % inside the 95 % interval",
            truth.settle_s,
            truth.rmse_kpa,
            truth.bias_kpa,
            100.0 * truth.coverage
        );
    }
    line
}

fn as_json(args: &EstimateArgs, log: &LogReader, data: &ReportData, alerts: &Alerts) -> Value {
    let path = |path: &std::path::PathBuf| path.display().to_string();
    let corners: serde_json::Map<String, Value> =
        data.corners.iter().map(|corner| (corner.corner.label().to_owned(), corner_json(corner))).collect();
    json!({
        "log": path(&args.log),
        "vehicle": data.provenance.vehicle,
        "estimator": args.estimator.label(),
        "duration_s": data.drive.duration_s,
        "rate_hz": data.drive.rate_hz,
        "distance_m": data.drive.distance_m,
        "corners": corners,
        "alerts": alerts.json(),
        "rows": log.repairs().rows_kept,
        "warnings": log.repairs().warnings(),
        "outputs": {
            "estimate": path(&args.output),
            "road": args.road_out.as_ref().map(path),
            "report": args.report.as_ref().map(path),
            "events": args.events.as_ref().map(path),
            "reference": args.save_reference.as_ref().map(path),
        },
    })
}

fn corner_json(corner: &CornerReport) -> Value {
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
        "truth": figures.truth.map(|t| json!({
            "rmse_kpa": t.rmse_kpa,
            "bias_kpa": t.bias_kpa,
            "coverage": t.coverage,
            "settle_s": t.settle_s,
        })),
        "road": corner.road.as_ref().map(|road| json!({
            "iri_m_per_km": road.iri_m_per_km,
            "truth_iri_m_per_km": road.truth_iri_m_per_km,
            "relative_error": road.relative_error,
        })),
    })
}
