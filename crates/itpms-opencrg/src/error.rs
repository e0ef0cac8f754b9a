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
    /// What is wrong with it.
    pub problem: Box<CrgProblem>,
}

/// One kind of problem with an OpenCRG file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CrgProblem {
    /// One that a file of any format may have.
    #[error(transparent)]
    File(#[from] FileProblem),
    /// No line of `$$$$` that ends the header.
    #[error("the header does not end: expected a line that begins with $$$$ before the data")]
    NoData,
    /// A section that has to be there.
    #[error("section ${0} is missing from the header")]
    MissingSection(&'static str),
    /// A section that is there twice.
    #[error("line {line}: section ${section} a second time (first in line {first})")]
    SecondSection {
        /// Where.
        line: u64,
        /// Its name.
        section: &'static str,
        /// Where it was before.
        first: u64,
    },
    /// A line of a section that is no `name = value`.
    #[error("line {line}: found {found:?} in ${section}, expected name = value")]
    Assignment {
        /// Where.
        line: u64,
        /// The section.
        section: &'static str,
        /// The line's beginning.
        found: String,
    },
    /// A value that is no number.
    #[error("line {line}, column {column}: {key} is {found:?}, expected a finite number")]
    Value {
        /// Where.
        line: u64,
        /// Character in the line, from one.
        column: usize,
        /// The name.
        key: String,
        /// The value.
        found: String,
    },
    /// A name that is there twice.
    #[error("line {line}: {key} a second time (first in line {first})")]
    SecondKey {
        /// Where.
        line: u64,
        /// The name.
        key: String,
        /// Where it was before.
        first: u64,
    },
    /// A name that is not in the standard.
    #[error("line {line}: unknown {key} in ${section}{}", did_you_mean(.nearest))]
    UnknownKey {
        /// Where.
        line: u64,
        /// The section.
        section: &'static str,
        /// The name.
        key: String,
        /// The most similar known name.
        nearest: Option<String>,
    },
    /// A number outside the range that makes sense.
    #[error("line {line}: {key} is {value}, expected {expected}")]
    Range {
        /// Where.
        line: u64,
        /// The name.
        key: String,
        /// The number.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// The surface is in another file.
    #[error("line {line}: the road is in another file ({file}), expected the road itself: give that file")]
    OtherFile {
        /// Where.
        line: u64,
        /// The file's name as written.
        file: String,
    },
    /// A format of the data that is not OpenCRG's.
    #[error(
        "line {line}: data format {found:?}, expected #:LRFI, LDFI, KRFI, KDFI, LRBI, LDBI, KRBI or KDBI"
    )]
    Format {
        /// Where.
        line: u64,
        /// As written.
        found: String,
    },
    /// No format of the data.
    #[error("$KD_DEFINITION names no data format, expected a line such as #:KRBI")]
    NoFormat,
    /// A data channel that cannot be used.
    #[error("line {line}: data channel {found:?}, expected {expected}")]
    Channel {
        /// Where.
        line: u64,
        /// As written.
        found: String,
        /// What it may be.
        expected: &'static str,
    },
    /// Too few or impossible long sections.
    #[error("{found} long sections, expected {expected}")]
    LongSections {
        /// How many, or which.
        found: String,
        /// What there must be.
        expected: &'static str,
    },
    /// The reference line's length, increment and data do not agree.
    #[error(
        "{found} cross sections of data, expected {expected} from the header ({start_m} to {end_m} m by {increment_m} m)"
    )]
    Length {
        /// Rows there are.
        found: usize,
        /// Rows there should be.
        expected: usize,
        /// Start of the reference line in m.
        start_m: f64,
        /// Its end in m.
        end_m: f64,
        /// Distance from row to row in m.
        increment_m: f64,
    },
    /// Data that end within a cross section.
    #[error("{place}: the data end within a cross section, after {found} of its {expected} values")]
    CutOff {
        /// Where.
        place: Place,
        /// Values there are.
        found: usize,
        /// Values there should be.
        expected: usize,
    },
    /// Text where a number belongs.
    #[error(
        "line {line}, columns {first} to {last}: found {found:?}, expected a number or *missing* in {width} characters"
    )]
    Cell {
        /// Where.
        line: u64,
        /// First character, from one.
        first: usize,
        /// Last character.
        last: usize,
        /// What is there.
        found: String,
        /// Characters a number has.
        width: usize,
    },
    /// A line of numbers that is longer than a record.
    #[error("line {line}: {found} characters, expected at most {expected}")]
    LongLine {
        /// Where.
        line: u64,
        /// Its length.
        found: usize,
        /// Largest length.
        expected: usize,
    },
    /// An infinite height, or a reference line with a hole.
    #[error("{place}, {channel}: found {found}, expected a finite number")]
    NotFinite {
        /// Where.
        place: Place,
        /// The channel as the file names it.
        channel: String,
        /// What is there.
        found: f64,
    },
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(" (did you mean {name}?)")).unwrap_or_default()
}
