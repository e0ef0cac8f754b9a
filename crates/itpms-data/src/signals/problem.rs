//! What can be wrong with a map of signals, or between a map and a log.
//!
//! Made by the modules beside it; read by people as part of a [`Problem`](crate::error::Problem).

use thiserror::Error;

use super::Conversion;
use super::units::Unit;
use crate::log::Quantity;
use crate::log::Slot;

/// One kind of problem with signals.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SignalProblem {
    /// An unknown unit, or one of something else.
    #[error(
        "line {line}: {column} has unit {unit:?}, expected {} (or factor and offset instead)",
        Quantity::of(*.slot).known_units()
    )]
    MapUnit { line: usize, column: String, slot: Slot, unit: String },
    /// A factor of zero, or numbers that are not finite.
    #[error(
        "line {line}: {column} has factor {} and offset {}, expected a finite factor that is not 0 and a finite offset",
        .conversion.factor, .conversion.offset
    )]
    MapNumbers { line: usize, column: String, conversion: Conversion },
    /// Two ways to say the same.
    #[error("line {line}: {column} has a unit and a factor or offset, expected one of the two")]
    UnitAndNumbers { line: usize, column: String },
    /// A signal that the log and its definitions do not have.
    #[error("line {line}: {column} is to be {signal:?}, but {}", nothing_like_it(*.of, .nearest))]
    NotThere {
        line: usize,
        column: String,
        signal: String,
        of: usize,
        /// The most similar name that is there.
        nearest: Option<String>,
    },
    /// A name that several signals have.
    #[error("line {line}: {column} is to be {signal:?}, which could be {found}: expected one of these")]
    Several {
        line: usize,
        column: String,
        signal: String,
        /// Some of the signals of that name.
        found: String,
    },
    /// A signal that is there and cannot be read.
    #[error("line {line}: {column} is to be {signal:?}, which cannot be read: it is {why}")]
    Unread { line: usize, column: String, signal: String, why: String },
    /// A full name that several signals have.
    #[error(
        "line {line}: {column} is to be {signal:?}, of which there are {groups} at the same times: nothing tells them apart, expected one (leave the other groups out of the log, or give them names)"
    )]
    SameName { line: usize, column: String, signal: String, groups: usize },
    /// The log's unit says nothing, and the map does not say it either.
    #[error(
        "line {line}: {column} is to be {signal:?}, whose unit {}, expected {}: give it in the map, {}",
        stated(.unit), Quantity::of(*.slot).words(), suggested(*.slot, signal, unit)
    )]
    Unit {
        line: usize,
        column: String,
        slot: Slot,
        signal: String,
        /// Its unit as the log has it.
        unit: String,
    },
}

/// What to say of a unit that is of no use.
pub(super) fn stated(unit: &str) -> String {
    if unit.is_empty() { "is not stated".to_owned() } else { format!("is stated as {unit:?}") }
}

/// How a map would say what the unit does not. A unit is suggested only where none is stated: one that is stated and of no use is not
/// contradicted, but converted.
pub(super) fn suggested(slot: Slot, signal: &str, unit: &str) -> String {
    let (column, quantity) = (slot.name(), Quantity::of(slot));
    let numbers = "factor = ..., offset = ...";
    match Unit::of(unit) {
        Unit::Silent => {
            let known = quantity.known_units();
            format!(
                "{column} = {{ signal = \"{signal}\", unit = \"{}\" }} (or {known}), or {numbers}",
                quantity.unit()
            )
        }
        _ => {
            format!("{column} = {{ signal = \"{signal}\", {numbers} }}, which make {} of it", quantity.unit())
        }
    }
}

fn nothing_like_it(of: usize, nearest: &Option<String>) -> String {
    match nearest {
        Some(name) => format!("there is no such signal; the nearest name of {of} is {name:?}"),
        None => format!("there is no such signal among {of} (itpms signals lists them)"),
    }
}
