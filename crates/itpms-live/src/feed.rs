//! Frames to rows: what they mean from a DBC, and rows from signals with clocks of their own.
//!
//! Owned by the estimating thread. Remembers when the frames came, so that a row knows how long it took to be made.

use std::collections::VecDeque;
use std::time::Instant;

use itpms_data::LogRow;
use itpms_data::can::{CanFrame, CanId};
use itpms_data::dbc::Decoder;
use itpms_data::signals::Aligner;

/// Frames whose arrival is remembered: more than the aligner keeps waiting.
const REMEMBERED: usize = 1 << 17;
/// A frame that is so much later than a row, in s, is not of it: its stamp is broken, or the clock was set back since.
const NOT_OF_IT_S: f64 = 10.0;

/// A row and when its first frame came; `None` if it waited for the rates to be measured, which says nothing of later ones.
pub(crate) type FedRow = (LogRow, Option<Instant>);

pub struct Feed {
    decoder: Decoder,
    aligner: Aligner,
    /// Frames of ours that come back from the bus we send on.
    own: Vec<CanId>,
    came: VecDeque<(f64, Instant)>,
    running_since: Option<Instant>,
}

impl Feed {
    /// A feed that has seen no frame. `own` are the identifiers that this program sends on the same bus.
    pub fn new(decoder: Decoder, own: Vec<CanId>) -> Self {
        let aligner = Aligner::new(&decoder.slots());
        Self { decoder, aligner, own, came: VecDeque::new(), running_since: None }
    }

    /// Whether the signals are enough: both accelerations of a corner, or the speeds of four wheels.
    pub fn is_enough(&self) -> bool {
        self.aligner.columns().are_enough()
    }

    /// Doubts about the signals.
    pub fn doubts(&self) -> Vec<String> {
        self.decoder.resolved().assumptions()
    }

    /// Frames with a signal that is wanted.
    pub fn used(&self) -> u64 {
        self.decoder.counts().used
    }

    /// Data frames whose identifier the DBC does not have.
    pub fn unknown_ids(&self) -> u64 {
        self.decoder.counts().unknown
    }

    pub(crate) fn push(&mut self, frame: &CanFrame, arrived: Instant) {
        if self.own.contains(&frame.id) {
            return;
        }
        let Self { decoder, aligner, .. } = self;
        let mut wanted = false;
        decoder.decode(frame, &mut |reading| {
            wanted = true;
            aligner.push(reading);
        });
        if wanted {
            if self.came.len() == REMEMBERED {
                self.came.pop_front();
            }
            self.came.push_back((frame.time_s, arrived));
        }
    }

    /// The next row that waits for nothing.
    pub(crate) fn pop(&mut self) -> Option<FedRow> {
        let row = self.aligner.pop()?;
        let own = row.time_s..=row.time_s + NOT_OF_IT_S;
        while self.came.front().is_some_and(|(time_s, _)| !own.contains(time_s)) {
            self.came.pop_front();
        }
        let running_since = *self.running_since.get_or_insert_with(Instant::now);
        let arrived = self.came.front().map(|(_, arrived)| *arrived);
        Some((row, arrived.filter(|arrived| *arrived >= running_since)))
    }

    /// Nothing comes for now: what waits comes out.
    pub(crate) fn flush(&mut self) {
        self.aligner.flush();
    }

    /// There is nothing more: what waits comes out.
    pub(crate) fn finish(&mut self) {
        self.aligner.finish();
    }
}
