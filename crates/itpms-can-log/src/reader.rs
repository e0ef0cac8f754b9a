//! Frames from a CAN log of any format. Called by the log reader and the commands; knows nothing of signals.

use std::path::{Path, PathBuf};

use itpms_files::input;

use super::asc::AscReader;
use super::blf::BlfReader;
use super::busmaster::{self, Busmaster};
use super::candump::CandumpReader;
use super::format::LogFormat;
use super::frame::CanFrame;
use super::frame_source::FrameSource;
use super::frame_table::FrameTable;
use super::line_format::LineFormat;
use super::line_reader::LineReader;
use super::lines::{TextLines, beginning};
#[cfg(feature = "mdf4")]
use super::mf4::Mf4Reader;
use super::repairs::FrameRepairs;
use super::trc::Trc;
use crate::error::{CanError, CanProblem};

/// A CAN log, frame by frame. Lines and objects that are not understood are left out and counted; see [`FrameReader::repairs`].
#[derive(Debug)]
pub struct FrameReader {
    path: PathBuf,
    source: Box<dyn FrameSource>,
    repairs: FrameRepairs,
    is_over: bool,
}

impl FrameReader {
    /// Opens a log: `.log` or `.candump` (candump, or BUSMASTER's), `.asc`, `.blf`, `.trc`, a table of frames (`.csv`, of SavvyCAN or python-can), or `.mf4`
    /// with frames.
    ///
    /// # Errors
    /// There is no such file, it cannot be read, its extension is another, a BLF has no header or an MDF4 file no frames.
    pub fn open(path: &Path) -> Result<Self, CanError> {
        let fail = |problem: CanProblem| CanError::new(path, problem);
        let of_file = |problem| CanError::new(path, CanProblem::File(problem));
        let text =
            || input::open(path).map(|(file, about)| TextLines::new(file, about.len())).map_err(of_file);
        let source: Box<dyn FrameSource> = match LogFormat::of(path)? {
            LogFormat::Candump => {
                let mut lines = text()?;
                if lines.beginning().map_err(fail)?.starts_with(busmaster::BEGINNING) {
                    Box::new(LineReader::new(lines, Busmaster::default()))
                } else {
                    Box::new(CandumpReader::new(lines))
                }
            }
            LogFormat::Asc => Box::new(AscReader::new(text()?)),
            LogFormat::Trc => Box::new(LineReader::new(text()?, Trc::default())),
            LogFormat::Csv => {
                let mut lines = text()?;
                let table = frame_table(&mut lines).map_err(fail)?;
                Box::new(LineReader::new(lines, table))
            }
            LogFormat::Blf => {
                let (file, about) = input::open_regular(path, "BLF").map_err(of_file)?;
                Box::new(BlfReader::new(file, about.len()).map_err(fail)?)
            }
            #[cfg(feature = "mdf4")]
            LogFormat::Mf4 => Box::new(Mf4Reader::open(path)?),
        };
        Ok(Self { path: path.to_owned(), source, repairs: FrameRepairs::default(), is_over: false })
    }

    /// The next frame; `None` at the end, and from then on.
    ///
    /// # Errors
    /// The file can no longer be read, or nothing in it is understood. From then on there is nothing more.
    pub fn next_frame(&mut self) -> Result<Option<CanFrame>, CanError> {
        if self.is_over {
            return Ok(None);
        }
        match self.source.next_frame(&mut self.repairs) {
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
                Err(CanError::new(&self.path, problem))
            }
        }
    }

    /// How much of the file has been read, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.source.progress()
    }

    /// The omissions and repairs so far.
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

/// Whether a file of comma-separated values is a table of frames; one that cannot be read is none.
#[must_use]
pub fn is_frame_table(path: &Path) -> bool {
    let lines = input::open_regular(path, "CSV").map(|(file, about)| TextLines::new(file, about.len()));
    lines.is_ok_and(|mut lines| frame_table(&mut lines).is_ok())
}

fn frame_table(lines: &mut TextLines) -> Result<FrameTable, CanProblem> {
    let text = lines.beginning()?;
    let first = text.split(|byte| *byte == b'\n').next().unwrap_or(text);
    FrameTable::of_header(first).ok_or_else(|| {
        let expected = <FrameTable as LineFormat>::EXPECTED;
        CanProblem::NothingUnderstood { lines: 1, line: 1, found: beginning(first), expected }
    })
}
