//! Rows of a drive log to the frames that a bus would have carried.
//!
//! Called by the writer of drive logs; the counterpart of the [`Decoder`](super::Decoder), with the same map. All
//! frames of a row have its time, and every message goes with every row: the description's cycle times are not imitated,
//! for a slower cycle would throw measurements away.

use super::{Dbc, Message, of_candidate, own_candidates};
use crate::can::{CanFrame, Direction, FrameKind};
use crate::error::DataError;
use crate::log::{LogColumns, LogRow, Slot};
use crate::signals::{Conversion, SignalMap, resolve};

/// Count of the rows written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EncodeCounts {
    pub frames: u64,
    /// Frames not made because a value was missing and the description has no code for that.
    pub without_value: u64,
    /// Values beyond what their signal can say, which were sent as its nearest.
    pub saturated: u64,
    pub first_saturated: Option<String>,
}

#[derive(Debug, Clone)]
pub struct Encoder {
    outgoing: Vec<Outgoing>,
    left_out: Vec<Slot>,
    counts: EncodeCounts,
}

#[derive(Debug, Clone)]
struct Outgoing {
    message: Message,
    /// For each signal of the message the column it is, and from the signal's value to the column's.
    columns: Vec<Option<(Slot, Conversion)>>,
}

impl Encoder {
    /// Decides which signals carry these columns, as a decoder would find them.
    /// Errors: the map does not fit the description; see [`resolve`].
    pub fn new(dbc: &Dbc, map: Option<&SignalMap>, columns: &LogColumns) -> Result<Self, DataError> {
        let resolved = resolve(&own_candidates(dbc).collect::<Vec<_>>(), map)?;
        let mut outgoing: Vec<Outgoing> = Vec::new();
        let mut left_out = Vec::new();
        for slot in columns.slots().filter(|slot| *slot != Slot::Time) {
            let chosen = resolved.get(slot);
            let place = chosen.and_then(|chosen| of_candidate(dbc, chosen.candidate));
            let (Some(chosen), Some((message, place))) = (chosen, place) else {
                left_out.push(slot);
                continue;
            };
            let at = outgoing.iter().position(|other| other.message.id == message.id).unwrap_or_else(|| {
                let columns = vec![None; message.signals.len()];
                outgoing.push(Outgoing { message: message.clone(), columns });
                outgoing.len() - 1
            });
            for place in message.layouts_of(place) {
                outgoing[at].columns[place] = Some((slot, chosen.conversion));
            }
        }
        Ok(Self { outgoing, left_out, counts: EncodeCounts::default() })
    }

    /// Columns for which the description has no signal.
    pub fn left_out(&self) -> &[Slot] {
        &self.left_out
    }

    /// Whether a corner's two accelerations, or anything at all, can be sent.
    pub fn is_empty(&self) -> bool {
        self.outgoing.is_empty()
    }

    /// Signals that share a message with a column without being one, as `message.signal`: they are sent as zero.
    pub fn zeros(&self) -> Vec<String> {
        let mut zeros = Vec::new();
        for Outgoing { message, columns } in &self.outgoing {
            let signals = message.signals.iter().zip(columns).filter(|(_, column)| column.is_none());
            zeros.extend(signals.map(|(signal, _)| format!("{}.{}", message.name, signal.name)));
        }
        zeros
    }

    /// Count of the rows so far.
    pub fn counts(&self) -> &EncodeCounts {
        &self.counts
    }

    /// The frames of a row, in the description's order of columns.
    pub fn encode(&mut self, row: &LogRow, mut send: impl FnMut(CanFrame)) {
        for outgoing in &self.outgoing {
            let Ok(payload) = outgoing.message.encode(|place| outgoing.physical(place, row)) else {
                self.counts.without_value += 1;
                continue;
            };
            if let Some(signal) = outgoing.saturated(row, payload.as_slice()) {
                self.counts.saturated += 1;
                self.counts.first_saturated.get_or_insert(signal);
            }
            self.counts.frames += 1;
            let message = &outgoing.message;
            let kind = if message.fd {
                FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false }
            } else {
                FrameKind::Data
            };
            send(CanFrame {
                time_s: row.time_s,
                bus: 0,
                id: message.id,
                kind,
                direction: Direction::Rx,
                payload,
            });
        }
    }
}

impl Outgoing {
    /// The value of a signal: its column's in its own unit; zero without a column.
    fn physical(&self, place: usize, row: &LogRow) -> f64 {
        match self.columns.get(place) {
            Some(Some((slot, conversion))) => (row.value(*slot) - conversion.offset) / conversion.factor,
            _ => 0.0,
        }
    }

    /// The first signal whose value in the frame is another than the row's, by more than rounding.
    fn saturated(&self, row: &LogRow, data: &[u8]) -> Option<String> {
        let mut found = None;
        self.message.decode(data, |place, sent| {
            let Some(Some(_)) = self.columns.get(place) else { return };
            let (Some(signal), meant) = (self.message.signals.get(place), self.physical(place, row)) else {
                return;
            };
            if (sent - meant).abs() > 0.51 * signal.factor.abs() && found.is_none() {
                found = Some(format!("{}.{}", self.message.name, signal.name));
            }
        });
        found
    }
}
