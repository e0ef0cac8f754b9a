//! Frames of a bus to the columns of a log and back, by a description of the bus.
//!
//! Called by the reader of bus logs, by the live monitor and by `itpms signals`. The description itself, messages and signals, is
//! [`itpms_can_log::dbc`]; here is which of its signals are columns.

mod decoder;
mod encoder;

pub use decoder::{Decoder, FrameCounts};
pub use encoder::{EncodeCounts, Encoder};
pub use itpms_can_log::dbc::*;

use crate::signals::Candidate;

/// All signals of all messages, as candidates for columns.
#[must_use]
pub fn candidates(dbc: &Dbc) -> Vec<Candidate> {
    let signals = dbc.messages().iter().flat_map(|m| m.signals.iter().map(move |signal| (m, signal)));
    let candidate = |(message, signal): (&Message, &Signal)| Candidate {
        group: message.name.clone(),
        name: signal.name.clone(),
        unit: signal.unit.clone(),
    };
    signals.map(candidate).collect()
}

/// Message and place of the signal in it of the candidate with this number.
#[must_use]
pub fn of_candidate(dbc: &Dbc, mut number: usize) -> Option<(&Message, usize)> {
    for message in dbc.messages() {
        if number < message.signals.len() {
            return Some((message, number));
        }
        number -= message.signals.len();
    }
    None
}
