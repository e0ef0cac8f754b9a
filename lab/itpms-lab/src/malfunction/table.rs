//! The study as text.

use std::fmt::Write as _;

use super::{Row, Study};

impl Study {
    /// How many malfunctions are marked in the table, and one more if anything was reported on the drives without.
    pub fn marked(&self) -> usize {
        let rows = self.rows.iter().filter(|row| !marks(row).is_empty()).count();
        rows + usize::from(self.clean.malfunctions + self.clean.warnings > 0)
    }

    /// A line per kind of malfunction, one for the drives without, and what the columns mean.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{:33} {:>24} {:>22} {:>35} {:>6} {:>6} {:>20}",
            "", "reported", "time until then", "wrong pressure shown: its + others", "other", "tires", "back"
        );
        let head = "malfunction reported alike exactly median worst stated before after back \
                    reported warned of median worst";
        let _ = writeln!(text, "{}", columns(head.split(' ')));
        for row in &self.rows {
            let _ = writeln!(text, "{}", line(row));
        }
        let clean = &self.clean;
        let _ = writeln!(
            text,
            "nothing wrong: {} malfunctions and {} warnings reported in {:.1} h, {:.0} km; {:.2} % of the wheels' time kept from the estimator; shown pressures more than 3 sd and 20 kPa off {:.2} % of the time, more than 20 kPa {:.1} %",
            clean.malfunctions,
            clean.warnings,
            clean.hours,
            clean.distance_km,
            100.0 * clean.share_screened,
            100.0 * clean.share_wrong,
            100.0 * clean.share_far,
        );
        text.push_str(MEANING);
        text
    }
}

const MEANING: &str = "\
Times in s of driving. reported alike: by its name or that of what it looks like, at any of its wheels; exactly: kind and \
sensors, and nothing beside. wrong: mean time in s per drive in which a pressure more than 3 sd and 20 kPa off was shown, \
at the malfunction's wheels + at the others, before it was reported, in the 20 s after, and in the 120 s after its end. other \
reported: malfunctions reported from its begin to then that are not it. tires warned: warnings of tires in that time, all of them \
false. back: from its end until nothing is reported, its wheels show a right pressure and no wheel a wrong one; of: in how \
many of the drives that went on for a minute; the times are of these.
";

fn columns<T: std::fmt::Display>(cells: impl IntoIterator<Item = T>) -> String {
    const WIDTHS: [usize; 15] = [33, 9, 7, 7, 8, 7, 6, 12, 12, 10, 6, 7, 7, 7, 6];
    let cells = cells.into_iter().zip(WIDTHS).enumerate().map(|(i, (cell, width))| match i {
        0 => format!("{cell:width$}"),
        _ => format!("{cell:>width$}"),
    });
    cells.collect::<Vec<_>>().join(" ")
}

fn line(row: &Row) -> String {
    let both = |its: f64, others: f64| format!("{its:.2}+{others:.2}");
    let cells = [
        row.name.to_owned(),
        format!("{}/{}", row.said, row.drives),
        format!("{}/{}", row.named, row.said),
        format!("{}/{}", row.named_exactly, row.said),
        seconds(row.said_median_s),
        seconds(row.said_worst_s),
        seconds(row.stated_s),
        both(row.wrong_before_s, row.wrong_before_others_s),
        both(row.wrong_after_s, row.wrong_after_others_s),
        both(row.wrong_back_s, row.wrong_back_others_s),
        row.others_said.to_string(),
        row.tire_warnings_during.plus(row.tire_warnings_after).total().to_string(),
        format!("{}/{}", row.recovered, row.awaited),
        seconds(row.recovered_median_s),
        seconds(row.recovered_worst_s),
    ];
    let marks = marks(row);
    columns(cells) + &if marks.is_empty() { marks } else { format!("  {marks}") }
}

/// The failed requirements, in words; empty where all are met.
fn marks(row: &Row) -> String {
    let tires = row.tire_warnings_during.plus(row.tire_warnings_after);
    let causes = [
        ("low", tires.low),
        ("fast leak", tires.fast_leak),
        ("all low", tires.all_low),
        ("over", tires.over),
    ];
    let causes =
        causes.iter().filter(|(_, count)| *count > 0).map(|(cause, count)| format!("{cause} {count}"));
    let causes = causes.collect::<Vec<_>>().join(", ");
    let marks = [
        (row.in_time < row.drives, "late".to_owned()),
        (row.recovered < row.awaited, "not all back".to_owned()),
        (!causes.is_empty(), format!("false warnings: {causes}")),
    ];
    marks.into_iter().filter(|(holds, _)| *holds).map(|(_, mark)| mark).collect::<Vec<_>>().join("; ")
}

fn seconds(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "-".to_owned() }
}
