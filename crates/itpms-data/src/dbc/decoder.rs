//! Frames to readings: the signals that are columns, in the columns' units.
//!
//! Called for every frame of a log or a bus, so nothing is allocated here once it is made. Knows nothing of what the
//! readings are for.

use std::collections::HashMap;

use super::{Dbc, DbcProblem, Message, candidates, of_candidate};
use crate::can::{CanFrame, CanId, FrameKind};
use crate::error::DataError;
use crate::log::Slot;
use crate::signals::{Conversion, Reading, Resolved, SignalMap, resolve};

/// What became of the frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameCounts {
    /// All that were handed in.
    pub frames: u64,
    /// Data frames of messages with a column's signal.
    pub used: u64,
    /// Data frames of messages that the description has, without such a signal.
    pub other: u64,
    /// Data frames whose identifier the description does not have.
    pub unknown: u64,
    /// Used ones that ended before a column's signal.
    pub short: u64,
    /// Used messages that came on another bus than the first time; not decoded.
    pub other_bus: u64,
    /// Used parameter groups of SAE J1939 that came from another source address than the first time; not decoded.
    pub other_sender: u64,
    /// Remote and error frames.
    pub without_data: u64,
    /// Values sent as not available (`SNA`), handed on as NaN.
    pub not_available: u64,
}

/// Decodes what is wanted of a bus.
#[derive(Debug, Clone)]
pub struct Decoder {
    dbc: Dbc,
    resolved: Resolved,
    wanted: HashMap<CanId, Wanted>,
    counts: FrameCounts,
}

/// Of one message, the signals that are columns.
#[derive(Debug, Clone)]
struct Wanted {
    message: Message,
    /// Place of the signal, what it is, and in which unit.
    signals: Vec<(usize, Slot, Conversion)>,
    /// Where the message was seen first. The same identifier on another bus may be something else, or a gateway's
    /// copy; in either case it is no second sensor. The same goes for a parameter group of SAE J1939 from a second sender, unless the
    /// description names that one.
    first: Option<(u16, CanId)>,
}

impl Decoder {
    /// Decides which signals are columns: those of the map, and those whose names say so.
    ///
    /// # Errors
    /// The map does not fit the description; see [`resolve`].
    pub fn new(dbc: Dbc, map: Option<&SignalMap>) -> Result<Self, DataError> {
        let resolved = resolve(&candidates(&dbc), map)?;
        let mut wanted: HashMap<CanId, Wanted> = HashMap::new();
        for chosen in resolved.iter() {
            if let Some((message, place)) = of_candidate(&dbc, chosen.candidate) {
                let fresh = || Wanted { message: message.clone(), signals: Vec::new(), first: None };
                let entry = wanted.entry(message.id).or_insert_with(fresh);
                entry.signals.push((place, chosen.slot, chosen.conversion));
            }
        }
        Ok(Self { dbc, resolved, wanted, counts: FrameCounts::default() })
    }

    /// The columns that can come, in the order of [`Slot::all`].
    #[must_use]
    pub fn slots(&self) -> Vec<Slot> {
        self.resolved.slots()
    }

    /// Which signal is which column, and what is doubtful about it.
    #[must_use]
    pub fn resolved(&self) -> &Resolved {
        &self.resolved
    }

    /// The description of the bus.
    #[must_use]
    pub fn dbc(&self) -> &Dbc {
        &self.dbc
    }

    /// What is wrong with the description; see [`Dbc::problems`].
    #[must_use]
    pub fn problems(&self) -> &[DbcProblem] {
        self.dbc.problems()
    }

    /// What became of the frames so far.
    #[must_use]
    pub fn counts(&self) -> &FrameCounts {
        &self.counts
    }

    /// Hands every column's value in this frame to `found`, with the frame's time.
    pub fn decode(&mut self, frame: &CanFrame, found: &mut impl FnMut(Reading)) {
        self.counts.frames += 1;
        if matches!(frame.kind, FrameKind::Remote | FrameKind::Error) {
            self.counts.without_data += 1;
            return;
        }
        let id = if self.wanted.contains_key(&frame.id) {
            Some(frame.id)
        } else {
            self.dbc.message(frame.id).map(|message| message.id)
        };
        let Some(wanted) = id.and_then(|id| self.wanted.get_mut(&id)) else {
            *(if id.is_some() { &mut self.counts.other } else { &mut self.counts.unknown }) += 1;
            return;
        };
        let (bus, sender) = wanted.first.get_or_insert((frame.bus, frame.id));
        if *bus != frame.bus {
            self.counts.other_bus += 1;
            return;
        }
        if *sender != frame.id {
            if wanted.message.id != frame.id {
                self.counts.other_sender += 1;
                return;
            }
            *sender = frame.id;
        }
        self.counts.used += 1;
        let data = frame.data();
        let mut short = false;
        for &(place, slot, conversion) in &wanted.signals {
            let Some(signal) = wanted.message.signals.get(place) else { continue };
            let Some(raw) = wanted.message.raw(place, data) else {
                short |= signal.raw(data).is_none();
                continue;
            };
            let value = if signal.is_not_available(raw) {
                self.counts.not_available += 1;
                f64::NAN
            } else {
                conversion.apply(signal.physical(raw))
            };
            found(Reading { time_s: frame.time_s, slot, value });
        }
        self.counts.short += u64::from(short);
    }
}
