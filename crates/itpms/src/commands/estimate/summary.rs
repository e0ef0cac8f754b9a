//! Summary at the end: a line for the drive, one per corner and one per alert, or the same as JSON.

use itpms_console::Screen;
use itpms_drive::{summary_json, torsion_line, wheel_speed_lines};
use serde_json::{Value, json};

use super::Estimated;
use crate::args::EstimateArgs;

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
        estimated.done.data.provenance.estimator
    ));
    corner_lines(estimated).into_iter().for_each(|line| screen.print(line));
}

/// A line per corner, and one for each alert of the monitor.
pub(crate) fn corner_lines(estimated: &Estimated) -> Vec<String> {
    let Estimated { log, done } = estimated;
    let (origin_s, unit) = (done.data.drive.origin_s, done.data.pressure_unit);
    let end_s = log.last_time_s().map_or(f64::NAN, |end_s| end_s - origin_s);
    let mut lines = itpms_drive::corner_lines(done, end_s);
    lines.extend(done.radii.iter().flat_map(wheel_speed_lines));
    lines.extend(torsion_line(done, unit));
    lines.extend(done.beside.lines());
    lines.extend(done.alerts.sentences(origin_s, unit));
    lines
}

fn as_json(args: &EstimateArgs, estimated: &Estimated) -> Value {
    let Estimated { log, done } = estimated;
    let path = |path: &std::path::PathBuf| path.display().to_string();
    let mut summary = summary_json(done, log.repairs().rows_kept);
    summary.insert("log".to_owned(), json!(path(&args.log)));
    let outputs = [
        ("estimate", &args.output),
        ("road", &args.road_out),
        ("report", &args.report),
        ("events", &args.events),
        #[cfg(feature = "mcap")]
        ("mcap", &args.mcap),
        ("reference", &args.save_reference),
    ];
    let outputs = outputs.map(|(what, file)| (what.to_owned(), json!(file.as_ref().map(path))));
    summary.insert("outputs".to_owned(), Value::Object(outputs.into_iter().collect()));
    Value::Object(summary)
}
