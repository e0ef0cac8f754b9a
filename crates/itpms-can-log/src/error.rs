//! Problems with a CAN log as a whole: where, what was found, what was expected. A problem with a part of
//! it is a repair, see [`FrameRepairs`](super::FrameRepairs).
//!
//! Made by the modules beside it.

use std::path::{Path, PathBuf};

use itpms_files::{FileError, FileProblem, sentence};
use thiserror::Error;

use crate::dbc::problem::DbcError;

/// A CAN log or a DBC file that could not be used, and why.
#[derive(Debug, Error)]
#[error("{}", sentence(path, problem))]
pub struct CanError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: Box<CanProblem>,
}

impl CanError {
    pub(super) fn new(path: &Path, problem: impl Into<CanProblem>) -> Self {
        Self { path: path.to_owned(), problem: Box::new(problem.into()) }
    }
}

impl From<FileError> for CanError {
    fn from(error: FileError) -> Self {
        Self { path: error.path, problem: Box::new(error.problem.into()) }
    }
}

#[cfg(feature = "mdf4")]
impl From<itpms_mdf4::Mdf4Error> for CanError {
    fn from(error: itpms_mdf4::Mdf4Error) -> Self {
        Self { path: error.path, problem: Box::new((*error.problem).into()) }
    }
}

/// One kind of problem with a CAN log.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum CanProblem {
    /// One that a file of any format may have.
    #[error(transparent)]
    File(#[from] FileProblem),
    /// No DBC file that could be used.
    #[error(transparent)]
    Dbc(#[from] DbcError),
    /// No MDF4 file, or a damaged one.
    #[cfg(feature = "mdf4")]
    #[error(transparent)]
    Mdf4(#[from] itpms_mdf4::Mdf4Problem),
    #[error("the file is empty, expected CAN frames ({expected})")]
    Empty { expected: &'static str },
    #[error("none of the first {lines} lines is understood; line {line} is {found:?}, expected {expected}")]
    NothingUnderstood { lines: u64, line: u64, found: String, expected: &'static str },
    #[error(
        "line {line}: the frame has no time stamp ({found:?}); log with candump -L, or with candump -ta on the screen"
    )]
    NoTimeStamp { line: u64, found: String },
    #[error("found {found:?} at the beginning of {bytes} bytes, expected a BLF header that begins with LOGG")]
    NoHeader { found: String, bytes: u64 },
    #[error(
        "nothing in the file is understood; at byte {byte}: found {found}, expected an object that begins with LOBJ"
    )]
    NoObject { byte: u64, found: String },
    #[error("has no frames of a CAN bus, expected a channel group with CAN_DataFrame (ASAM MDF bus logging)")]
    NoFrameGroup,
    #[error("frame {number}: time is {time_s} s, expected 0 s to the end of the year 9999")]
    Time { number: u64, time_s: f64 },
}
