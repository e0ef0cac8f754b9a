//! Problems of a file, stated once: the file, the line or column, what was found, what was expected.
//!
//! Every public function of this crate returns [`DataError`]. Its message is complete; callers print it as it is.

mod from_formats;
mod hints;
mod problem;

use std::io;
use std::path::{Path, PathBuf};

use itpms_files::sentence;
pub use itpms_files::{FileError, FileProblem, Place};
use thiserror::Error;

pub(crate) use self::hints::{coarse_clock, likely_unit, not_among, separated_by, twice};
pub use self::problem::Problem;

/// A file that could not be used, and why.
#[derive(Debug, Error)]
#[error("{}", message(path, problem))]
pub struct DataError {
    pub path: PathBuf,
    pub problem: Box<Problem>,
}

/// A line that is to be copied is not shortened.
fn message(path: &Path, problem: &Problem) -> String {
    match problem {
        Problem::Elsewhere(_) => format!("{}: {problem}", path.display()),
        _ => sentence(path, problem),
    }
}

impl DataError {
    pub(crate) fn new(path: &Path, problem: impl Into<Problem>) -> Self {
        Self { path: path.to_owned(), problem: Box::new(problem.into()) }
    }

    /// Whether nothing can be written where this could not be: the disk is full, or takes nothing.
    pub fn is_of_a_full_disk(&self) -> bool {
        use io::ErrorKind::{FileTooLarge, QuotaExceeded, ReadOnlyFilesystem, StorageFull};
        let full = |kind| matches!(kind, StorageFull | QuotaExceeded | ReadOnlyFilesystem | FileTooLarge);
        matches!(&*self.problem, Problem::File(FileProblem::Write(error)) if full(error.kind()))
    }
}

impl From<FileError> for DataError {
    fn from(error: FileError) -> Self {
        Self { path: error.path, problem: Box::new(error.problem.into()) }
    }
}

impl From<DataError> for Problem {
    fn from(error: DataError) -> Self {
        *error.problem
    }
}

#[cfg(feature = "mdf4")]
impl From<crate::mdf4::Mdf4Error> for DataError {
    fn from(error: crate::mdf4::Mdf4Error) -> Self {
        Self { path: error.path, problem: Box::new((*error.problem).into()) }
    }
}

#[cfg(feature = "can")]
impl From<crate::can::CanError> for DataError {
    fn from(error: crate::can::CanError) -> Self {
        Self { path: error.path, problem: Box::new((*error.problem).into()) }
    }
}

impl From<crate::crg::CrgError> for DataError {
    fn from(error: crate::crg::CrgError) -> Self {
        Self { path: error.path, problem: Box::new((*error.problem).into()) }
    }
}
