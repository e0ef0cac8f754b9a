//! Which format a file has: its extension says so. Called by the reader and by the table writer.

use std::path::Path;

use itpms_files::input;

use super::elsewhere;
use crate::error::{DataError, FileProblem, Problem};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet,
}

#[cfg(feature = "parquet")]
const TABLES: &str = ".csv or .parquet";
#[cfg(not(feature = "parquet"))]
const TABLES: &str = ".csv (this build is without Parquet)";

impl Format {
    /// The format of a table by its extension, upper or lower case.
    pub(crate) fn of(path: &Path) -> Result<Self, DataError> {
        let extension = extension(path);
        Self::of_extension(extension.as_deref())
            .ok_or_else(|| unknown(path, extension.as_deref(), TABLES.to_owned()))
    }

    fn of_extension(extension: Option<&str>) -> Option<Self> {
        match extension {
            Some("csv") => Some(Format::Csv),
            #[cfg(feature = "parquet")]
            Some("parquet" | "pq" | "parq") => Some(Format::Parquet),
            _ => None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LogFormat {
    Table(Format),
    #[cfg(feature = "mdf4")]
    Mdf4,
    #[cfg(feature = "can")]
    Can,
    #[cfg(feature = "mcap")]
    Mcap,
}

impl LogFormat {
    /// The format of a log that is written, by the extension; a device or pipe without one receives a table.
    pub(crate) fn of_output(path: &Path) -> Result<Self, DataError> {
        let extension = extension(path);
        match extension.as_deref() {
            None => Ok(LogFormat::Table(Format::Csv)),
            // Read, but not written so.
            Some("gz" | "tsv" | "txt" | "vbo") => Err(unknown(path, extension.as_deref(), expected_log())),
            // A message about files that cannot be read does not fit one that is to be written.
            Some(_) => LogFormat::of(path).map_err(|_| unknown(path, extension.as_deref(), expected_log())),
        }
    }

    /// The format of a drive log by its extension, upper or lower case, or because it is a folder of part files.
    pub(crate) fn of(path: &Path) -> Result<Self, DataError> {
        #[cfg(feature = "parquet")]
        if crate::parquet_columns::is_folder_of_parts(path) {
            return Ok(LogFormat::Table(Format::Parquet));
        }
        if input::is_stdin(path) {
            return Ok(LogFormat::Table(Format::Csv));
        }
        let extension = extension(path);
        match extension.as_deref() {
            Some("tsv" | "txt" | "vbo") => Ok(LogFormat::Table(Format::Csv)),
            // Packed: what it is called without that.
            Some("gz") if is_packed_text(path) => Ok(LogFormat::Table(Format::Csv)),
            #[cfg(feature = "mdf4")]
            Some("mf4" | "mdf" | "dat") => Ok(LogFormat::Mdf4),
            #[cfg(feature = "mcap")]
            Some("mcap") => Ok(LogFormat::Mcap),
            #[cfg(feature = "can")]
            Some("log" | "candump" | "asc" | "blf" | "trc") => Ok(LogFormat::Can),
            other => Format::of_extension(other).map(LogFormat::Table).ok_or_else(|| {
                let way_out = other.and_then(|extension| elsewhere::of_log(path, extension));
                way_out.map_or_else(
                    || unknown(path, other, expected_log()),
                    |way_out| DataError::new(path, Problem::Elsewhere(way_out)),
                )
            }),
        }
    }
}

impl LogFormat {
    /// The same by what is inside as well: a table may be one of frames, and an MDF4 file with frames of a bus is a CAN log where it has no other signals,
    /// or where its frames' description is given.
    pub(crate) fn of_log(path: &Path, dbc: Option<&Path>) -> Result<Self, DataError> {
        let format = Self::of(path)?;
        #[cfg(all(feature = "can", feature = "mdf4"))]
        if format == LogFormat::Mdf4 && crate::mdf4_contents::is_bus_log(path, dbc.is_some())? {
            return Ok(LogFormat::Can);
        }
        #[cfg(feature = "can")]
        if format == LogFormat::Table(Format::Csv)
            && !input::is_stdin(path)
            && crate::can::is_frame_table(path)
        {
            return Ok(LogFormat::Can);
        }
        let _ = dbc;
        Ok(format)
    }

    /// The problem of an empty file.
    pub(crate) fn without_bytes(self) -> Problem {
        match self {
            LogFormat::Table(Format::Csv) => Problem::Empty,
            #[cfg(feature = "parquet")]
            LogFormat::Table(Format::Parquet) => {
                "the file is empty, expected a Parquet file with time_s and the accelerations of a corner"
                    .into()
            }
            #[cfg(feature = "mdf4")]
            LogFormat::Mdf4 => "the file is empty, expected an MDF4 file".into(),
            #[cfg(feature = "can")]
            LogFormat::Can => "the file is empty, expected CAN frames".into(),
            #[cfg(feature = "mcap")]
            LogFormat::Mcap => "the file is empty, expected an MCAP file".into(),
        }
    }
}

/// The extensions of drive logs that this build reads.
fn expected_log() -> String {
    let mut known = vec![".csv"];
    if cfg!(feature = "parquet") {
        known.push(".parquet");
    }
    if cfg!(feature = "mdf4") {
        known.push(".mf4");
    }
    if cfg!(feature = "mcap") {
        known.push(".mcap");
    }
    if cfg!(feature = "can") {
        known.extend([".log", ".candump", ".asc", ".blf", ".trc"]);
    }
    known.join(", ")
}

fn extension(path: &Path) -> Option<String> {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase())
}

/// `drive.csv.gz` and the like.
fn is_packed_text(path: &Path) -> bool {
    let inner = path.file_stem().map(Path::new).and_then(extension);
    matches!(inner.as_deref(), Some("csv" | "tsv" | "txt"))
}

fn unknown(path: &Path, extension: Option<&str>, expected: String) -> DataError {
    let found = match extension {
        Some(extension) => format!("unknown file extension .{extension}"),
        None => "no file extension".to_owned(),
    };
    DataError::new(path, FileProblem::UnknownExtension { found, expected })
}
