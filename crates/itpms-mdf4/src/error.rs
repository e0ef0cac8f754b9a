//! What can be wrong with an MDF4 file: named where it was found, or repaired and reported.
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
    /// What is wrong with it.
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
    /// What the block should be.
    pub block: &'static str,
    /// Its place in the file in bytes.
    pub at: u64,
    /// What is there instead.
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
    /// Shorter than the blocks every file begins with.
    #[error("cut off after {0} bytes, expected at least the 168 of the identification and the header")]
    TooShort(u64),
    /// A version of another layout.
    #[error("MDF version {0}, expected 2.00 to 4.39")]
    Version(String),
    /// A block without which nothing can be read.
    #[error("{0}")]
    Unreadable(Damage),
    /// There is not one channel group.
    #[error("no channel group can be read{}", .0.as_ref().map(|damage| format!(": {damage}")).unwrap_or_default())]
    NoGroup(Option<Damage>),
    /// More than a measurement has.
    #[error("there are more than {most} {what}, expected fewer")]
    TooMany { what: &'static str, most: usize },
    /// An index that is not among the groups.
    #[error("there is no channel group {0}")]
    NoSuchGroup(usize),
    /// An index that is not among the channels.
    #[error("channel group {group:?} has no channel {channel}")]
    NoSuchChannel { group: String, channel: usize },
    #[error("channel group {0:?} has no time channel that can be read")]
    NoTime(String),
    /// A channel that is text, bytes, or a number that cannot be computed.
    #[error("channel {channel:?} of group {group:?} cannot be read as numbers: it is {found}")]
    NotNumeric { group: String, channel: String, found: String },
    /// Records beyond the bound on memory.
    #[error("the records of channel group {group:?} have {found} bytes, expected at most {most}")]
    RecordLength { group: String, found: u64, most: u64 },
    /// Samples that exist only as a number in the header.
    #[error("channel group {group:?} claims {found} samples without a byte of data, expected at most {most}")]
    EmptyRecords { group: String, found: u64, most: u64 },
    /// A compressed block beyond the bound on memory.
    #[error("compressed block at byte {at} claims {found} bytes of contents, expected at most {most}")]
    BlockLength { at: u64, found: u64, most: u64 },
    /// A compression that is not known.
    #[error(
        "compressed block at byte {at} has compression {found}, expected 0 to 5 (deflate, zstd or lz4, each also transposed)"
    )]
    Compression { at: u64, found: u8 },
    /// Data blocks that overlap or form a ring.
    #[error("data blocks overlap or form a ring: together they are longer than the file")]
    Overlap,

    // --- writing ---
    /// What is written when all is known cannot be written into a pipe.
    #[error("MDF4 cannot be written into a pipe or device, expected a file")]
    Device,
    /// A sample without a time.
    #[error("a sample of channel group {group:?} has the time {found}, expected a finite number")]
    SampleTime { group: String, found: f64 },
    /// A sample with too few or too many values.
    #[error("a sample of channel group {group:?} has {found} values, expected {expected}")]
    SampleWidth { group: String, found: usize, expected: usize },
    /// A number an integer channel cannot hold.
    #[error("channel {channel:?} is to hold {found}, expected a number from {least} to {most}")]
    IntegerRange { channel: String, found: f64, least: f64, most: f64 },
}

/// What was mended or left out while reading.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Mdf4Repair {
    /// The program that wrote the file did not come to its end.
    Unfinalised { missing: String },
    /// A list of groups or channels that breaks off.
    ListCut { list: String, read: usize, damage: Damage },
    /// A text, a unit or a comment that cannot be read.
    Text(Damage),
    /// More text than is kept.
    TextsLeftOut { most: usize },
    /// A clock in another unit than the standard's.
    ClockUnit { group: String, unit: String },
    /// Data without a count.
    CountZero { group: String },
    /// A group with fewer samples than it claims.
    FewerSamples { group: String, read: u64, claimed: u64 },
    /// A group with more samples than it claims.
    MoreSamples { group: String, claimed: u64 },
    /// Samples in the middle that cannot be read.
    SamplesLost { group: String, lost: u64 },
    /// A data block that cannot be read, or not to its end.
    Data { group: String, damage: Damage },
    /// The last record is incomplete.
    PartialRecord { group: String, bytes: usize },
    /// A record of a group that does not exist: what follows cannot be separated.
    UnknownRecord { group: String, id: u64, read: u64 },
    /// More repairs than are listed.
    More(u64),
}

impl fmt::Display for Mdf4Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unfinalised { missing } => {
                write!(f, "the file was not finalised ({missing}): taken from the data instead")
            }
            Self::ListCut { list, read, damage } => {
                write!(f, "{list}: the list breaks off after {read} ({damage}); what follows is left out")
            }
            Self::Text(damage) => write!(f, "{damage}; the text is left empty"),
            Self::TextsLeftOut { most } => {
                write!(f, "names and comments of more than {most} bytes: the rest are left empty")
            }
            Self::ClockUnit { group, unit } => {
                write!(f, "group {group:?}: its clock is in {unit}, expected s; read in {unit}")
            }
            Self::CountZero { group } => {
                write!(
                    f,
                    "group {group:?}: the number of samples is 0 although there are data; all of them are read"
                )
            }
            Self::FewerSamples { group, read, claimed } => {
                write!(f, "group {group:?}: read {read} of {claimed} samples, the others are not there")
            }
            Self::MoreSamples { group, claimed } => {
                write!(
                    f,
                    "group {group:?}: there are more data than for the {claimed} samples claimed; left out"
                )
            }
            Self::SamplesLost { group, lost } => {
                write!(f, "group {group:?}: {lost} samples in damaged blocks are left out")
            }
            Self::Data { group, damage } => write!(f, "group {group:?}: {damage}"),
            Self::PartialRecord { group, bytes } => {
                write!(f, "group {group:?}: the last sample is cut off after {bytes} bytes and left out")
            }
            Self::UnknownRecord { group, id, read } => write!(
                f,
                "group {group:?}: after {read} samples there is a record of no known group (id {id}); the rest is left out"
            ),
            Self::More(count) => write!(f, "and {count} more of these"),
        }
    }
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
