//! By what a signal is a column, and what is doubtful about one. Made by the resolver, printed by the report.

use std::fmt;

use super::sentences::{stated, suggested};
use crate::log::Slot;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    Map,
    Name,
    /// The signal has the column's name in other letters.
    Letters,
    Words,
    SomeWords,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Source::Map => "by the map",
            Source::Name => "by its name",
            Source::Letters => "by its name but for case and punctuation",
            Source::Words => "by the words of its name",
            Source::SomeWords => "by some words of its name",
        })
    }
}

/// A doubt about a column's signal.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remark {
    /// Several signals could be it; none is taken.
    Ambiguous { slot: Slot, signals: String, first: String },
    /// A signal could be it, but its unit is not stated or not known; it is not taken.
    Unit { slot: Slot, signal: String, unit: String },
    /// A signal could be it, but cannot be read.
    Unread { slot: Slot, signal: String, why: String },
    /// A signal could be it, but has no samples in this log; it is not taken.
    NoSamples { slot: Slot, signal: String },
    /// The map has one signal for two columns.
    UsedTwice { signal: String, slots: [Slot; 2] },
}

impl Remark {
    /// Whether a corner may lack an acceleration because of it.
    pub(super) fn is_of_acceleration(&self) -> bool {
        match self {
            Remark::Ambiguous { slot, .. }
            | Remark::Unit { slot, .. }
            | Remark::Unread { slot, .. }
            | Remark::NoSamples { slot, .. } => slot.is_acceleration(),
            Remark::UsedTwice { .. } => false,
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Remark::Ambiguous { slot, signals, first } => {
                let column = slot.name();
                if signals.split(", ").all(|signal| signal == first) {
                    return write!(f, "several columns are called {first}: none taken; rename all but one");
                }
                write!(
                    f,
                    "{column} could be any of {signals}: not taken; say which in a map, {column} = \"{first}\""
                )
            }
            Remark::Unit { slot, signal, unit } => {
                let (column, stated) = (slot.name(), stated(unit));
                let suggested = suggested(*slot, signal, unit);
                write!(
                    f,
                    "{column} could be {signal}, whose unit {stated}: not taken; say it in a map, {suggested}"
                )
            }
            Remark::Unread { slot, signal, why } => {
                write!(f, "{} could be {signal}, which cannot be read: it is {why}", slot.name())
            }
            Remark::NoSamples { slot, signal } => {
                write!(f, "{} could be {signal}, which has no samples in this log", slot.name())
            }
            Remark::UsedTwice { signal, slots: [first, second] } => {
                write!(f, "{signal} is both {} and {}", first.name(), second.name())
            }
        }
    }
}
