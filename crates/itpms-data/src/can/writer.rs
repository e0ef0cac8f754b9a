//! Frames into a CAN log of any format. Called by the commands; knows nothing of signals.

use std::path::Path;

use super::candump;
use super::error::CanProblem;
use super::format::LogFormat;
use super::frame::CanFrame;
use crate::error::DataError;
use crate::out::AtomicFile;

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
}

impl FrameWriter {
    /// Starts a log: `.log` or `.candump`.
    ///
    /// # Errors
    /// The extension is another, or the file cannot be made.
    pub fn create(path: &Path) -> Result<Self, DataError> {
        let format = LogFormat::of(path)?;
        let file = AtomicFile::create(path)?;
        let sink = match format {
            LogFormat::Candump => Sink::Candump(String::new()),
        };
        Ok(Self { file, sink, frames: 0 })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// Its time is negative, infinite or NaN; or the disk is full.
    pub fn write(&mut self, frame: &CanFrame) -> Result<(), DataError> {
        self.frames += 1;
        if !(frame.time_s >= 0.0 && frame.time_s.is_finite()) {
            let problem = CanProblem::Time { number: self.frames, time_s: frame.time_s };
            return Err(DataError::new(self.file.target(), problem.into()));
        }
        match &mut self.sink {
            Sink::Candump(line) => {
                line.clear();
                candump::push_line(line, frame, &format!("can{}", frame.bus));
                line.push('\n');
                self.file.append(line.as_bytes())
            }
        }
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
    pub fn finish(mut self) -> Result<AtomicFile, DataError> {
        self.file.settle()?;
        Ok(self.file)
    }
}
