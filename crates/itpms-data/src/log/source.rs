//! Where rows come from, whatever the format: names first, then values, row by row. Called by the reader.

use std::fmt::Debug;
use std::path::Path;

use super::header::Header;
use super::slot::RawRow;
use super::slow_speed::SlowSpeed;
use super::table_format::TableFormat;
use super::telling;
use crate::error::{Place, Problem};
use crate::signals::align::AlignmentReport;

/// A log as rows.
pub(super) trait Source: Debug + Send {
    fn header(&self) -> &Header;

    /// Fills `row` with the next row, NaN where missing; `None` at the end.
    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem>;

    /// Share of the file that has been read, 0 to 1.
    fn progress(&self) -> f64;

    /// Repairs, omissions and assumptions of the format's own reader so far.
    fn repairs(&self) -> Vec<String>;

    /// How the clock and the rows of a table were understood, how signals came into order and into rows, in words.
    fn remarks(&self) -> Vec<String>;

    /// The table that the rows come from.
    fn table(&self) -> Option<&dyn TableFormat>;

    /// When time 0 was, in ns since 1970; 0 where only the times themselves know.
    fn start_ns(&self) -> u64 {
        0
    }

    /// Whether rows come in the order of their times.
    fn is_in_order(&self) -> bool {
        false
    }

    /// The speed of a table, where it comes at a rate of its own; that of signals is in every row.
    fn slow_speed(&self) -> SlowSpeed {
        SlowSpeed::default()
    }

    /// How signals were put into rows; `None` for tables of samples.
    fn alignment(&self) -> Option<AlignmentReport> {
        None
    }

    /// Remedy where the rows are of two recordings.
    fn one_of_two(&self, path: &Path) -> Option<String> {
        let table = self.table()?;
        match table.overlap() {
            Some((one, other)) => Some(format!(
                "the parts {one} and {other} have rows of the same time: give one of the two, or a folder for each recording"
            )),
            None => table.format().and_then(|format| telling::way_out(path, format)),
        }
    }
}
