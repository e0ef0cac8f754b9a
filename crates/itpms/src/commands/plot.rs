//! `itpms plot`: a log in, a page about its signals out.

use std::path::{Path, PathBuf};

use itpms_analysis::overview::{
    CornerSignals, Found, FoundCorner, FoundWheels, Overview, Statistics, WheelSignals,
};
use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::LogReader;
use itpms_data::log::LogMotion;
use itpms_data::out::AtomicFile;
use serde_json::{Map, Value, json};

use crate::args::PlotArgs;
use crate::commands::ROWS_PER_LOOK;

pub(crate) fn run(args: &PlotArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let output = args.output.clone().unwrap_or_else(|| beside(&args.log));
    let [dbc, signals] = args.reading.inputs();
    names::check(&[(Some(args.log.as_path()), "the log"), dbc, signals], &[Some(&output)])?;
    let mut log = LogReader::open_with(&args.log, &args.reading.options())?;
    let mut file = AtomicFile::create(&output)?;
    let found = look(&mut log, screen, interrupt)?;
    let name = args.log.file_name().unwrap_or(args.log.as_os_str()).to_string_lossy();
    file.append(found.page(&name).as_bytes())?;
    file.commit()?;
    remarks(args, &log, screen);
    if args.json {
        screen.print_lines(format!("{:#}", document(&found)));
    } else {
        print(&found, screen);
    }
    screen.remark(format!("wrote {}", output.display()));
    Ok(())
}

/// `drives/monday.csv` becomes `monday-plot.html`.
fn beside(log: &Path) -> PathBuf {
    let mut name = log.file_stem().unwrap_or_default().to_owned();
    name.push("-plot.html");
    name.into()
}

fn look(log: &mut LogReader, screen: &Screen, interrupt: &Interrupt) -> Result<Found, Failure> {
    let mut overview = Overview::new(log.survey().sample_period_s);
    let progress = screen.progress("reading");
    let mut rows = 0u64;
    while let Some(row) = log.next_row()? {
        let corners = row.corners.map(|corner| {
            corner.map(|c| CornerSignals {
                body_accel_m_s2: c.body_accel_m_s2,
                wheel_accel_m_s2: c.wheel_accel_m_s2,
                pressure_kpa: c.pressure_kpa,
                road_m: c.road_m,
            })
        });
        overview.push(row.time_s, row.speed_m_s, &corners);
        if log.columns().motion.wheel_speeds() {
            overview.push_wheels(row.time_s, &wheel_signals(&row.motion));
        }
        rows += 1;
        if rows.is_multiple_of(ROWS_PER_LOOK) {
            interrupt.check()?;
            progress.set(log.progress());
        }
    }
    let nothing = || Failure::Usage(format!("{}: has no row that can be used", log.path().display()));
    overview.finish().ok_or_else(nothing)
}

fn wheel_signals(motion: &LogMotion) -> WheelSignals {
    let in_rad_s = motion.wheel_speed_rad_s.iter().any(|speed| speed.is_finite());
    WheelSignals {
        speeds: if in_rad_s { motion.wheel_speed_rad_s } else { motion.wheel_speed_m_s },
        in_rad_s,
        yaw_rate_rad_s: motion.yaw_rate_rad_s,
        accel_x_m_s2: motion.accel_x_m_s2,
    }
}

/// Which signal was taken for what, and what was repaired.
fn remarks(args: &PlotArgs, log: &LogReader, screen: &Screen) {
    let path = args.log.display();
    for remark in log.mapping().iter().chain(&log.remarks()) {
        screen.remark(format!("{path}: {remark}"));
    }
    for warning in log.repairs().warnings() {
        screen.warn(format!("{path}: {warning}"));
    }
}

fn print(found: &Found, screen: &Screen) {
    screen.print(found.summary());
    if let Some(wheels) = &found.wheels {
        screen.print(format!("wheel speeds: {}", wheels.summary()));
    }
    for corner in &found.corners {
        screen.print(format!("{}: {}", corner.label, corner.summary()));
    }
    for doubt in found.doubts() {
        screen.warn(doubt);
    }
}

fn document(found: &Found) -> Value {
    let corner = |corner: &FoundCorner| {
        let value = json!({
            "body_accel_m_s2": statistics(&corner.body),
            "wheel_accel_m_s2": statistics(&corner.wheel),
            "pressure_kpa": corner.pressure.as_ref().map(statistics),
            "road_m": corner.road.as_ref().map(statistics),
            "coherence": corner.coherence,
            "hop_hz": corner.hop_hz,
            "segments": corner.segments,
        });
        (corner.label.to_owned(), value)
    };
    json!({
        "rows": found.rows,
        "first_time_s": found.span_s.0,
        "last_time_s": found.span_s.1,
        "sample_period_s": found.step_s,
        "speed_m_s": found.speed.as_ref().map(statistics),
        "wheel_speeds": found.wheels.as_ref().map(wheels_document),
        "corners": found.corners.iter().map(corner).collect::<Map<String, Value>>(),
        "doubts": found.doubts(),
    })
}

fn wheels_document(wheels: &FoundWheels) -> Value {
    let optional = |found: &Option<Statistics>| found.as_ref().map(statistics);
    json!({
        "unit": wheels.unit,
        "speeds": wheels.speeds.each_ref().map(optional),
        "ratios_1e3": wheels.ratios_1e3.each_ref().map(optional),
        "yaw_rate_rad_s": optional(&wheels.yaw_rate_rad_s),
        "accel_x_m_s2": optional(&wheels.accel_x_m_s2),
    })
}

/// A figure that is not known becomes `null`.
fn statistics(s: &Statistics) -> Value {
    json!({
        "samples": s.samples,
        "missing": s.missing,
        "mean": s.mean,
        "sd": s.sd,
        "lowest": s.low,
        "highest": s.high,
        "smallest_step": s.smallest_step,
        "repeated_at_limit": s.repeated_at_limit,
    })
}
