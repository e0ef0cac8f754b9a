//! What is said at the end: a line for the drive, one per corner and one per alert, or the same as JSON.

use itpms_core::model::Warning;
use itpms_drive::summary_json;
use itpms_study::report::{CornerReport, Reading};
use serde_json::{Value, json};

use super::Estimated;
use crate::args::EstimateArgs;
use crate::screen::Screen;

/// Seconds before the end for which a reading counts as the one at the end.
const FRESH_S: f64 = 1.0;

pub(super) fn print(args: &EstimateArgs, screen: &Screen, estimated: &Estimated) {
    if args.json {
        screen.print_lines(as_json(args, estimated));
        return;
    }
    let drive = &estimated.done.data.drive;
    let distance =
        if drive.distance_m.is_finite() { format!(", {:.0} m", drive.distance_m) } else { String::new() };
    screen.print(format!(
        "{}: {:.1} s at {:.0} Hz{distance}, {}",
        args.log.display(),
        drive.duration_s,
        drive.rate_hz,
        args.estimator.label()
    ));
    print_corners(screen, estimated);
}

/// A line per corner, and one for each alert of the monitor.
pub(crate) fn print_corners(screen: &Screen, estimated: &Estimated) {
    let Estimated { log, done } = estimated;
    let origin_s = done.data.drive.origin_s;
    let end_s = log.last_time_s().map_or(f64::NAN, |end_s| end_s - origin_s);
    for corner in &done.data.corners {
        screen.print(corner_line(corner, end_s));
    }
    for sentence in done.alerts.sentences(origin_s) {
        screen.print(sentence);
    }
}

/// What is shown is the last that was valid; where that is not now, it says since when.
fn corner_line(corner: &CornerReport, end_s: f64) -> String {
    let figures = &corner.figures;
    let mut line = format!("{}  ", corner.corner.label());
    line += &match figures.last {
        Some(Reading { pressure_kpa, sd_kpa, time_s }) => {
            let old = end_s - time_s > FRESH_S;
            let when = if old { format!(" at {time_s:.1} s, nothing valid since") } else { String::new() };
            format!("{pressure_kpa:.1} kPa, sd {sd_kpa:.1}{when}")
        }
        None => "no valid estimate".to_owned(),
    };
    line += &format!(" (placard {})", corner.placard_kpa);
    if let Some(said_s) = figures.low_since_s {
        let now = if figures.warning == Warning::Low { "" } else { ", now over" };
        line += &format!("; LOW, warned of at {said_s:.1} s{now}");
    }
    if let Some(said_s) = figures.malfunction_since_s {
        line += &format!("; MALFUNCTION, warned of at {said_s:.1} s");
    }
    // A pressure alone looks as good as that of a wheel that is known to be fine.
    if let Some(why) = corner.doubt() {
        line += &format!("; not known: {why}");
    }
    // Before anything is known there is nothing to be right or wrong about.
    if let Some(truth) = figures.truth.as_ref().filter(|_| figures.last.is_some()) {
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

fn as_json(args: &EstimateArgs, estimated: &Estimated) -> Value {
    let Estimated { log, done } = estimated;
    let path = |path: &std::path::PathBuf| path.display().to_string();
    let mut summary = summary_json(done, args.estimator, log.repairs().rows_kept);
    summary.insert("log".to_owned(), json!(path(&args.log)));
    summary.insert(
        "outputs".to_owned(),
        json!({
            "estimate": path(&args.output),
            "road": args.road_out.as_ref().map(path),
            "report": args.report.as_ref().map(path),
            "events": args.events.as_ref().map(path),
            "reference": args.save_reference.as_ref().map(path),
        }),
    );
    Value::Object(summary)
}
