//! Readings from a CAN log and the description of its frames.

use std::path::Path;

use super::stamps::{Fate, Strays};
use crate::can::FrameReader;
use crate::dbc::Decoder;
use crate::error::DataError;
use crate::signals::{Reading, Resolved, SignalMap};

#[derive(Debug)]
pub(super) struct CanFeed {
    frames: FrameReader,
    decoder: Decoder,
    /// Each bus has its own clock.
    buses: Vec<(u16, Strays<Reading>)>,
}

impl CanFeed {
    /// Opens a log and a DBC file, else the one attached to the log; also what its signals were taken for.
    pub(super) fn open(
        path: &Path,
        dbc: Option<&Path>,
        map: Option<&SignalMap>,
    ) -> Result<(Self, Resolved), DataError> {
        let frames = FrameReader::open(path)?;
        let decoder = Decoder::new(super::bus::frame_description(path, dbc)?, map)?;
        let resolved = decoder.resolved().clone();
        Ok((Self { frames, decoder, buses: Vec::new() }, resolved))
    }

    pub(super) fn step(&mut self, mut take: impl FnMut(Fate<Reading>)) -> Result<bool, DataError> {
        let Some(frame) = self.frames.next_frame()? else {
            self.buses.iter_mut().for_each(|(_, strays)| strays.finish(&mut take));
            return Ok(false);
        };
        let place = self.buses.iter().position(|(bus, _)| *bus == frame.bus).unwrap_or(self.buses.len());
        if place == self.buses.len() {
            self.buses.push((frame.bus, Strays::new()));
        }
        let strays = &mut self.buses[place].1;
        self.decoder.decode(&frame, &mut |reading| {
            if reading.time_s.is_finite() {
                strays.take(reading, &mut take);
            } else {
                take(Fate::Stray(reading));
            }
        });
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
        if counts.used == 0 && counts.unknown > 0 {
            out.push(format!(
                "{} of {} frames have identifiers that the DBC file does not know, and none carries a signal that is wanted",
                counts.unknown, counts.frames
            ));
        }
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
