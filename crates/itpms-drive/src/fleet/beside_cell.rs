//! A drive's findings beside tires' pressures and dampers: load, cold pressures, forces once per turn, the tires' own sensors; in words, and as a
//! cell of the fleet's page.
//!
//! Called by the fleet for each drive, and by the page's writer.

use itpms_analysis::beside::SensorState;
use itpms_analysis::plot::escape;
use itpms_analysis::report::cold_text;
use itpms_analysis::rotation::RotationState;
use itpms_analysis::suspension::LoadState;
use itpms_core::model::{Corner, PressureUnit};

use super::record::DriveRecord;
use crate::run::Done;

/// Standard deviations from zero at which a force is significant.
const SURE: f64 = 3.0;

/// Each with whether it needs attention.
pub(super) fn lines(done: &Done, unit: PressureUnit) -> Vec<(String, bool)> {
    let mut lines = Vec::new();
    let load = done.beside.suspension.as_ref().map(|verdict| &verdict.load);
    if let Some((masses, load)) = load.and_then(|load| Some((load.masses.as_ref()?, load))) {
        let over = load.state == LoadState::Overload;
        let kg = |masses: f64| format!("{masses:.0}\u{a0}kg");
        let words = format!(
            "{} ± {:.0}, {:+.0} added",
            kg(masses.total_kg.value),
            masses.total_kg.sd,
            masses.added_kg.value
        );
        lines.push((if over { format!("overload: {words}") } else { words }, over));
    }
    lines.extend(done.beside.sent_loads.line().map(|line| {
        let over = line.ends_with("OVERLOAD");
        (line, over)
    }));
    let short = |corner: Corner| corner.label().to_uppercase();
    let colds = done.data.corners.iter().filter_map(|corner| {
        let (at, add) = cold_text(&corner.figures.cold?, corner.placard_kpa, unit);
        Some((corner.corner, at, add))
    });
    let colds: Vec<_> = colds.collect();
    lines.extend(
        colds.iter().filter_map(|(corner, at, add)| {
            Some((format!("{} {at}: {}", short(*corner), add.as_ref()?), true))
        }),
    );
    if !colds.is_empty() && colds.iter().all(|(_, _, add)| add.is_none()) {
        lines.push(("cold pressures: nothing to add".to_owned(), false));
    }
    for (i, corner) in Corner::ALL.into_iter().enumerate() {
        if let Some((one, force)) = done.beside.once_per_turn[i]
            .and_then(|one| Some((one, one.force_n.filter(|force| force.value > SURE * force.sd)?)))
        {
            let risen = one.state == RotationState::Rising;
            let words =
                format!("{} {:.0} ± {:.0}\u{a0}N once per turn", short(corner), force.value, force.sd);
            lines.push((if risen { words + ", rising" } else { words }, risen));
        }
        let sensor = done.beside.sensors[i].state;
        if !matches!(sensor, SensorState::Learning | SensorState::Fine) {
            lines.push((format!("{} sensor: {}", short(corner), sensor.label()), true));
        }
    }
    lines
}

pub(super) fn any(drives: &[DriveRecord]) -> bool {
    drives.iter().any(|drive| !drive.beside.is_empty())
}

/// Findings of the car's newest drive; its report has the rest.
pub(super) fn cell(last: &DriveRecord) -> String {
    let line = |(words, look): &(String, bool)| {
        let tag = if *look { "b" } else { "span" };
        format!("<{tag}>{}</{tag}>", escape(words))
    };
    let lines: String = last.beside.iter().map(line).collect();
    format!("<td class=\"beside\" data-label=\"beside\">{}</td>", if lines.is_empty() { "–" } else { &lines })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_what_the_newest_drive_says_and_marks_what_is_to_be_looked_at() {
        let lines = vec![("RR sensor: drift".to_owned(), true), ("1700 kg <b>".to_owned(), false)];
        let drive = DriveRecord { beside: lines, ..DriveRecord::default() };
        assert!(cell(&drive).ends_with("<b>RR sensor: drift</b><span>1700 kg &lt;b&gt;</span></td>"));
        assert!(any(&[DriveRecord::default(), drive]) && !any(&[DriveRecord::default()]));
        assert!(cell(&DriveRecord::default()).contains('–'));
    }
}
