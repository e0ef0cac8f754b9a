//! Readings from a CAN log and the description of its frames.

use std::path::Path;

use crate::can::FrameReader;
use crate::dbc::{Dbc, Decoder};
use crate::error::DataError;
use crate::signals::{Reading, Resolved, SignalMap};

#[derive(Debug)]
pub(super) struct CanFeed {
    frames: FrameReader,
    decoder: Decoder,
}

impl CanFeed {
    /// Opens a log and a DBC file; also what its signals were taken for.
    pub(super) fn open(
        path: &Path,
        dbc: &Path,
        map: Option<&SignalMap>,
    ) -> Result<(Self, Resolved), DataError> {
        let frames = FrameReader::open(path)?;
        let decoder = Decoder::new(Dbc::read(dbc)?, map)?;
        let resolved = decoder.resolved().clone();
        Ok((Self { frames, decoder }, resolved))
    }

    pub(super) fn step(&mut self, mut take: impl FnMut(Reading)) -> Result<bool, DataError> {
        let Some(frame) = self.frames.next_frame()? else { return Ok(false) };
        self.decoder.decode(&frame, &mut take);
        Ok(true)
    }

    pub(super) fn progress(&self) -> f64 {
        self.frames.progress()
    }

    pub(super) fn repairs(&self) -> Vec<String> {
        let mut out = self.frames.repairs().warnings();
        let problems = self.decoder.problems();
        if let Some(first) = problems.first() {
            let many = if problems.len() == 1 { "problem" } else { "problems" };
            out.push(format!("the DBC file has {} {many}, the first: {first}", problems.len()));
        }
        let counts = self.decoder.counts();
        for (count, what) in [
            (counts.short, "frames end before a signal that is wanted"),
            (
                counts.other_bus,
                "frames of wanted messages came on another bus than the first and were left out",
            ),
            (
                counts.other_sender,
                "frames of wanted J1939 messages came from another source address than the first and were left out",
            ),
            (counts.not_available, "values were sent as not available"),
        ] {
            if count > 0 {
                out.push(format!("{count} {what}"));
            }
        }
        out
    }
}
