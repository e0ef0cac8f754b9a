//! A table, and whether its rows are samples of all sensors or messages of a bus, each of which fills its own columns and leaves the
//! others empty.

use std::collections::VecDeque;
use std::path::Path;

use itpms_files::input;

use super::csv_source::CsvSource;
use super::format::Format;
use super::header::Header;
use super::memory_source::MemorySource;
#[cfg(feature = "parquet")]
use super::parquet_source::ParquetSource;
use super::row::{RawRow, SLOTS, Slot};
use super::stamps::Fate;
use super::survey::SURVEY_ROWS;
use crate::error::{DataError, Place, Problem};
use crate::signals::{Reading, SignalMap};

/// Values that a column has among the first rows before it says what the rows are.
const ENOUGH_VALUES: u32 = 20;
/// Share of the rarer column's rows in which two columns of one message are at least filled together.
const TOGETHER: f64 = 0.05;

/// The formats of tables.
#[derive(Debug)]
pub(super) enum Table {
    Csv(CsvSource),
    Memory(MemorySource),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetSource>),
}

impl Table {
    pub(super) fn open(format: Format, path: &Path, map: Option<&SignalMap>) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        match format {
            Format::Csv => {
                let (file, about) = input::open(path).map_err(fail)?;
                CsvSource::new(path, file, about.len(), map).map(Table::Csv)
            }
            #[cfg(feature = "parquet")]
            Format::Parquet => ParquetSource::new(path, map).map(|source| Table::Parquet(Box::new(source))),
        }
    }

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        match self {
            Table::Csv(source) => source.next_row(row),
            Table::Memory(source) => source.next_row(row),
            #[cfg(feature = "parquet")]
            Table::Parquet(source) => source.next_row(row),
        }
    }
}

/// A table whose first rows have been looked at.
#[derive(Debug)]
pub(super) struct TableSource {
    table: Table,
    /// The rows that were looked at, and why there are no more.
    ahead: VecDeque<Result<(RawRow, Place), Problem>>,
    /// Messages that were left out.
    without_time: u64,
}

impl TableSource {
    pub(super) fn new(table: Table) -> Self {
        let mut source = Self { table, ahead: VecDeque::new(), without_time: 0 };
        let mut row = [f64::NAN; SLOTS];
        while source.ahead.len() < SURVEY_ROWS {
            match source.table.next_row(&mut row) {
                Ok(Some(place)) => source.ahead.push_back(Ok((row, place))),
                Ok(None) => break,
                Err(problem) => {
                    source.ahead.push_back(Err(problem));
                    break;
                }
            }
        }
        source
    }

    /// Whether each row is a message: two of its columns are hardly ever filled in the same row.
    pub(super) fn is_of_messages(&self) -> bool {
        let slots: Vec<usize> = Slot::all().filter(|slot| is_continuous(*slot)).map(Slot::index).collect();
        let mut together = [[0u32; SLOTS]; SLOTS];
        for (row, _) in self.ahead.iter().flatten() {
            let filled: Vec<usize> = slots.iter().copied().filter(|slot| row[*slot].is_finite()).collect();
            for &one in &filled {
                filled.iter().for_each(|&other| together[one][other] += 1);
            }
        }
        let with_values = || slots.iter().copied().filter(|slot| together[*slot][*slot] >= ENOUGH_VALUES);
        with_values().any(|one| {
            with_values().any(|other| {
                let rarer = together[one][one].min(together[other][other]);
                f64::from(together[one][other]) < TOGETHER * f64::from(rarer)
            })
        })
    }

    pub(super) fn header(&self) -> &Header {
        match &self.table {
            Table::Csv(source) => source.header(),
            Table::Memory(source) => source.header(),
            #[cfg(feature = "parquet")]
            Table::Parquet(source) => source.header(),
        }
    }

    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        match self.ahead.pop_front() {
            None => self.table.next_row(row),
            Some(looked_at) => {
                let (values, place) = looked_at?;
                *row = values;
                Ok(Some(place))
            }
        }
    }

    /// Hands out the values of a message as readings; false when there are no more.
    pub(super) fn step(&mut self, mut take: impl FnMut(Fate<Reading>)) -> Result<bool, Problem> {
        let mut row = [f64::NAN; SLOTS];
        if self.next_row(&mut row)?.is_none() {
            return Ok(false);
        }
        let time_s = row[Slot::Time.index()];
        if !time_s.is_finite() {
            self.without_time += 1;
            return Ok(true);
        }
        for slot in Slot::all().filter(|slot| *slot != Slot::Time) {
            let value = row[slot.index()];
            if value.is_finite() {
                take(Fate::Kept(Reading { time_s, slot, value }));
            }
        }
        Ok(true)
    }

    pub(super) fn progress(&self) -> f64 {
        match &self.table {
            Table::Csv(source) => source.progress(),
            Table::Memory(source) => source.progress(),
            #[cfg(feature = "parquet")]
            Table::Parquet(source) => source.progress(),
        }
    }

    /// Whether the last line was cut off and left out.
    pub(super) fn cut_off(&self) -> bool {
        matches!(&self.table, Table::Csv(source) if source.cut_off())
    }

    /// What the format's own reader mended or left out so far.
    pub(super) fn repairs(&self) -> Vec<String> {
        let of_format = match &self.table {
            Table::Csv(source) => source.repairs(),
            _ => Vec::new(),
        };
        let without_time = match self.without_time {
            0 => None,
            1 => Some("1 row without a time was left out".to_owned()),
            n => Some(format!("{n} rows without a time were left out")),
        };
        of_format.into_iter().chain(without_time).collect()
    }
}

/// Whether a column has a value with every sample of its sensor.
fn is_continuous(slot: Slot) -> bool {
    slot.is_acceleration() || slot.is_wheel_speed() || slot == Slot::Speed || matches!(slot, Slot::Motion(_))
}
