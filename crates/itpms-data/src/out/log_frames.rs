//! The rows of a drive as a CAN log. Called by the writer of drive logs.

use std::path::Path;

use itpms_files::AtomicFile;

use crate::can::FrameWriter;
use crate::dbc::Encoder;
use crate::error::DataError;
use crate::log::{LogColumns, LogOptions, LogRow};

#[derive(Debug)]
pub(super) struct LogFrames {
    encoder: Encoder,
    writer: FrameWriter,
}

impl LogFrames {
    pub(super) fn create(path: &Path, columns: &LogColumns, options: &LogOptions) -> Result<Self, DataError> {
        let Some(dbc) = &options.dbc else {
            let what =
                "is to be a CAN log, whose frames need a description; expected a DBC file (--dbc car.dbc)";
            return Err(DataError::new(path, what));
        };
        let encoder = Encoder::new(&crate::dbc::described(dbc)?, options.map()?.as_ref(), columns)?;
        if encoder.is_empty() {
            let what = "has no signal for any column of the drive; name them in a map (--signals map.toml)";
            return Err(DataError::new(dbc, what));
        }
        Ok(Self { encoder, writer: FrameWriter::create(path)? })
    }

    pub(super) fn write(&mut self, row: &LogRow) -> Result<(), DataError> {
        let mut result = Ok(());
        let writer = &mut self.writer;
        self.encoder.encode(row, |frame| {
            if result.is_ok() {
                result = writer.write(&frame);
            }
        });
        Ok(result?)
    }

    pub(super) fn losses(&self) -> Vec<String> {
        let left_out = self.encoder.left_out().iter();
        let mut out: Vec<String> = left_out
            .map(|slot| format!("{} has no signal in the DBC file and was left out", slot.name()))
            .collect();
        out.extend(sent_as_zero(&self.encoder.zeros()));
        let counts = self.encoder.counts();
        if counts.without_value > 0 {
            out.push(format!(
                "{} frames were left out because a value of theirs is missing",
                counts.without_value
            ));
        }
        if let Some(signal) = &counts.first_saturated {
            out.push(format!(
                "{} frames hold a value at the end of its signal's range instead of one beyond it, the first {signal}",
                counts.saturated
            ));
        }
        out
    }

    pub(super) fn finish(self) -> Result<AtomicFile, DataError> {
        Ok(self.writer.finish()?)
    }
}

/// A reader with another map would take these zeros for measurements.
fn sent_as_zero(signals: &[String]) -> Option<String> {
    let (first, rest) = signals.split_first()?;
    let others = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
    Some(format!("{first}{others} in the frames' messages are no column of the drive and were sent as 0"))
}
