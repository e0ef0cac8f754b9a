//! The kinds of problems with a file, and their words.

use itpms_files::{FileProblem, Place};
use thiserror::Error;

use super::hints::{hint, one_by_one, other_unit};
use crate::reference::problem::ReferenceProblem;

#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    #[error(transparent)]
    File(#[from] FileProblem),

    /// What no program acts on: found and expected, in a sentence that stands where it is found.
    #[error("{0}")]
    Refused(String),
    #[error("{0}")]
    Elsewhere(String),

    // --- drive logs: the table ---
    #[error("the file is empty, expected a header line with time_s and the accelerations of a corner")]
    Empty,
    #[error("there is a header but no row under it")]
    HeaderOnly,
    #[error("not a readable Parquet file: {0}")]
    Parquet(String),
    #[error("{part}: {problem}")]
    InPart { part: String, problem: Box<Problem> },
    #[error("column {column} is missing{}", hint(.nearest))]
    MissingColumn { column: String, nearest: Option<String> },
    #[error("column {column} holds {found}, expected numbers{}", one_by_one(.found))]
    ColumnType { column: String, found: String },
    #[error(
        "{place}, column {column}: found {found:?}, expected a number, or NaN or nothing where it is missing{hint}"
    )]
    NotANumber { place: Place, column: String, found: String, hint: &'static str },
    #[error("{place}: found {found} cells, expected {expected} as in the header")]
    CellCount { place: Place, found: usize, expected: usize },

    // --- drive logs: the contents ---
    #[error("found {0} sample with a time, expected at least 2")]
    TooFewSamples(u64),
    #[error(
        "time stands still in {repeated} of the {rows} rows read (first at {place}), expected it to increase from row to row"
    )]
    TimeRepeats { repeated: u64, rows: u64, place: Place },
    #[error(
        "from {from_s} to {to_s} s rows differ from their neighbors {ratio:.0} times as much as from those before: two recordings in turns, or more, expected \
         one ({way_out})"
    )]
    TwoRecordings { ratio: f64, from_s: f64, to_s: f64, way_out: String },
    #[error(
        "the sample period is {} s ({rate_hz:.3} Hz), expected 100 Hz to 2 kHz (wheel speeds alone: 10 Hz at least) with time_s in seconds{}",
        (*.period_s * 1e6).round() / 1e6,
        other_unit(clock, *.period_s)
    )]
    SamplePeriod { clock: String, period_s: f64, rate_hz: f64 },

    #[error("wrong units suspected {0}")]
    Units(String),

    #[error(
        "looks like a drive log (accelerations over time), expected a road profile with distance_m and heights"
    )]
    DriveLog,
    /// An OpenCRG file that cannot be used.
    #[error(transparent)]
    Crg(crate::crg::CrgProblem),

    /// A CAN log or a description of a bus that cannot be used.
    #[cfg(feature = "can")]
    #[error(transparent)]
    Can(crate::can::CanProblem),

    /// Not MDF4, or damaged beyond reading.
    #[cfg(feature = "mdf4")]
    #[error(transparent)]
    Mdf4(crate::mdf4::Mdf4Problem),

    /// Not a reference, not a whole one, or another car's.
    #[error(transparent)]
    Reference(#[from] ReferenceProblem),
}

impl From<String> for Problem {
    fn from(sentence: String) -> Self {
        Self::Refused(sentence)
    }
}

impl From<&str> for Problem {
    fn from(sentence: &str) -> Self {
        Self::Refused(sentence.to_owned())
    }
}
