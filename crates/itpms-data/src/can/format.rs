//! Which format a CAN log has: its extension says so. Called by the reader and the writer beside it.

use std::path::Path;

use crate::error::{DataError, Problem};

/// A format of CAN logs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LogFormat {
    Candump,
    Asc,
    Blf,
}

const EXPECTED: &str = ".log or .candump (candump), .asc or .blf";

impl LogFormat {
    /// The format of a file by its extension, upper or lower case.
    pub(super) fn of(path: &Path) -> Result<Self, DataError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("log" | "candump") => Ok(LogFormat::Candump),
            Some("asc") => Ok(LogFormat::Asc),
            Some("blf") => Ok(LogFormat::Blf),
            other => {
                let found = match other {
                    Some(extension) => format!("unknown file extension .{extension}"),
                    None => "no file extension".to_owned(),
                };
                Err(DataError::new(path, Problem::UnknownExtension { found, expected: EXPECTED.to_owned() }))
            }
        }
    }
}
