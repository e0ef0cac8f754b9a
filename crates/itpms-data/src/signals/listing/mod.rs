//! The contents of a log of any format: every signal with its rate and range, read once from beginning to end.
//!
//! Called by `itpms signals`, a stretch at a time so that it can show progress and be interrupted. Memory grows with the number of signals,
//! not with the length of the log. Knows nothing of columns; [`resolve`](super::resolve) says which signal is which.

#[cfg(feature = "can")]
mod frames;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "mdf4")]
mod mdf4;
#[cfg(feature = "parquet")]
mod parquet;
mod statistics;
mod table;

use std::collections::HashMap;
use std::fmt::Debug;
use std::path::{Path, PathBuf};

use super::{Candidate, Unread};
use crate::error::{DataError, Problem, likely_unit};
use crate::log::{Format, LogFormat, Selection};
use crate::signals::column_unit;
#[cfg(feature = "mcap")]
pub(crate) use mcap::McapLister;
use statistics::{Clock, Range};

/// A log that is being listed.
#[derive(Debug)]
pub struct Lister {
    path: PathBuf,
    source: Box<dyn FormatLister>,
}

/// The list of a log of one format in the making.
pub(crate) trait FormatLister: Debug + Send {
    /// Reads on for a stretch of some thousand values; false at the end.
    fn step(&mut self) -> Result<bool, Problem>;

    fn progress(&self) -> f64;

    fn finish(self: Box<Self>) -> Listing;
}

#[derive(Debug, Clone, PartialEq)]
pub struct Listing {
    pub groups: Vec<ListedGroup>,
    /// Kind of the groups: `message`, `group`, `topic` or `table`.
    pub kind: &'static str,
    /// First and last time in s, if there is any.
    pub span_s: Option<(f64, f64)>,
    pub samples: u64,
    /// The column of a table that is taken for its clock.
    pub clock: Option<String>,
    /// Repairs, omissions, and problems of the bus description.
    pub notes: Vec<String>,
    /// Signals that the description has but this log has not, in candidates' order after those of `groups`.
    pub absent: Vec<Candidate>,
    /// Other contents that cannot be read, with the reason.
    pub unread: Vec<Unread>,
}

/// Signals with a common clock.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedGroup {
    /// Its name; empty for a table and for a message that no description knows.
    pub name: String,
    /// A message's identifier in hexadecimal, `120` or, of 29 bits, `18FEF100`.
    pub id: Option<String>,
    /// The bus it came on, where a log has several.
    pub bus: Option<u16>,
    pub is_known: bool,
    pub samples: u64,
    /// Samples per second, gaps left out.
    pub rate_hz: Option<f64>,
    /// Standard deviation of the time from one to the next in s, gaps left out.
    pub jitter_s: Option<f64>,
    pub stated_hz: Option<f64>,
    /// The group of which this one is a later stretch, by its place in the list.
    pub stretch_of: Option<usize>,
    /// Shortest and longest data in bytes, of messages.
    pub bytes: Option<(usize, usize)>,
    pub signals: Vec<ListedSignal>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ListedSignal {
    pub name: String,
    /// Its unit as the log has it; may be empty.
    pub unit: String,
    pub samples: u64,
    /// Places without a value: empty, invalid, not available.
    pub missing: u64,
    /// Least value; NaN if there is none.
    pub min: f64,
    /// Largest value; NaN if there is none.
    pub max: f64,
}

impl Lister {
    /// Opens a log by its extension. `dbc`: what the frames of a CAN log mean; `rows`: which rows of a table.
    /// Errors: the log or the description cannot be read, or a description is given for something else than a CAN log.
    pub fn open(path: &Path, dbc: Option<&Path>, rows: &[Selection]) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        let format = LogFormat::of_log(path, dbc)?;
        #[cfg(feature = "can")]
        let is_bus_log = format == LogFormat::Can;
        #[cfg(not(feature = "can"))]
        let is_bus_log = false;
        if dbc.is_some() && !is_bus_log {
            return Err(fail("a DBC file says what the frames of a CAN log mean; this is none".into()));
        }
        let source: Box<dyn FormatLister> = match format {
            #[cfg(feature = "can")]
            LogFormat::Can => Box::new(frames::FrameLister::open(path, dbc)?),
            #[cfg(feature = "mdf4")]
            LogFormat::Mdf4 => Box::new(mdf4::Mdf4Lister::open(path)?),
            #[cfg(feature = "mcap")]
            LogFormat::Mcap => Box::new(McapLister::open(path)?),
            #[cfg(feature = "parquet")]
            LogFormat::Table(Format::Parquet) => {
                Box::new(parquet::ParquetLister::open(path, rows).map_err(fail)?)
            }
            LogFormat::Table(Format::Csv) => Box::new(table::TableLister::open(path, rows).map_err(fail)?),
        };
        Ok(Self { path: path.to_owned(), source })
    }

    /// Reads on for a stretch of some thousand values; false at the end.
    pub fn step(&mut self) -> Result<bool, DataError> {
        self.source.step().map_err(|problem| DataError::new(&self.path, problem))
    }

    /// Share of the log that has been read, 0 to 1.
    pub fn progress(&self) -> f64 {
        self.source.progress()
    }

    pub fn finish(self) -> Listing {
        self.source.finish()
    }
}

