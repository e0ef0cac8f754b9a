//! A place in a file, as messages name it. Used by every kind of problem; knows none of them.

use std::fmt;

/// Where in a file: text has lines, a table has rows. Both count from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Line of a text file, the header being line 1.
    Line(u64),
    /// Row of a table without lines.
    Row(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Row(row) => write!(f, "row {row}"),
        }
    }
}
