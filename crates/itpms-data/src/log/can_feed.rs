//! Readings from a CAN log and the description of its frames.

use std::path::Path;

use super::echoes::Echoes;
use super::feed::Feed;
use super::first_frames::Frames;
use super::stamps::{Fate, Strays};
use crate::dbc::{Dbc, Decoder, candidates};
use crate::error::{DataError, Problem};
use crate::signals::{Reading, Resolved, SignalMap, contested};

#[derive(Debug)]
pub(super) struct CanFeed {
    frames: Frames,
    decoder: Decoder,
    echoes: Echoes,
    buses: Vec<(u16, Strays<Reading>)>,
}

/// Decoder of a log's frames: of several signals for one column, that which has samples.
/// Errors: the log cannot be read, or the map does not fit the description.
pub fn frame_decoder(path: &Path, dbc: Dbc, map: Option<&SignalMap>) -> Result<Decoder, DataError> {
    // A pipe can be read only once.
    if path.is_file() { decoder(&Frames::open(path)?, path, dbc, map) } else { Decoder::new(dbc, map) }
}

fn decoder(frames: &Frames, path: &Path, dbc: Dbc, map: Option<&SignalMap>) -> Result<Decoder, DataError> {
    let has_samples = frames.have_samples(path, &dbc, &contested(&candidates(&dbc), map))?;
    Decoder::knowing(dbc, map, &has_samples)
}

impl CanFeed {
    /// Opens a log and a DBC file, else the one attached to the log; also what its signals were taken for.
    pub(super) fn open(
        path: &Path,
        dbc: Option<&Path>,
        map: Option<&SignalMap>,
    ) -> Result<(Self, Resolved), DataError> {
        let frames = Frames::open(path)?;
        let dbc = super::bus::frame_description(path, dbc)?;
        let decoder = decoder(&frames, path, dbc, map)?;
        let resolved = decoder.resolved().clone();
        let echoes = Echoes::of(frames.first.iter());
        Ok((Self { frames, decoder, echoes, buses: Vec::new() }, resolved))
    }
}

impl Feed for CanFeed {
    fn step(&mut self, mut take: &mut dyn FnMut(Fate<Reading>)) -> Result<bool, Problem> {
        let Some(frame) = self.frames.next()? else {
            self.buses.iter_mut().for_each(|(_, strays)| strays.finish(&mut take));
            return Ok(false);
        };
        if self.echoes.takes(&frame) {
            return Ok(true);
        }
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

    fn progress(&self) -> f64 {
        self.frames.reader.progress()
    }

    fn repairs(&self) -> Vec<String> {
        let mut out = self.frames.reader.repairs().warnings();
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
            (
                counts.further_wheel,
                "frames have wheels or tires of a third axle, or two tires on a side, which are not read: expected two axles with a tire on each side (SAE J1939 locations 0x00, 0x01, 0x10, 0x11)",
            ),
            (counts.not_available, "values were sent as not available"),
            (
                self.echoes.count,
                "frames repeat the one before of their identifier within a quarter of its cycle (as sent and received again) and were left out",
            ),
        ] {
            if count > 0 {
                out.push(format!("{count} {what}"));
            }
        }
        out.extend(self.decoder.raw_ends());
        out
    }
}
