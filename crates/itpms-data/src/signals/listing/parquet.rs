//! The list of a Parquet file: every column of plain numbers is a signal, one is the clock.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::reader::RowIter;
use parquet::record::{Field, Row};

use super::Listing;
use super::statistics::{Clock, Range};
use crate::error::Problem;
use crate::input;

/// Rows between two looks around.
const ROWS_PER_STEP: usize = 1024;

pub(super) struct ParquetLister {
    rows: RowIter<'static>,
    count: u64,
    names: Vec<String>,
    ranges: Vec<Range>,
    time: Option<(usize, f64)>,
    clock: Clock,
}

impl std::fmt::Debug for ParquetLister {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetLister").field("names", &self.names).finish_non_exhaustive()
    }
}

impl ParquetLister {
    pub(super) fn open(path: &Path) -> Result<Self, Problem> {
        let (file, _) = input::open_regular(path, "Parquet")?;
        guarded(|| {
            let reader =
                SerializedFileReader::new(file).map_err(|error| Problem::Parquet(error.to_string()))?;
            let metadata = reader.metadata().file_metadata();
            let count = u64::try_from(metadata.num_rows()).unwrap_or(0);
            // Top-level fields, as rows have them.
            let names: Vec<String> =
                metadata.schema().get_fields().iter().map(|field| field.name().to_owned()).collect();
            let time = super::clock(&names);
            let ranges = vec![Range::default(); names.len()];
            let rows = RowIter::from_file_into(Box::new(reader));
            Ok(Self { rows, count, names, ranges, time, clock: Clock::default() })
        })
    }

    pub(super) fn step(&mut self) -> Result<bool, Problem> {
        for _ in 0..ROWS_PER_STEP {
            let row = guarded(|| {
                self.rows.next().transpose().map_err(|error| Problem::Parquet(error.to_string()))
            })?;
            let Some(row) = row else { return Ok(false) };
            self.add(&row);
        }
        Ok(true)
    }

    fn add(&mut self, row: &Row) {
        let mut time_s = f64::NAN;
        for (place, (_, field)) in row.get_column_iter().enumerate() {
            let value = number(field);
            if let Some(range) = self.ranges.get_mut(place) {
                range.add(value);
            }
            if let Some((_, seconds)) = self.time.filter(|(time, _)| *time == place) {
                time_s = clock(field).unwrap_or(value * seconds);
            }
        }
        self.clock.tick(time_s);
    }

    pub(super) fn progress(&self) -> f64 {
        self.clock.samples() as f64 / self.count.max(1) as f64
    }

    pub(super) fn finish(self) -> Listing {
        let clock = self.time.and_then(|(place, _)| self.names.get(place).cloned());
        let columns = self.names.into_iter().zip(self.ranges).enumerate();
        let columns = columns
            .filter(|(place, _)| self.time.is_none_or(|(time, _)| time != *place))
            .map(|(_, column)| column);
        Listing::of_one_table(columns.collect(), clock, &self.clock, "table", Vec::new())
    }
}

/// Seconds of a timestamp; what the library gives as integers is not among them.
fn clock(field: &Field) -> Option<f64> {
    match field {
        Field::TimestampMillis(value) => Some(*value as f64 * 1e-3),
        Field::TimestampMicros(value) => Some(*value as f64 * 1e-6),
        _ => None,
    }
}

/// NaN for what is no number or none at all.
fn number(field: &Field) -> f64 {
    let value = match field {
        Field::Double(value) => *value,
        Field::Float(value) => f64::from(*value),
        Field::Byte(value) => f64::from(*value),
        Field::Short(value) => f64::from(*value),
        Field::Int(value) => f64::from(*value),
        Field::Long(value) => *value as f64,
        Field::UByte(value) => f64::from(*value),
        Field::UShort(value) => f64::from(*value),
        Field::UInt(value) => f64::from(*value),
        Field::ULong(value) => *value as f64,
        _ => f64::NAN,
    };
    if value.is_finite() { value } else { f64::NAN }
}

/// As in the reader of drive logs: the library panics on some damaged files. After an error nothing more is read.
fn guarded<T>(read: impl FnOnce() -> Result<T, Problem>) -> Result<T, Problem> {
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(Problem::Parquet("its contents contradict each other".to_owned())))
}
