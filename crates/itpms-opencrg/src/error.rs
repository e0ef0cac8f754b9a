//! What can be wrong with an OpenCRG file: the line or row, the column, what was found, what was expected.
//!
//! Made by the modules beside it.

use std::path::PathBuf;

use itpms_files::{FileProblem, Place, sentence};
use thiserror::Error;

/// An OpenCRG file that could not be used, and why.
#[derive(Debug, Error)]
#[error("{}", sentence(path, problem))]
pub struct CrgError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: Box<CrgProblem>,
}

/// One kind of problem with an OpenCRG file.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum CrgProblem {
    /// One that a file of any format may have.
    #[error(transparent)]
    File(#[from] FileProblem),
    #[error("the header does not end: expected a line that begins with $$$$ before the data")]
    NoData,
    #[error("section ${0} is missing from the header")]
    MissingSection(&'static str),
    #[error("line {line}: section ${section} a second time (first in line {first})")]
    SecondSection { line: u64, section: &'static str, first: u64 },
    #[error("line {line}: found {found:?} in ${section}, expected name = value")]
    Assignment { line: u64, section: &'static str, found: String },
    #[error("line {line}, column {column}: {key} is {found:?}, expected a finite number")]
    Value { line: u64, column: usize, key: String, found: String },
    #[error("line {line}: {key} a second time (first in line {first})")]
    SecondKey { line: u64, key: String, first: u64 },
    #[error("line {line}: unknown {key} in ${section}{}", did_you_mean(.nearest))]
    UnknownKey { line: u64, section: &'static str, key: String, nearest: Option<String> },
    #[error("line {line}: {key} is {value}, expected {expected}")]
    Range { line: u64, key: String, value: f64, expected: &'static str },
    #[error("line {line}: the road is in another file ({file}), expected the road itself: give that file")]
    OtherFile { line: u64, file: String },
    #[error(
        "line {line}: data format {found:?}, expected #:LRFI, LDFI, KRFI, KDFI, LRBI, LDBI, KRBI or KDBI"
    )]
    Format { line: u64, found: String },
    #[error("$KD_DEFINITION names no data format, expected a line such as #:KRBI")]
    NoFormat,
    #[error("line {line}: data channel {found:?}, expected {expected}")]
    Channel { line: u64, found: String, expected: &'static str },
    #[error("{found} long sections, expected {expected}")]
    LongSections { found: String, expected: &'static str },
    #[error(
        "{found} cross sections of data, expected {expected} from the header ({start_m} to {end_m} m by {increment_m} m)"
    )]
    Length { found: usize, expected: usize, start_m: f64, end_m: f64, increment_m: f64 },
    #[error("{place}: the data end within a cross section, after {found} of its {expected} values")]
    CutOff { place: Place, found: usize, expected: usize },
    #[error(
        "line {line}, columns {first} to {last}: found {found:?}, expected a number or *missing* in {width} characters"
    )]
    Cell { line: u64, first: usize, last: usize, found: String, width: usize },
    #[error("line {line}: {found} characters, expected at most {expected}")]
    LongLine { line: u64, found: usize, expected: usize },
    #[error("{place}, {channel}: found {found}, expected a finite number")]
    NotFinite { place: Place, channel: String, found: f64 },
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(" (did you mean {name}?)")).unwrap_or_default()
}
