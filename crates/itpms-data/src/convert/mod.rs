//! A log from one format into another, as a stream, with names and units kept.
//!
//! Called by `itpms convert`. The content carried over depends on what both formats can hold:
//!
//! | from | to | what |
//! |---|---|---|
//! | CAN log, MDF4 with frames | CAN log | every frame |
//! | CAN log or MDF4 with frames, and DBC | MDF4 | every signal of every message, a channel group each |
//! | MDF4 | MDF4 | every channel that holds numbers |
//! | any | CSV, Parquet, MCAP | the columns of a drive log, in rows |
//! | CSV, Parquet | MDF4 | the same, in one channel group |
//! | CSV, Parquet, MDF4 | CAN log and DBC | the same, in the messages that have signals for them, each with every row |
//!
//! Data that cannot be converted is reported. Knows nothing of estimators.

#[cfg(feature = "can")]
mod frames;
#[cfg(feature = "mdf4")]
mod groups;
mod rows;
#[cfg(all(feature = "can", feature = "mdf4"))]
mod signals;

use std::ops::ControlFlow;
use std::path::Path;

use crate::error::DataError;
use crate::log::{LogFormat, LogOptions};
use crate::out::{AtomicFile, Packing};

#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    pub input: &'a Path,
    pub output: &'a Path,
    /// How to read the log; the DBC file and the map are also for writing a CAN log.
    pub options: &'a LogOptions,
    pub packing: Packing,
    /// Whether rows say where the car was, if the log does.
    pub position: bool,
}

#[derive(Debug)]
pub struct Converted {
    /// Complete but for its name: [`AtomicFile::commit`].
    pub file: AtomicFile,
    /// Its content: `20000 rows`.
    pub content: String,
    /// Repairs of the log, and data that did not get into the file.
    pub warnings: Vec<String>,
    /// Remarks: which signal became which column.
    pub remarks: Vec<String>,
}

/// Asked now and then, with the share that is done, whether to go on.
pub(crate) type Look<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Frames, samples or rows between two looks.
const LOOK: u64 = 4096;

/// Converts a log; `None` when `look` broke it off. Errors: the log cannot be read, the file not written, or an extension is not known.
pub fn convert(request: &Request<'_>, look: Look<'_>) -> Result<Option<Converted>, DataError> {
    match (
        LogFormat::of_log(request.input, request.options.dbc.as_deref())?,
        LogFormat::of_output(request.output)?,
    ) {
        #[cfg(feature = "can")]
        (LogFormat::Can, LogFormat::Can) => frames::convert(request, look),
        #[cfg(all(feature = "can", feature = "mdf4"))]
        (LogFormat::Can, LogFormat::Mdf4) => signals::convert(request, look),
        #[cfg(feature = "mdf4")]
        (LogFormat::Mdf4, LogFormat::Mdf4) => groups::convert(request, look),
        _ => rows::convert(request, look),
    }
}

fn counted(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}
