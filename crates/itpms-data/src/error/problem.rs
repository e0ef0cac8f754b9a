//! The kinds of problems with a file, and their words.

use itpms_core::model::ParameterError;
use itpms_files::{FileProblem, Place};
use thiserror::Error;

use super::hints::{because, hint, hint_key, hint_missing, one_by_one, other_unit};
use crate::pressure_unit::pressure_in_other_unit;
use crate::pulses::problem::PulseProblem;
use crate::reference::problem::ReferenceProblem;
use crate::signals::problem::SignalProblem;

/// One kind of problem with a file.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Problem {
    /// One that a file of any format may have.
    #[error(transparent)]
    File(#[from] FileProblem),

    /// No corner can be made of the signals.
    #[error("{0}")]
    UnusableSignals(String),
    /// The signals that were mapped hardly have values; what had to be repaired may say why.
    #[error("no row can be made: too few values of the mapped accelerations{}", because(.0))]
    NoRows(Vec<String>),
    /// A file that another program makes of what is read.
    #[error("{0}")]
    Elsewhere(String),
    /// An option that means nothing for this format.
    #[error("{0}")]
    NotApplicable(&'static str),

    // --- drive logs: the table ---
    /// What spreadsheets call Unicode text, behind gzip.
    #[error("the packed text is UTF-16, expected UTF-8: unpack it (gunzip), then it is read")]
    Utf16,
    /// Zero bytes or blank lines only.
    #[error("the file is empty, expected a header line with time_s and the accelerations of a corner")]
    Empty,
    /// Zero bytes where a file of this kind was expected.
    #[error("the file is empty, expected {0}")]
    EmptyFile(&'static str),
    /// What MCAP begins with is not there.
    #[cfg(feature = "mcap")]
    #[error(
        "it does not begin as an MCAP file ({0}), expected one as ROS 2, Foxglove or this program record it"
    )]
    NotMcap(String),
    #[error("there is a header but no row under it")]
    HeaderOnly,
    #[error("not a readable Parquet file: {0}")]
    Parquet(String),
    /// A problem in one of several part files.
    #[error("{part}: {problem}")]
    InPart { part: String, problem: Box<Problem> },
    /// A column that has to be there.
    #[error("column {column} is missing{}", hint(.nearest))]
    MissingColumn {
        column: String,
        /// The most similar name that is there.
        nearest: Option<String>,
    },
    /// A corner of which one acceleration is there and the other one is not.
    #[error(
        "column {column} is missing; a corner has both accelerations: without {present} the log is read without this corner"
    )]
    HalfCorner { column: String, present: String },
    /// A table of measurements without a column it has to have.
    #[error("column {column} is missing{}; found {found}, expected {expected}", hint(.nearest))]
    NotAmongColumns {
        column: String,
        /// The most similar name that is there.
        nearest: Option<String>,
        found: String,
        expected: String,
    },
    /// A measurement that is missing where every row has to be complete.
    #[error("{place}, column {column}: found {found}, expected a finite number")]
    NotFinite { place: Place, column: String, found: String },
    #[error("the file is empty, expected a header line with {0}")]
    NoHeader(String),
    /// The header is one long cell because another separator was used.
    #[error("the header is separated by {0:?}, expected commas")]
    Separator(char),
    /// A column that is there twice.
    #[error("column {column} appears twice (columns {first} and {second}), expected once: rename one")]
    DuplicateColumn {
        column: String,
        /// Its first place, from one.
        first: usize,
        /// Its second place, from one.
        second: usize,
    },
    /// A Parquet column of another type.
    #[error("column {column} holds {found}, expected numbers{}", one_by_one(.found))]
    ColumnType { column: String, found: String },
    /// A column that holds other than words.
    #[error("column {column} holds {found}, expected one of the words {expected}")]
    WordsExpected { column: String, found: String, expected: String },
    /// Text where a number belongs.
    #[error(
        "{place}, column {column}: found {found:?}, expected a number, or NaN or nothing where it is missing{hint}"
    )]
    NotANumber {
        place: Place,
        column: String,
        /// The cell (its beginning, if long).
        found: String,
        /// What else could stand there, in parentheses, or nothing.
        hint: &'static str,
    },
    /// A row that is longer or shorter than the header.
    #[error("{place}: found {found} cells, expected {expected} as in the header")]
    CellCount { place: Place, found: usize, expected: usize },

    /// A header in the middle of a file that is not the first one in another order.
    #[error(
        "{place}: the header comes again with other columns (column {column} is in one of the two alone), expected the same: cut the file there, \
         each of its parts has a header then"
    )]
    OtherColumns {
        place: Place,
        /// A column of one of the two.
        column: String,
    },

    // --- drive logs: the contents ---
    /// A drive has more than one sample.
    #[error("found {0} sample with a time, expected at least 2")]
    TooFewSamples(u64),
    /// No row says when it was measured.
    #[error("column time_s has no value in any of {rows} rows")]
    NoTime { rows: u64 },
    #[error("time is constant: time_s is {time_s} in all of the {rows} rows read, expected it to increase")]
    TimeConstant { time_s: f64, rows: u64 },
    /// The clock's resolution is too coarse.
    #[error(
        "time stands still in {repeated} of the {rows} rows read (first at {place}), expected it to increase from row to row"
    )]
    TimeRepeats {
        /// Rows with the time of the row before.
        repeated: u64,
        rows: u64,
        place: Place,
    },
    /// The same in a folder of parts, where two begin before the other has ended.
    #[error(
        "{repeated} of the {rows} rows read have the time of another one, and the parts {one} and {other} have rows of the same time, expected each row once: \
         move one of the two elsewhere"
    )]
    PartsRepeat {
        /// Rows with the time of another one.
        repeated: u64,
        rows: u64,
        one: String,
        other: String,
    },
    /// The clock counts in steps longer than the samples' period, and these did not come evenly.
    #[error(
        "the times of {what} are in steps of {} s under {:.0} samples a second, and these are not even: where each belongs is not sure; \
         expected steps shorter than the samples' period (write the time with more digits, or take the logger's finer clock)",
        (*.step_s * 1e6).round() / 1e6, .rate_hz
    )]
    CoarseClock { what: String, step_s: f64, rate_hz: f64 },
    /// Stamps that are off by a good part of the sample period.
    #[error(
        "the times are uneven: a step of {} s has a standard deviation of {jitter_percent:.0} %, so frequencies are unknown; expected even samples \
         (write the time at which each was taken, not at which it arrived)",
        (*.period_s * 1e6).round() / 1e6
    )]
    UnevenStamps {
        /// Standard deviation of a step over its mean, in percent.
        jitter_percent: f64,
        period_s: f64,
    },
    /// The rows of two drives in turns.
    #[error(
        "from {from_s} to {to_s} s rows differ from their neighbors {ratio:.0} times as much as from those before: two recordings in turns, or more, expected \
         one ({way_out})"
    )]
    TwoRecordings {
        /// Mean square between neighbors over that between the rows that go on from each other.
        ratio: f64,
        /// Where that is so: from here, in s.
        from_s: f64,
        to_s: f64,
        way_out: String,
    },
    #[error(
        "the rate changes from {from_hz:.0} to {to_hz:.0} Hz at {since_s} s, expected one rate (cut the log there)"
    )]
    RateChanges { from_hz: f64, to_hz: f64, since_s: f64 },
    /// Many readings of one signal do not fit the clock of the others.
    #[error(
        "{left_out} of the {readings} readings of {column} have stamps that contradict those of the others by more than ten seconds or \
         go through the same seconds again, expected 1 % at most (was a clock set? then cut the log there)"
    )]
    StampsContradict { column: String, left_out: u64, readings: u64 },
    /// Rows are not in the order of time, and not just one or two of them.
    #[error(
        "time goes backwards in {backwards} of the {rows} rows read, at {place} from {from_s} to {to_s} s, expected it to increase \
         (rows are put in order over ten seconds; sort the file by its time, or cut it where the clock was set)"
    )]
    TimeBackwards {
        /// Rows that lie before an earlier row.
        backwards: u64,
        rows: u64,
        /// The first row with which time went back.
        place: Place,
        /// Time of the row before it in the file in s.
        from_s: f64,
        to_s: f64,
    },
    /// A second recording under the first one.
    #[error(
        "the clock begins again at {place}, from {from_s} to {to_s} s: another recording, expected one: cut the file before {place}, and give each part \
         the header"
    )]
    BeginsAgain {
        /// The first row of the other one.
        place: Place,
        /// Time of the row before it in s.
        from_s: f64,
        to_s: f64,
    },
    /// No wheel can be seen at this rate.
    #[error(
        "the sample period is {} s ({rate_hz:.3} Hz), expected 100 Hz to 2 kHz (wheel speeds alone: 10 Hz at least) with time_s in seconds{}",
        (*.period_s * 1e6).round() / 1e6,
        other_unit(clock, *.period_s)
    )]
    SamplePeriod {
        /// The name of the column of the time.
        clock: String,
        period_s: f64,
        rate_hz: f64,
    },
    /// No corner has a usable pair of sensors.
    #[error("column {column} has no value in any of {rows} rows, and no other corner is complete")]
    AllMissing { column: String, rows: u64 },
    /// A number that stands for no value.
    #[error(
        "{what} is {value} in {count} of the first {rows} rows, far from all others, as where a number stands for no value; expected NaN or \
         nothing there"
    )]
    StandsForMissing { what: String, value: f64, count: usize, rows: usize },
    /// The numbers cannot be in the units that they should be in.
    #[error("wrong units suspected ({suspicion}): {evidence}, expected {expected}")]
    Units { suspicion: &'static str, expected: &'static str, evidence: String },

    // --- vehicle files ---
    #[error("line {line}: not valid TOML: {message}")]
    Syntax { line: usize, message: String },
    /// An unexpected key, most likely mistyped.
    #[error("line {line}: unknown key {key} in {table}{}, expected one of: {known}", hint_key(.nearest))]
    UnknownKey { line: usize, table: String, key: String, nearest: Option<String>, known: String },
    /// A key that has to be there.
    #[error("{table} has no {key}{}", hint_missing(*.line))]
    MissingKey { line: Option<usize>, table: String, key: String },
    /// A value of another type.
    #[error("line {line}: {table} {key} is {found}, expected {expected}")]
    ValueType { line: usize, table: String, key: String, found: String, expected: &'static str },
    /// A value outside its physical range.
    #[error("line {line}: {table} {error}")]
    Parameter { line: usize, table: String, error: ParameterError },
    /// A value that no car has in the unit of its key.
    #[error(
        "line {line}: {table} {key} is {value}, expected {low} to {high} (another unit?{})",
        if key.ends_with("_kpa") { pressure_in_other_unit(*.value) } else { String::new() }
    )]
    Implausible { line: usize, table: String, key: &'static str, value: f64, low: f64, high: f64 },
    // --- roads ---
    /// A table of accelerations where heights belong.
    #[error(
        "looks like a drive log (accelerations over time), expected a road profile with distance_m and heights"
    )]
    DriveLog,
    /// Numbers that nothing says the meaning of.
    #[error(
        "{place}: found {found} columns of numbers without a header, expected 2 (distance and height) or 3 (distance, left and right)"
    )]
    UnnamedColumns { place: Place, found: usize },
    /// A profile whose rows are not in the order of distance.
    #[error("{place}: the distance goes back from {from_m} to {to_m} m, expected it to increase")]
    DistanceBackwards {
        place: Place,
        /// Distance of the row before in m.
        from_m: f64,
        to_m: f64,
    },
    /// A profile without a length.
    #[error("found no two rows with different distances, expected a road")]
    NoRoad,
    /// An OpenCRG file that cannot be used.
    #[error(transparent)]
    Crg(crate::crg::CrgProblem),

    /// A CAN log or a description of a bus that cannot be used.
    #[cfg(feature = "can")]
    #[error(transparent)]
    Can(crate::can::CanProblem),

    // --- vehicle files, as a whole ---
    #[error(
        "no corner is described, expected at least one table [corner.fl] (or fr, rl, rr); for wheel speeds alone wheelbase_m, track_front_m, track_rear_m and driven in [vehicle]"
    )]
    NoCorner,

    // --- MDF4 ---
    /// Not MDF4, or damaged beyond reading.
    #[cfg(feature = "mdf4")]
    #[error(transparent)]
    Mdf4(crate::mdf4::Mdf4Problem),

    // --- learned references ---
    /// Not a reference, not a whole one, or another car's.
    #[error(transparent)]
    Reference(#[from] ReferenceProblem),

    // --- tooth pulses ---
    /// No table of pulses.
    #[error(transparent)]
    Pulses(#[from] PulseProblem),

    // --- signals ---
    /// A map of signals, or a map and a log, that do not fit.
    #[error(transparent)]
    Signals(#[from] SignalProblem),
}
