//! A table as its format has it, whatever its rows are.

use std::fmt::Debug;

use super::format::Format;
use super::header::Header;
use super::slot::RawRow;
use crate::error::{Place, Problem};

/// A table of one format, row by row.
pub(super) trait TableFormat: Debug + Send {
    fn header(&self) -> &Header;

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem>;

    fn progress(&self) -> f64;

    fn format(&self) -> Option<Format> {
        None
    }

    /// Whether the last line was cut off and left out.
    fn cut_off(&self) -> bool {
        false
    }

    /// Repairs and omissions so far.
    fn repairs(&self) -> Vec<String> {
        Vec::new()
    }

    /// The names of two parts of a folder with rows of the same time.
    fn overlap(&self) -> Option<&(String, String)> {
        None
    }
}