impl Listing {
    /// The unit of a table's clock, where it does not say one and counts in none of seconds.
    pub fn clock_unit(&self) -> Option<&'static str> {
        let rate_hz = self.clock.as_ref().and(self.groups.first()?.rate_hz)?;
        likely_unit(1.0 / rate_hz).map(|(_, unit)| unit)
    }

    /// All signals, group by group and then those of `absent`, as candidates for columns. A message that came on several
    /// buses, or a recording in stretches, is there once.
    pub fn candidates(&self) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = Vec::new();
        for (group, first) in self.groups.iter().zip(self.first_candidates()) {
            if first == candidates.len() {
                candidates.extend(group.signals.iter().map(|signal| Candidate {
                    group: group.name.clone(),
                    name: signal.name.clone(),
                    unit: signal.unit.clone(),
                }));
            }
        }
        candidates.extend(self.absent.iter().cloned());
        candidates
    }

    /// For each of [`Listing::candidates`], whether it has samples in this log.
    pub fn has_samples(&self) -> Vec<bool> {
        let mut has_samples = vec![false; self.candidates().len()];
        for (group, first) in self.groups.iter().zip(self.first_candidates()) {
            for (signal, has) in group.signals.iter().zip(has_samples.iter_mut().skip(first)) {
                *has |= signal.samples > 0;
            }
        }
        has_samples
    }

    /// For each group the number of its first signal among [`Listing::candidates`]; the others follow.
    pub fn first_candidates(&self) -> Vec<usize> {
        let mut next = 0;
        let mut by_id: HashMap<&str, usize> = HashMap::new();
        let mut firsts: Vec<usize> = Vec::with_capacity(self.groups.len());
        for group in &self.groups {
            let first = match (&group.id, group.stretch_of.and_then(|group| firsts.get(group))) {
                (Some(id), _) => *by_id.entry(id.as_str()).or_insert(next),
                (None, Some(first)) => *first,
                (None, None) => next,
            };
            firsts.push(first);
            if first == next {
                next += group.signals.len();
            }
        }
        firsts
    }

    fn of_one_table(
        columns: Vec<(String, Range)>,
        units: &[String],
        column: Option<String>,
        clock: &Clock,
        notes: Vec<String>,
    ) -> Self {
        let signals = columns
            .into_iter()
            .enumerate()
            .map(|(place, (name, range))| {
                let stated = units.get(place).map_or("", String::as_str);
                let unit = column_unit::candidate_in(&name, stated).unit;
                ListedSignal::new(name, unit, &range)
            })
            .collect();
        let group = ListedGroup { signals, ..ListedGroup::new(String::new(), clock) };
        let (span_s, samples) = (clock.span_s(), clock.samples());
        Self {
            groups: vec![group],
            kind: "table",
            span_s,
            samples,
            clock: column,
            notes,
            absent: Vec::new(),
            unread: Vec::new(),
        }
    }
}

impl ListedGroup {
    fn new(name: String, clock: &Clock) -> Self {
        let (rate_hz, jitter_s) = clock.rate_hz_and_jitter_s().unzip();
        Self {
            name,
            id: None,
            bus: None,
            is_known: true,
            samples: clock.samples(),
            rate_hz,
            jitter_s,
            stated_hz: None,
            stretch_of: None,
            bytes: None,
            signals: Vec::new(),
        }
    }
}

impl ListedSignal {
    fn new(name: String, unit: String, range: &Range) -> Self {
        let (min, max) = if range.samples > 0 { (range.min, range.max) } else { (f64::NAN, f64::NAN) };
        Self { name, unit, samples: range.samples, missing: range.missing, min, max }
    }
}

#[cfg(feature = "parquet")]
fn some(names: &[String]) -> String {
    const MOST: usize = 5;
    let more = names.len().saturating_sub(MOST);
    let listed =
        names.iter().take(MOST).map(|name| crate::log::shortened(name)).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{listed} and {more} more") } else { listed }
}

/// The column that is the clock, and seconds per its unit: `time_s`, or the first that is called like one, or a frame's index.
fn clock(names: &[String], units: &[String]) -> Option<(usize, f64)> {
    let own = names.iter().position(|name| name == "time_s").map(|place| (place, 1.0));
    let called = || column_unit::clocks(names).first().copied();
    let (place, factor) = own.or_else(called).or_else(|| Some((column_unit::index(names)?, 1.0)))?;
    Some((place, units.get(place).and_then(|unit| column_unit::seconds(unit)).unwrap_or(factor)))
}
