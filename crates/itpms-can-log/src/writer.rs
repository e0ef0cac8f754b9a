//! Frames into a CAN log of any format. Called by the commands; knows nothing of signals.

use std::path::Path;

use itpms_files::AtomicFile;

use super::asc::AscWriter;
use super::blf::BlfWriter;
use super::candump;
use super::format::LogFormat;
use super::frame::CanFrame;
use crate::error::{CanError, CanProblem};

/// The end of the year 9999, in s since 1970: the formats write years of four digits.
pub(super) const MOST_TIME_S: f64 = 253_402_300_799.0;

/// A CAN log in the making. Frames are written in the order they come.
#[derive(Debug)]
pub struct FrameWriter {
    file: AtomicFile,
    sink: Sink,
    frames: u64,
}

#[derive(Debug)]
enum Sink {
    /// The line in the making.
    Candump(String),
    Asc(AscWriter),
    Blf(BlfWriter),
}

impl FrameWriter {
    /// Starts a log: `.log` or `.candump` (candump), `.asc` or `.blf`.
    ///
    /// # Errors
    /// The extension is another, or the file cannot be made.
    pub fn create(path: &Path) -> Result<Self, CanError> {
        let sink = match LogFormat::of(path)? {
            LogFormat::Candump => Sink::Candump(String::new()),
            LogFormat::Asc => Sink::Asc(AscWriter::default()),
            LogFormat::Blf => Sink::Blf(BlfWriter::default()),
            // Read, but not written so.
            _ => return Err(LogFormat::not_written(path)),
        };
        let file = AtomicFile::create(path)?;
        Ok(Self { file, sink, frames: 0 })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// Its time is negative, beyond the year 9999 or NaN; or the disk is full.
    pub fn write(&mut self, frame: &CanFrame) -> Result<(), CanError> {
        self.frames += 1;
        if !(0.0..=MOST_TIME_S).contains(&frame.time_s) {
            let problem = CanProblem::Time { number: self.frames, time_s: frame.time_s };
            return Err(CanError::new(self.file.target(), problem));
        }
        let written = match &mut self.sink {
            Sink::Candump(line) => {
                line.clear();
                candump::push_line(line, frame, &format!("can{}", frame.bus));
                line.push('\n');
                self.file.append(line.as_bytes())
            }
            Sink::Asc(sink) => sink.write(&mut self.file, frame),
            Sink::Blf(sink) => sink.write(&mut self.file, frame),
        };
        Ok(written?)
    }

    /// Frames written so far.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Ends the log; it appears under its name with [`AtomicFile::commit`].
    ///
    /// # Errors
    /// The disk is full.
    pub fn finish(mut self) -> Result<AtomicFile, CanError> {
        match &mut self.sink {
            Sink::Candump(_) => {}
            Sink::Asc(sink) => sink.finish(&mut self.file)?,
            Sink::Blf(sink) => sink.finish(&mut self.file)?,
        }
        self.file.settle()?;
        Ok(self.file)
    }
}
