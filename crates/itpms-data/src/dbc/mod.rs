//! Frames of a bus to the columns of a log and back, by a description of the bus.
//!
//! Called by the reader of bus logs, by the live monitor and by `itpms signals`. The description itself, messages and signals, is
//! [`itpms_can_log::dbc`]; here is which of its signals are columns, and (`truck`) which two make one.

mod decoder;
mod encoder;
mod truck;

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

/// All signals of all messages, as candidates for columns, then what is made of two signals of a message. A signal that a message has in
/// several layouts is one.
pub fn candidates(dbc: &Dbc) -> Vec<Candidate> {
    own_candidates(dbc).chain(truck::compounds(dbc).into_iter().map(|compound| compound.candidate)).collect()
}

/// The same without what is made of two.
fn own_candidates(dbc: &Dbc) -> impl Iterator<Item = Candidate> + '_ {
    let candidate = |(message, place): (&Message, usize)| {
        let signal = &message.signals[place];
        Candidate { group: message.name.clone(), name: signal.name.clone(), unit: signal.unit.clone() }
    };
    own_places(dbc).map(candidate)
}

fn own_places(dbc: &Dbc) -> impl Iterator<Item = (&Message, usize)> {
    dbc.messages().iter().flat_map(|message| message.first_layouts().map(move |place| (message, place)))
}

/// Message and place of the signal in it, in its first layout, of the candidate with this number; of what is made of two the place of
/// the value.
pub fn of_candidate(dbc: &Dbc, number: usize) -> Option<(&Message, usize)> {
    let compound = || {
        let compound = compound_of(dbc, number)?;
        Some((dbc.messages().get(compound.message)?, compound.place))
    };
    own_places(dbc).nth(number).or_else(compound)
}

/// The candidate with this number, if it is made of two signals.
fn compound_of(dbc: &Dbc, number: usize) -> Option<truck::Compound> {
    truck::compounds(dbc).into_iter().nth(number.checked_sub(own_places(dbc).count())?)
}
