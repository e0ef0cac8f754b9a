//! The study as text.

use std::fmt::Write as _;

use super::{Row, Study};

impl Study {
    /// A line per kind of malfunction, one for the drives without, and what the columns mean.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{:33} {:>9} {:>7} {:>7} {:>7} {:>7}  {:>13} {:>13} {:>13} {:>7}",
            "malfunction",
            "said",
            "named",
            "median",
            "worst",
            "stated",
            "wrong, before",
            "wrong, after",
            "back: median",
            "worst"
        );
        for row in &self.rows {
            let _ = writeln!(text, "{}", line(row));
        }
        let clean = &self.clean;
        let _ = writeln!(
            text,
            "nothing wrong: {} malfunctions and {} warnings said in {:.1} h, {:.0} km; {:.2} % of the wheels' time kept from the estimator; shown pressures more than 3 sd and 20 kPa off {:.2} % of the time, more than 20 kPa {:.1} %",
            clean.malfunctions,
            clean.warnings,
            clean.hours,
            clean.distance_km,
            100.0 * clean.share_screened,
            100.0 * clean.share_wrong,
            100.0 * clean.share_far,
        );
        text.push_str(
            "Times in s of driving. wrong: mean time in s per drive in which a pressure more than 3 sd and 20 kPa off was shown, before the malfunction was said and in the 20 s after. back: from its end until nothing is said and a right pressure is shown.\n",
        );
        text
    }
}

fn line(row: &Row) -> String {
    format!(
        "{:33} {:>9} {:>7} {:>7} {:>7} {:>7}  {:>13} {:>13} {:>13} {:>7}{}",
        row.name,
        format!("{}/{}", row.said, row.drives),
        format!("{}/{}", row.named, row.said),
        seconds(row.said_median_s),
        seconds(row.said_worst_s),
        seconds(row.stated_s),
        format!("{:.2}", row.wrong_before_s),
        format!("{:.2}", row.wrong_after_s),
        seconds(row.recovered_median_s),
        seconds(row.recovered_worst_s),
        if row.in_time == row.drives { "" } else { "  late" },
    )
}

fn seconds(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "-".to_owned() }
}
