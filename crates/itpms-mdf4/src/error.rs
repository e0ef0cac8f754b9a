//! Problems of an MDF4 file: named where found, or repaired and reported.
//!
//! Made by every part of this module; [`Damage`] becomes an error or a repair only where it is known whether the rest of
//! the file can be read without it.

use std::fmt;
use std::path::{Path, PathBuf};

use itpms_files::{FileError, FileProblem, sentence};
use thiserror::Error;

/// An MDF file that could not be read or written, and why.
#[derive(Debug, Error)]
#[error("{}", sentence(path, problem))]
pub struct Mdf4Error {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: Box<Mdf4Problem>,
}

impl Mdf4Error {
    pub(super) fn new(path: &Path, problem: impl Into<Mdf4Problem>) -> Self {
        Self { path: path.to_owned(), problem: Box::new(problem.into()) }
    }
}

impl From<FileError> for Mdf4Error {
    fn from(error: FileError) -> Self {
        Self { path: error.path, problem: Box::new(error.problem.into()) }
    }
}

/// A block that is not what its link promises.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Expected kind of block.
    pub block: &'static str,
    /// Its place in the file in bytes.
    pub at: u64,
    /// Found instead.
    pub found: String,
}

impl Damage {
    pub(super) fn new(block: &'static str, at: u64, found: impl Into<String>) -> Self {
        Self { block, at, found: found.into() }
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at byte {}: {}", self.block, self.at, self.found)
    }
}

/// Why a file cannot be read or written as MDF4.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Mdf4Problem {
    /// One that a file of any format may have.
    #[error(transparent)]
    File(#[from] FileProblem),
    #[error("not an MDF file: it begins with {0:?}, expected \"MDF     \" or \"UnFinMF \"")]
    NotMdf(String),
    #[error("cut off after {0} bytes, expected at least the 168 of the identification and the header")]
    TooShort(u64),
    #[error("MDF version {0}, expected 2.00 to 4.39")]
    Version(String),
    #[error("{0}")]
    Unreadable(Damage),
    #[error("no channel group can be read{}", .0.as_ref().map(|damage| format!(": {damage}")).unwrap_or_default())]
    NoGroup(Option<Damage>),
    #[error("there are more than {most} {what}, expected fewer")]
    TooMany { what: &'static str, most: usize },
    #[error("there is no channel group {0}")]
    NoSuchGroup(usize),
    #[error("channel group {group:?} has no channel {channel}")]
    NoSuchChannel { group: String, channel: usize },
    #[error("channel group {0:?} has no time channel that can be read")]
    NoTime(String),
    #[error("channel {channel:?} of group {group:?} cannot be read as numbers: it is {found}")]
    NotNumeric { group: String, channel: String, found: String },
    #[error("the records of channel group {group:?} have {found} bytes, expected at most {most}")]
    RecordLength { group: String, found: u64, most: u64 },
    #[error("channel group {group:?} claims {found} samples without a byte of data, expected at most {most}")]
    EmptyRecords { group: String, found: u64, most: u64 },
    #[error("compressed block at byte {at} claims {found} bytes of contents, expected at most {most}")]
    BlockLength { at: u64, found: u64, most: u64 },
    #[error(
        "compressed block at byte {at} has compression {found}, expected 0 to 5 (deflate, zstd or lz4, each also transposed)"
    )]
    Compression { at: u64, found: u8 },
    #[error("data blocks overlap or form a ring: together they are longer than the file")]
    Overlap,

    // --- writing ---
    #[error("MDF4 cannot be written into a pipe or device, expected a file")]
    Device,
    #[error("a sample of channel group {group:?} has the time {found}, expected a finite number")]
    SampleTime { group: String, found: f64 },
    #[error("a sample of channel group {group:?} has {found} values, expected {expected}")]
    SampleWidth { group: String, found: usize, expected: usize },
    #[error("channel {channel:?} is to hold {found}, expected a number from {least} to {most}")]
    IntegerRange { channel: String, found: f64, least: f64, most: f64 },
}

/// A repair or an omission while reading; its text is a remark, not a failure.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Mdf4Repair {
    #[error("the file was not finalised ({missing}): taken from the data instead")]
    Unfinalised { missing: String },
    #[error("{list}: the list breaks off after {read} ({damage}); what follows is left out")]
    ListCut { list: String, read: usize, damage: Damage },
    #[error("{0}; the text is left empty")]
    Text(Damage),
    #[error("names and comments of more than {most} bytes: the rest are left empty")]
    TextsLeftOut { most: usize },
    #[error("group {group:?}: its clock is in {unit}, expected s; read in {unit}")]
    ClockUnit { group: String, unit: String },
    #[error("group {group:?}: the number of samples is 0 although there are data; all of them are read")]
    CountZero { group: String },
    #[error("group {group:?}: read {read} of {claimed} samples, the others are not there")]
    FewerSamples { group: String, read: u64, claimed: u64 },
    #[error("group {group:?}: there are more data than for the {claimed} samples claimed; left out")]
    MoreSamples { group: String, claimed: u64 },
    #[error("group {group:?}: {lost} samples in damaged blocks are left out")]
    SamplesLost { group: String, lost: u64 },
    #[error("group {group:?}: {damage}")]
    Data { group: String, damage: Damage },
    #[error("group {group:?}: the last sample is cut off after {bytes} bytes and left out")]
    PartialRecord { group: String, bytes: usize },
    #[error(
        "group {group:?}: after {read} samples there is a record of no known group (id {id}); the rest is left out"
    )]
    UnknownRecord { group: String, id: u64, read: u64 },
    #[error("and {0} more of these")]
    More(u64),
}

#[derive(Debug, Default)]
pub(super) struct Repairs(Vec<Mdf4Repair>);

const LISTED: usize = 50;

impl Repairs {
    pub(super) fn push(&mut self, repair: Mdf4Repair) {
        if let Some(Mdf4Repair::More(count)) = self.0.last_mut() {
            *count += 1;
        } else {
            self.0.push(if self.0.len() == LISTED { Mdf4Repair::More(1) } else { repair });
        }
    }

    pub(super) fn list(&self) -> &[Mdf4Repair] {
        &self.0
    }
}
