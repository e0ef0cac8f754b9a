//! Which format a file has: its extension says so. Called by the reader and by the table writer.

use std::path::Path;

use crate::error::{DataError, Problem};

/// A format of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet,
}

#[cfg(feature = "parquet")]
const EXPECTED: &str = ".csv or .parquet";
#[cfg(not(feature = "parquet"))]
const EXPECTED: &str = ".csv (this build is without Parquet)";

impl Format {
    /// The format of a file by its extension, upper or lower case.
    pub(crate) fn of(path: &Path) -> Result<Self, DataError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("csv") => Ok(Format::Csv),
            #[cfg(feature = "parquet")]
            Some("parquet" | "pq") => Ok(Format::Parquet),
            other => {
                let found = match other {
                    Some(extension) => format!("unknown file extension .{extension}"),
                    None => "no file extension".to_owned(),
                };
                Err(DataError::new(path, Problem::UnknownExtension { found, expected: EXPECTED }))
            }
        }
    }
}
