//! Logs by signal instead of by row: bus logs and measurement files whose signals have their own clocks.
//!
//! | module | idea |
//! |---|---|
//! | `map` | which signal is which column, as a person writes it (`map.toml`) |
//! | `resolve` | the same found by names where it was not written |
//! | `names` | what a name says in words |
//! | `column_unit` | the unit in the name of a table's column |
//! | `units` | from the log's unit to the column's |
//! | `remark` | by what a signal is a column, and what is doubtful |
//! | `report` | all of this in words, and as a map to start from |
//! | `problem` | what can be wrong |
//! | `listing` | what is in a log: every signal with its rate and range |
//! | [`align`] | readings on their own clocks to rows |
//!
//! Called by the log reader and by whoever listens to a bus; knows nothing of estimators.

pub mod align;
pub(crate) mod column_unit;
pub(crate) use column_unit::is_unit;
pub(crate) mod listing;
mod map;
pub(crate) mod names;
mod remark;
mod report;
mod resolve;
mod sentences;
mod units;

use itpms_core::model::Corner;

use crate::log::Slot;
pub use align::Aligner;
pub use listing::{ListedGroup, ListedSignal, Lister, Listing};
pub use map::SignalMap;
use map::{Entry, Scale};
pub use remark::{Remark, Source};
pub use report::doubt_of;
#[cfg(any(feature = "can", feature = "mdf4"))]
pub(crate) use resolve::contested;
pub use resolve::{Chosen, Resolved, resolve, resolve_among, resolve_knowing};
pub(crate) use sentences::not_there;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    pub time_s: f64,
    pub slot: Slot,
    /// The value in the unit of [`Slot::name`]; NaN is a value that was sent as invalid.
    pub value: f64,
}

/// A signal that could be a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Candidate {
    /// The message or channel group it is in; may be empty.
    pub group: String,
    pub name: String,
    /// Its unit as the file has it; empty where it says nothing.
    pub unit: String,
}

impl Candidate {
    /// Group, dot, name: what a map calls it.
    pub fn full_name(&self) -> String {
        if self.group.is_empty() { self.name.clone() } else { format!("{}.{}", self.group, self.name) }
    }

    fn is_called(&self, full_name: &str) -> bool {
        let rest = full_name.strip_prefix(self.group.as_str());
        match (self.group.is_empty(), rest) {
            (true, _) => full_name == self.name,
            (false, Some(rest)) => rest.strip_prefix('.') == Some(self.name.as_str()),
            (false, None) => false,
        }
    }
}

/// What an element of an array is called as a signal. Four elements whose name says what of a wheel they are, and not of which, are one for
/// each wheel, in the order in which all write them: `WheelSpeed[fl]`, `[fr]`, `[rl]`, `[rr]`. Others keep their number.
#[cfg_attr(not(any(feature = "mdf4", feature = "mcap")), expect(dead_code))]
pub(crate) fn element_name(group: &str, array: &str, unit: &str, number: usize, of: usize) -> String {
    let of_wheel = |corner: Corner| {
        let name = format!("{array}[{}]", corner.label());
        let is_own = names::meaning_in(group, &name, unit)
            .is_some_and(|(slot, _)| matches!(slot, Slot::Corner(own, _) if own == corner));
        is_own.then_some(name)
    };
    let corner = Corner::ALL.get(number).copied().filter(|_| of == Corner::ALL.len());
    corner.and_then(of_wheel).unwrap_or_else(|| format!("{array}[{number}]"))
}

/// Something in a log that could be a signal but cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unread {
    pub candidate: Candidate,
    /// Why it is not read, as the end of "it is".
    pub why: String,
}

/// From one unit to another: times the factor, plus the offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    pub factor: f64,
    /// Added then, in the new unit.
    pub offset: f64,
}

impl Conversion {
    pub const IDENTITY: Self = Self { factor: 1.0, offset: 0.0 };

    /// The value in the new unit.
    pub fn apply(self, value: f64) -> f64 {
        value * self.factor + self.offset
    }
}
