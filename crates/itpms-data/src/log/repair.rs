//! Repairs by the reader, in numbers and in words. Filled by the reader, shown by the binary and the report.

/// Counts over the rows read so far; complete once the reader has returned `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RepairReport {
    pub rows_read: u64,
    pub rows_kept: u64,
    /// Acceleration cells without a value, over all corners.
    pub missing_accelerations: u64,
    /// Acceleration columns that never have a value, by name.
    pub dead_columns: Vec<String>,
    /// Speed cells without a value in a log that has the column.
    pub missing_speeds: u64,
    /// Rows without a time, left out.
    pub without_time: u64,
    /// Rows whose time contradicts that of the others, left out.
    pub out_of_order: u64,
    /// Rows that came after a later one, put into the order of their times.
    pub put_in_order: u64,
    /// Rows under a clock coarser than they are, spread evenly between its steps.
    pub spread: u64,
    /// Rows with the time of the row before, left out.
    pub duplicate_times: u64,
    /// Steps in time of more than three sample periods.
    pub gaps: u64,
    /// The longest of them in s, and the time in s at which it begins.
    pub longest_gap: Option<(f64, f64)>,
    /// Lines cut off at the end of the file, left out: 0 or 1.
    pub cut_off_lines: u64,
    /// Repairs, omissions and assumptions of the format's reader, in words.
    pub format: Vec<String>,
    /// Accelerations whose values are the same in all rows that were looked at first: one column, twice.
    pub same_columns: Vec<(String, String)>,
    /// Columns that are ignored although their name is close to one that means something: (found, meant).
    pub misspelled_columns: Vec<(String, String)>,
}

impl RepairReport {
    /// Whether the log was flawless.
    pub fn is_clean(&self) -> bool {
        self.warnings().is_empty()
    }

    /// Counts of the findings, zeros left out.
    pub fn counts(&self) -> Vec<(&'static str, u64)> {
        let all = [
            ("missing acceleration values", self.missing_accelerations),
            ("missing speed values", self.missing_speeds),
            ("rows without a time", self.without_time),
            ("rows out of order", self.out_of_order),
            ("rows put in order", self.put_in_order),
            ("rows spread between the steps of a coarse clock", self.spread),
            ("rows that repeat a time", self.duplicate_times),
            ("lines cut off at the end", self.cut_off_lines),
            ("gaps of more than 3 sample periods", self.gaps),
        ];
        all.into_iter().filter(|(_, count)| *count > 0).collect()
    }

    /// One sentence per kind of repair, without the file's name.
    pub fn warnings(&self) -> Vec<String> {
        let mut out = self.format.clone();
        let mut say = |count: u64, one: &str, many: &str| {
            if count > 0 {
                out.push(format!("{count} {}", if count == 1 { one } else { many }));
            }
        };
        say(
            self.missing_accelerations,
            "acceleration value is missing (empty, infinite, NaN or null)",
            "acceleration values are missing (empty, infinite, NaN or null)",
        );
        say(self.missing_speeds, "speed value is missing", "speed values are missing");
        say(self.without_time, "row has no time and was left out", "rows have no time and were left out");
        say(
            self.out_of_order,
            "row is out of order and was left out",
            "rows are out of order and were left out",
        );
        say(
            self.put_in_order,
            "row came after a later one and was put into the order of time",
            "rows came after a later one and were put into the order of time",
        );
        say(
            self.spread,
            "row shares its time with others under a coarse clock and was spread evenly",
            "rows share their times with others under a coarse clock and were spread evenly",
        );
        say(
            self.duplicate_times,
            "row repeats the time of the row before and was left out",
            "rows repeat the time of the row before and were left out",
        );
        say(self.cut_off_lines, "line at the end is cut off (it has no line end) and was left out", "");
        if let Some((length_s, begin_s)) = self.longest_gap {
            let gaps = if self.gaps == 1 { "gap" } else { "gaps" };
            out.push(format!(
                "{} {gaps} of more than 3 sample periods, the longest {} s at {} s",
                self.gaps,
                milli(length_s),
                milli(begin_s)
            ));
        }
        for column in &self.dead_columns {
            out.push(format!("column {column} has no value at all"));
        }
        for (one, other) in &self.same_columns {
            out.push(format!(
                "columns {one} and {other} have the same values: one sensor's, there twice; what is reported of these wheels is wrong"
            ));
        }
        for (found, meant) in &self.misspelled_columns {
            out.push(format!("column {found} is not known and was ignored (did you mean {meant}?)"));
        }
        out
    }
}

/// Rounded to milliseconds, without trailing zeros.
fn milli(seconds: f64) -> f64 {
    (seconds * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clean_report_says_nothing_and_others_count() {
        assert!(RepairReport { rows_read: 10, rows_kept: 10, ..Default::default() }.is_clean());
        let report = RepairReport {
            out_of_order: 1,
            missing_accelerations: 12,
            gaps: 2,
            longest_gap: Some((1.500_000_2, 17.25)),
            ..Default::default()
        };
        assert_eq!(report.counts().len(), 3);
        assert_eq!(
            report.warnings(),
            [
                "12 acceleration values are missing (empty, infinite, NaN or null)",
                "1 row is out of order and was left out",
                "2 gaps of more than 3 sample periods, the longest 1.5 s at 17.25 s",
            ]
        );
    }
}
