//! Sentences about a map of signals and a log that do not fit.

use itpms_files::nearest;

use super::units::Unit;
use crate::log::{Quantity, Slot};

/// The message for an unusable unit.
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

/// A signal that is not among these names of a log and its definitions.
pub(crate) fn not_there<'a>(
    line: usize,
    column: &str,
    signal: &str,
    of: usize,
    names: impl Iterator<Item = &'a str>,
) -> String {
    let nothing = match nearest(signal, names) {
        Some(name) => format!("there is no such signal; the nearest name of {of} is {name:?}"),
        None => format!("there is no such signal among {of} (itpms signals lists them)"),
    };
    format!("line {line}: {column} is to be {signal:?}, but {nothing}")
}
