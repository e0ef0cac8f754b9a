//! Frames of a bus to the columns of a log and back, by a description of the bus.
//!
//! Called by the reader of bus logs, by the live monitor and by `itpms signals`. The description itself, messages and signals, is
//! [`itpms_can_log::dbc`]; here is which of its signals are columns.

mod decoder;
mod encoder;

pub use decoder::{Decoder, FrameCounts};
pub use encoder::{EncodeCounts, Encoder};
pub use itpms_can_log::dbc::*;

use std::path::Path;

use crate::error::{DataError, Problem};
use crate::log::of_description;
use crate::signals::Candidate;

/// The description in this file. Errors: it cannot be read, or is a description of another format.
pub fn described(path: &Path) -> Result<Dbc, DataError> {
    match of_description(path) {
        Some(way_out) => Err(DataError::new(path, Problem::Elsewhere(way_out))),
        None => Ok(Dbc::read(path)?),
    }
}

/// All signals of all messages, as candidates for columns. A signal that a message has in several layouts is one.
pub fn candidates(dbc: &Dbc) -> Vec<Candidate> {
    let signals =
        dbc.messages().iter().flat_map(|m| m.first_layouts().map(move |place| (m, &m.signals[place])));
    let candidate = |(message, signal): (&Message, &Signal)| Candidate {
        group: message.name.clone(),
        name: signal.name.clone(),
        unit: signal.unit.clone(),
    };
    signals.map(candidate).collect()
}

/// Message and place of the signal in it, in its first layout, of the candidate with this number.
pub fn of_candidate(dbc: &Dbc, number: usize) -> Option<(&Message, usize)> {
    dbc.messages().iter().flat_map(|m| m.first_layouts().map(move |place| (m, place))).nth(number)
}
