//! Frames from a CAN log of any format. Called by the log reader and the commands; knows nothing of signals.

use std::path::{Path, PathBuf};

use super::asc::AscReader;
use super::blf::BlfReader;
use super::candump::CandumpReader;
use super::format::LogFormat;
use super::frame::CanFrame;
use super::repairs::FrameRepairs;
use crate::error::DataError;
use crate::input;

/// A CAN log, frame by frame. What is not understood is left out and counted; see [`FrameReader::repairs`].
#[derive(Debug)]
pub struct FrameReader {
    path: PathBuf,
    source: Source,
    repairs: FrameRepairs,
    is_over: bool,
}

#[derive(Debug)]
enum Source {
    Candump(CandumpReader),
    Asc(AscReader),
    Blf(BlfReader),
}

impl FrameReader {
    /// Opens a log: `.log` or `.candump` (candump), `.asc` or `.blf`.
    ///
    /// # Errors
    /// There is no such file, it cannot be read, its extension is another, or a BLF has no header.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        let format = LogFormat::of(path)?;
        let fail = |problem| DataError::new(path, problem);
        let opened = match format {
            LogFormat::Blf => input::open_regular(path, "BLF"),
            LogFormat::Candump | LogFormat::Asc => input::open(path),
        };
        let (file, metadata) = opened.map_err(fail)?;
        let source = match format {
            LogFormat::Candump => Source::Candump(CandumpReader::new(file, metadata.len())),
            LogFormat::Asc => Source::Asc(AscReader::new(file, metadata.len())),
            LogFormat::Blf => Source::Blf(BlfReader::new(file, metadata.len()).map_err(fail)?),
        };
        Ok(Self { path: path.to_owned(), source, repairs: FrameRepairs::default(), is_over: false })
    }

    /// The next frame; `None` at the end, and from then on.
    ///
    /// # Errors
    /// The file can no longer be read, or nothing in it is understood. From then on there is nothing more.
    pub fn next_frame(&mut self) -> Result<Option<CanFrame>, DataError> {
        if self.is_over {
            return Ok(None);
        }
        let next = match &mut self.source {
            Source::Candump(source) => source.next_frame(&mut self.repairs),
            Source::Asc(source) => source.next_frame(&mut self.repairs),
            Source::Blf(source) => source.next_frame(&mut self.repairs),
        };
        match next {
            Ok(Some(frame)) => {
                self.repairs.frames += 1;
                Ok(Some(frame))
            }
            Ok(None) => {
                self.is_over = true;
                Ok(None)
            }
            Err(problem) => {
                self.is_over = true;
                Err(DataError::new(&self.path, problem))
            }
        }
    }

    /// How much of the file has been read, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        match &self.source {
            Source::Candump(source) => source.progress(),
            Source::Asc(source) => source.progress(),
            Source::Blf(source) => source.progress(),
        }
    }

    /// What was left out so far.
    #[must_use]
    pub fn repairs(&self) -> &FrameRepairs {
        &self.repairs
    }

    /// The file's name as it was given.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}
