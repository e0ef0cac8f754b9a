//! Rows from Parquet: plain numeric columns of any width, read in batches, row group by row group.
//!
//! Called by the readers of drive logs and of roads, which choose the columns; knows of these no more than their names.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};

use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::error::{Place, Problem};

/// Rows decoded at a time.
const BATCH: usize = 4096;

/// A file of columns.
pub(crate) struct ParquetColumns {
    reader: SerializedFileReader<File>,
    /// Of all columns. A nested one has a dotted path and thereby no name of ours.
    names: Vec<String>,
    /// Those that were chosen.
    columns: Vec<Column>,
    next_group: usize,
    /// Rows of the current row group that are not decoded yet.
    left_in_group: usize,
    /// Rows of the current batch, the next of them, and the one that is read now.
    in_batch: usize,
    next_in_batch: usize,
    now: usize,
    rows_read: u64,
    rows: u64,
}

impl std::fmt::Debug for ParquetColumns {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetColumns").field("rows", &self.rows).finish_non_exhaustive()
    }
}

struct Column {
    name: String,
    /// Index of the leaf in the schema.
    leaf: usize,
    /// The reader of the current row group.
    reader: Option<ColumnReader>,
    /// The current batch, NaN where null.
    values: Vec<f64>,
    levels: Vec<i16>,
}

impl ParquetColumns {
    pub(crate) fn open(file: File) -> Result<Self, Problem> {
        let reader = guarded(|| SerializedFileReader::new(file).map_err(problem))?;
        let metadata = reader.metadata().file_metadata();
        let names = metadata.schema_descr().columns().iter().map(|leaf| leaf.path().string()).collect();
        let rows = u64::try_from(metadata.num_rows()).unwrap_or(0);
        Ok(Self {
            names,
            columns: Vec::new(),
            next_group: 0,
            left_in_group: 0,
            in_batch: 0,
            next_in_batch: 0,
            now: 0,
            rows_read: 0,
            rows,
            reader,
        })
    }

    /// The names of all columns.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Reads one more column; to be said before the first row.
    pub(crate) fn choose(&mut self, leaf: usize) -> Result<(), Problem> {
        let name = self.names[leaf].clone();
        let metadata = self.reader.metadata().file_metadata();
        check_type(&name, &metadata.schema_descr().columns()[leaf])?;
        self.columns.push(Column { name, leaf, reader: None, values: Vec::new(), levels: Vec::new() });
        Ok(())
    }

    /// Seconds per unit of a column of timestamps, if it is one.
    pub(crate) fn clock_s(&self, leaf: usize) -> Option<f64> {
        let column = &self.reader.metadata().file_metadata().schema_descr().columns()[leaf];
        let flat = column.max_rep_level() == 0 && column.max_def_level() <= 1;
        let seconds = match (column.logical_type_ref(), column.converted_type()) {
            (Some(LogicalType::Timestamp(time)), _) => match time.unit {
                TimeUnit::MILLIS => 1e-3,
                TimeUnit::MICROS => 1e-6,
                TimeUnit::NANOS => 1e-9,
            },
            (None, ConvertedType::TIMESTAMP_MILLIS) => 1e-3,
            (None, ConvertedType::TIMESTAMP_MICROS) => 1e-6,
            _ => return None,
        };
        (flat && column.physical_type() == PhysicalType::INT64).then_some(seconds)
    }

    /// Reads one more column, which [`ParquetColumns::clock_s`] knows, as its integers.
    pub(crate) fn choose_clock(&mut self, leaf: usize) {
        let name = self.names[leaf].clone();
        self.columns.push(Column { name, leaf, reader: None, values: Vec::new(), levels: Vec::new() });
    }

    /// Share of the file that has been read, 0 to 1.
    pub(crate) fn progress(&self) -> f64 {
        (self.rows_read as f64 / self.rows.max(1) as f64).min(1.0)
    }

    /// Goes to the next row; `None` after the last.
    pub(crate) fn advance(&mut self) -> Result<Option<Place>, Problem> {
        while self.next_in_batch == self.in_batch {
            if self.left_in_group == 0 && !guarded(|| self.open_next_group())? {
                return Ok(None);
            }
            guarded(|| self.read_batch())?;
        }
        self.now = self.next_in_batch;
        self.next_in_batch += 1;
        self.rows_read += 1;
        Ok(Some(Place::Row(self.rows_read)))
    }

