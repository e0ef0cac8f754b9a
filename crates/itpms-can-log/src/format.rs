//! Which format a CAN log has: its extension says so. Called by the reader and the writer beside it.

use std::path::Path;

use itpms_files::FileProblem;

use crate::error::CanError;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LogFormat {
    /// Also BUSMASTER's, which has the same extension.
    Candump,
    Asc,
    Trc,
    Csv,
    Blf,
    #[cfg(feature = "mdf4")]
    Mf4,
}

/// The formats that are read, and those that are written.
const READ: &str = ".log or .candump (candump), .asc, .blf, .trc, or .mf4 or .csv with frames";
const WRITTEN: &str = ".log or .candump (candump), .asc or .blf";

impl LogFormat {
    /// The format of a file by its extension, upper or lower case.
    pub(super) fn of(path: &Path) -> Result<Self, CanError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("log" | "candump") => Ok(LogFormat::Candump),
            Some("asc") => Ok(LogFormat::Asc),
            Some("blf") => Ok(LogFormat::Blf),
            Some("trc") => Ok(LogFormat::Trc),
            Some("csv") => Ok(LogFormat::Csv),
            #[cfg(feature = "mdf4")]
            Some("mf4" | "mdf" | "dat") => Ok(LogFormat::Mf4),
            _ => Err(Self::unknown(path, READ)),
        }
    }

    /// The error of a file to be written that has none of their extensions.
    pub(super) fn not_written(path: &Path) -> CanError {
        Self::unknown(path, WRITTEN)
    }

    fn unknown(path: &Path, expected: &str) -> CanError {
        CanError::new(path, FileProblem::unknown_extension(path, expected))
    }
}
