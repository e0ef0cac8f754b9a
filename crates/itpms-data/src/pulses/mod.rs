//! Tooth pulses as a table of their own, `time_s,wheel`: when an edge of a wheel's speed sensor passed. CSV or Parquet, in and out.
//!
//! Called by whoever runs torsional analysis, or simulates it. A stream: the rows of the four wheels lie among each other in the order of
//! time, to within [`REACH_S`]; memory does not grow with the drive. Knows nothing of the use of the edges.
//!
//! ```text
//! time_s,wheel
//! 0.001234,fl
//! 0.001301,rr
//! ```
//!
//! | module | idea |
//! |---|---|
//! | `problem` | what can be wrong with such a table |
//! | `source` | rows from text and from Parquet |

mod source;

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::path::{Path, PathBuf};

use itpms_core::model::Corner;

use self::source::Source;
use crate::error::{DataError, Place, Problem};
use crate::out::{AtomicFile, Cell, Kind, Table};

/// Rows may lie before others of up to so much later, in s.
pub const REACH_S: f64 = 10.0;
/// Rows that wait for earlier ones, at most: four wheels at 200 km/h have some 100 000 in [`REACH_S`].
const MOST_WAITING: usize = 1 << 18;

/// An edge of a tooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    /// When it passed, in s, by the clock of the drive's log.
    pub time_s: f64,
    pub wheel: Corner,
}

/// A row that waits. In the order of time, then of wheels.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Waiting {
    time_s: f64,
    wheel: usize,
}

impl Eq for Waiting {}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.time_s.total_cmp(&other.time_s).then(self.wheel.cmp(&other.wheel))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Reads a table of pulses in the order of time.
#[derive(Debug)]
pub struct PulseReader {
    path: PathBuf,
    source: Source,
    waiting: BinaryHeap<Reverse<Waiting>>,
    /// The latest time that was read, with its row, and the last pulse that was handed out.
    newest: (f64, Option<Place>),
    last: Option<Waiting>,
    ended: bool,
    moved: u64,
    twice: u64,
    without_time: u64,
}

impl PulseReader {
    /// Opens a table, by its extension. Errors: it cannot be read, or has no column `time_s` or `wheel`.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        let source = Source::open(path)?;
        Ok(Self {
            path: path.to_owned(),
            source,
            waiting: BinaryHeap::new(),
            newest: (f64::NEG_INFINITY, None),
            last: None,
            ended: false,
            moved: 0,
            twice: 0,
            without_time: 0,
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next pulse; `None` after the last. Errors: a row that is none, or one that lies further back than rows may.
    pub fn next_pulse(&mut self) -> Result<Option<Pulse>, DataError> {
        self.next_until(f64::INFINITY)
    }

    /// The next pulse if it passed by then, in s.
    pub fn next_until(&mut self, time_s: f64) -> Result<Option<Pulse>, DataError> {
        loop {
            self.read_ahead().map_err(|problem| DataError::new(&self.path, problem))?;
            let Some(Reverse(next)) = self.waiting.peek().copied() else { return Ok(None) };
            if !(next.time_s <= time_s) {
                return Ok(None);
            }
            self.waiting.pop();
            if self.last == Some(next) {
                self.twice += 1;
                continue;
            }
            self.last = Some(next);
            if let Some(wheel) = Corner::ALL.get(next.wheel) {
                return Ok(Some(Pulse { time_s: next.time_s, wheel: *wheel }));
            }
        }
    }

    pub fn repairs(&self) -> Vec<String> {
        let counted = |count: u64, what: &str| (count > 0).then(|| format!("{count} {what}"));
        [
            counted(self.moved, "pulses were put into the order of time"),
            counted(self.twice, "pulses came twice and were left out"),
            counted(self.without_time, "rows without a time were left out"),
            self.source.cut_off().then(|| "the last line is cut off and was left out".to_owned()),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Reads until no row that is still to come can lie before the first one that waits.
    fn read_ahead(&mut self) -> Result<(), Problem> {
        let settled = |first: &Reverse<Waiting>, newest_s: f64| first.0.time_s < newest_s - REACH_S;
        while !self.ended {
            let first = self.waiting.peek();
            if first.is_some_and(|first| settled(first, self.newest.0)) || self.waiting.len() >= MOST_WAITING
            {
                return Ok(());
            }
            match self.source.next_row()? {
                None => self.ended = true,
                Some((_, time_s, _)) if !time_s.is_finite() => self.without_time += 1,
                Some((place, time_s, wheel)) => self.take(place, Waiting { time_s, wheel })?,
            }
        }
        Ok(())
    }

    fn take(&mut self, place: Place, row: Waiting) -> Result<(), Problem> {
        let (newest_s, newest_place) = self.newest;
        if row.time_s < newest_s {
            if self.last.is_some_and(|last| row.time_s < last.time_s) || row.time_s < newest_s - REACH_S {
                let after = newest_place.unwrap_or(place);
                return Err(format!(
                    "{place}, column time_s: found {} s after the {newest_s} s of {after}, expected the pulses of all wheels in the order of \
                     time (sort the table by time_s, or cut it where the clock was set)",
                    row.time_s
                )
                .into());
            }
            self.moved += 1;
        } else {
            self.newest = (row.time_s, Some(place));
        }
        self.waiting.push(Reverse(row));
        Ok(())
    }
}

#[derive(Debug)]
pub struct PulseWriter(Table);

impl PulseWriter {
    /// Starts the file, in the format that its extension asks for. Errors: the file cannot be created, or its extension is not known.
    pub fn create(path: &Path) -> Result<Self, DataError> {
        let columns = [("time_s".to_owned(), Kind::Number), ("wheel".to_owned(), Kind::Label)];
        Ok(Self(Table::create(path, &columns)?))
    }

    /// Adds a pulse, its time to a nanosecond.
    pub fn write(&mut self, pulse: &Pulse) -> Result<(), DataError> {
        let time_s = (pulse.time_s * 1e9).round() / 1e9;
        self.0.write(&[Cell::Number(time_s), Cell::Label(pulse.wheel.label())])
    }

    /// Everything onto the disk; the file still needs its name.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        self.0.finish()
    }
}