    /// What the row has in the columns, in the order in which they were chosen; NaN where nothing finite is.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        self.columns.iter().map(|column| column.values[self.now])
    }

    fn open_next_group(&mut self) -> Result<bool, Problem> {
        if self.next_group == self.reader.num_row_groups() {
            return Ok(false);
        }
        let group = self.reader.get_row_group(self.next_group).map_err(problem)?;
        self.next_group += 1;
        self.left_in_group = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for column in &mut self.columns {
            column.reader = Some(group.get_column_reader(column.leaf).map_err(problem)?);
        }
        Ok(true)
    }

    fn read_batch(&mut self) -> Result<(), Problem> {
        let wanted = self.left_in_group.min(BATCH);
        for column in &mut self.columns {
            column.read(wanted)?;
            if column.values.len() != wanted {
                let (name, found) = (&column.name, column.values.len());
                let text = format!("column {name} ends after {found} of {wanted} rows of a batch");
                return Err(Problem::Parquet(text));
            }
        }
        self.left_in_group -= wanted;
        (self.in_batch, self.next_in_batch) = (wanted, 0);
        Ok(())
    }
}

impl Column {
    /// Replaces `values` by the next `wanted` ones.
    fn read(&mut self, wanted: usize) -> Result<(), Problem> {
        self.values.clear();
        self.levels.clear();
        let (values, levels) = (&mut self.values, &mut self.levels);
        match &mut self.reader {
            Some(ColumnReader::Int32ColumnReader(r)) => read(r, wanted, levels, values, f64::from),
            Some(ColumnReader::Int64ColumnReader(r)) => read(r, wanted, levels, values, |v| v as f64),
            Some(ColumnReader::FloatColumnReader(r)) => read(r, wanted, levels, values, f64::from),
            Some(ColumnReader::DoubleColumnReader(r)) => read(r, wanted, levels, values, |v| v),
            // Other types were refused with the header.
            _ => Ok(()),
        }
        .map_err(problem)
    }
}

/// Decodes up to `wanted` records and puts NaN where a null was.
fn read<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    wanted: usize,
    levels: &mut Vec<i16>,
    values: &mut Vec<f64>,
    to_f64: impl Fn(T::T) -> f64,
) -> Result<(), ParquetError> {
    let mut present = Vec::new();
    let (records, _, _) = reader.read_records(wanted, Some(levels), None, &mut present)?;
    let mut present = present.into_iter().map(to_f64).map(|v| if v.is_finite() { v } else { f64::NAN });
    if levels.is_empty() {
        // A required column has no definition levels: everything is there.
        values.extend(present);
    } else {
        // Level 1: a value; level 0: a null.
        let cells = levels.iter().take(records);
        values.extend(
            cells.map(|level| if *level == 1 { present.next().unwrap_or(f64::NAN) } else { f64::NAN }),
        );
    }
    Ok(())
}

/// Numbers only: no text, no timestamps and decimals, whose integers mean something else than they say.
fn check_type(name: &str, leaf: &ColumnDescriptor) -> Result<(), Problem> {
    let physical = leaf.physical_type();
    let number = matches!(
        physical,
        PhysicalType::INT32 | PhysicalType::INT64 | PhysicalType::FLOAT | PhysicalType::DOUBLE
    );
    let plain = match leaf.logical_type_ref() {
        Some(logical) => matches!(logical, LogicalType::Integer(_)),
        // Files of older writers say it in the older way.
        None => !matches!(
            leaf.converted_type(),
            ConvertedType::DECIMAL
                | ConvertedType::DATE
                | ConvertedType::TIME_MILLIS
                | ConvertedType::TIME_MICROS
                | ConvertedType::TIMESTAMP_MILLIS
                | ConvertedType::TIMESTAMP_MICROS
        ),
    };
    let flat = leaf.max_rep_level() == 0 && leaf.max_def_level() <= 1;
    if number && plain && flat {
        return Ok(());
    }
    let found = match (flat, leaf.logical_type_ref()) {
        (false, _) => "nested values".to_owned(),
        (true, Some(logical)) => format!("{logical:?}"),
        (true, None) => format!("{physical} ({})", leaf.converted_type()),
    };
    Err(Problem::ColumnType { column: name.to_owned(), found })
}

/// The library panics on some damaged files (a negative offset, a dictionary that is not there) instead of
/// returning an error. After an error nothing more is read, so no half-changed state is ever used.
fn guarded<T>(read: impl FnOnce() -> Result<T, Problem>) -> Result<T, Problem> {
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(Problem::Parquet("its contents contradict each other".to_owned())))
}

fn problem(error: ParquetError) -> Problem {
    match error {
        ParquetError::General(text) | ParquetError::EOF(text) => Problem::Parquet(text),
        other => Problem::Parquet(other.to_string()),
    }
}
