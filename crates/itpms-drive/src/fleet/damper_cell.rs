//! A car's dampers on the fleet's page: what each one damped over the calibration's, drive by drive, and what the newest drive that could say
//! says of them.
//!
//! Called by the page's writer.

use std::fmt::Write as _;

use super::dampers::ROW;
use super::record::{DamperRecord, DriveRecord};

const WHEELS: [&str; 4] = ["fl", "fr", "rl", "rr"];
const LINE: usize = 60;

pub(super) fn any(drives: &[DriveRecord]) -> bool {
    drives.iter().any(is_judged)
}

fn is_judged(drive: &DriveRecord) -> bool {
    drive.wheels.iter().filter_map(|wheel| wheel.damper.as_ref()).any(judged)
}

/// Whether the newest drive that could tell reports a damper.
pub(super) fn is_reported(drives: &[&DriveRecord]) -> bool {
    let last = drives.iter().rev().find(|drive| is_judged(drive));
    last.is_some_and(|drive| {
        drive.wheels.iter().filter_map(|wheel| wheel.damper.as_ref()).any(|damper| damper.reported)
    })
}

fn judged(damper: &DamperRecord) -> bool {
    matches!(damper.state.as_str(), "fine" | "weak" | "worn" | "stiff")
}

fn of<'a>(drive: &'a DriveRecord, name: &str) -> Option<&'a DamperRecord> {
    drive.wheels.iter().find(|wheel| wheel.wheel == name)?.damper.as_ref().filter(|damper| judged(damper))
}

pub(super) fn cell(drives: &[&DriveRecord]) -> String {
    let known: Vec<&DriveRecord> = drives.iter().copied().filter(|drive| is_judged(drive)).collect();
    let Some(last) = known.last() else {
        return "<td class=\"dampers\" data-label=\"dampers\" data-sort=\"\">–</td>".to_owned();
    };
    let states = WHEELS.map(|name| (name, of(last, name)));
    let mut words = String::new();
    for (name, damper) in states {
        let Some(damper) = damper.filter(|damper| damper.state != "fine") else { continue };
        let over =
            damper.over_reference.map_or_else(String::new, |over| format!(" {:.0}\u{a0}%", 100.0 * over));
        let _ = write!(
            words,
            "<b class=\"{}\">{} {}{over}</b>{} ",
            damper.state,
            name.to_uppercase(),
            damper.state,
            if damper.reported { String::new() } else { format!(" in {} of {ROW}\u{a0}drives", damper.row) }
        );
    }
    if words.is_empty() {
        let all = states.iter().all(|(_, damper)| damper.is_some());
        words.push_str(if all { "fine" } else { "some not judged" });
    }
    let worst =
        states.iter().filter_map(|(_, damper)| damper.as_ref()?.over_reference).fold(f64::NAN, f64::min);
    let sort = if worst.is_finite() { format!("{worst:.4}") } else { String::new() };
    format!(
        "<td class=\"dampers line\" data-label=\"dampers\" data-sort=\"{sort}\">{}{words}</td>",
        lines(&known)
    )
}

/// A line for each damper, and the calibration's; nothing of a single drive.
fn lines(drives: &[&DriveRecord]) -> String {
    let recent = &drives[drives.len().saturating_sub(LINE)..];
    if recent.len() < 2 {
        return String::new();
    }
    let x = |i: usize| 4.0 + 112.0 * i as f64 / (recent.len() - 1) as f64;
    let y = |over: f64| 31.0 - 28.0 * (over - 0.3).clamp(0.0, 1.0);
    let mut out = format!(
        "<svg viewBox=\"0 0 120 34\" role=\"img\" aria-label=\"What the four dampers damped over {} drives, over the calibration’s\">\
         <path class=\"placard\" d=\"M4 {:.1}H116\"/>",
        recent.len(),
        y(1.0)
    );
    for name in WHEELS {
        let over = |(i, drive): (usize, &&DriveRecord)| Some((i, of(drive, name)?.over_reference?));
        let points: Vec<String> = (recent.iter().enumerate().filter_map(over))
            .filter(|(_, over)| over.is_finite())
            .map(|(i, over)| format!("{:.1},{:.1}", x(i), y(over)))
            .collect();
        let state = recent.iter().rev().find_map(|drive| of(drive, name)).map_or("", |damper| &damper.state);
        let _ = write!(out, "<polyline class=\"{state}\" points=\"{}\"/>", points.join(" "));
    }
    out + "</svg>"
}

#[cfg(test)]
mod tests {
    use super::super::record::sample;
    use super::*;

    #[test]
    fn a_cars_dampers_are_lines_over_its_drives_and_what_the_newest_judged_one_says() {
        let drives = [
            sample("rl", "weak", 0.7),
            sample("rl", "weak", 0.6),
            sample("rl", "worn", 0.5),
            sample("rl", "unknown", 1.0),
        ];
        let all: Vec<&DriveRecord> = drives.iter().collect();
        let shown = cell(&all);
        assert!(shown.contains("<b class=\"worn\">RL worn 50\u{a0}%</b>"), "{shown}");
        assert!(shown.contains("data-sort=\"0.5000\""), "{shown}");
        // Three drives on the line, the last of them at half of the calibration's: 31 - 28 * (0.5 - 0.3) = 25.4.
        assert!(shown.contains("over 3 drives") && shown.contains("116.0,25.4"), "{shown}");
        assert!(cell(&all[3..]).contains("–") && !any(&drives[3..]) && any(&drives));
        assert!(!cell(&all[..1]).contains("<svg"));
    }
}
