//! Where readings come from, whatever the format.

use std::fmt::Debug;

use super::stamps::Fate;
use super::table_format::TableFormat;
use crate::error::Problem;
use crate::signals::Reading;

/// Where readings come from, nearly in the order of time.
pub(super) trait Feed: Debug + Send {
    /// Hands out a few readings; false when there are no more.
    fn step(&mut self, take: &mut dyn FnMut(Fate<Reading>)) -> Result<bool, Problem>;

    fn progress(&self) -> f64;

    /// Repairs, omissions and assumptions of the format's reader so far.
    fn repairs(&self) -> Vec<String>;

    /// How a table was understood, in words.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// When time 0 was, in ns since 1970. Frames of a bus are stamped with that included.
    fn start_ns(&self) -> u64 {
        0
    }

    fn table(&self) -> Option<&dyn TableFormat> {
        None
    }
}
