//! Rows from Parquet: columns of numbers and times of every type, read in batches, row group by row group.
//!
//! Called by the readers of drive logs and of roads, which choose the columns; knows of these no more than their names.
//!
//! | module | idea |
//! |---|---|
//! | `meaning` | from what is stored to numbers and seconds |
//! | `durations` | which integers are durations |
//! | `folder` | the part files of a folder, and the keys in the names of its folders |
//! | `parts` | a file, or a folder of part files, as one table |

mod durations;
mod folder;
mod meaning;
mod parts;

use std::collections::HashMap;
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};

use parquet::basic::Compression;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::error::{Place, Problem};
use crate::log::Selection;
pub(crate) use meaning::{Meaning, Quantity};
pub(crate) use parts::{ParquetParts, is_folder_of_parts};

/// Rows decoded at a time.
const BATCH: usize = 4096;

pub(crate) struct ParquetColumns {
    reader: SerializedFileReader<File>,
    /// Of all columns. A nested one has a dotted path and thereby no name of ours.
    names: Vec<String>,
    /// Of those that are durations, units per s.
    durations: HashMap<String, f64>,
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
    /// Whether some rows are asked for, or none at all.
    selects: bool,
    pub(crate) no_rows: bool,
}

impl std::fmt::Debug for ParquetColumns {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetColumns").field("rows", &self.rows).finish_non_exhaustive()
    }
}

struct Column {
    name: String,
    meaning: Meaning,
    /// Which rows are meant, by this column alone.
    selection: Option<Selection>,
    /// The definition level of a value that is there; below it is a null.
    present: i16,
    /// Index of the leaf in the schema.
    leaf: usize,
    reader: Option<ColumnReader>,
    /// The current batch, NaN where null.
    values: Vec<f64>,
    levels: Vec<i16>,
}

impl ParquetColumns {
    pub(crate) fn open(file: File) -> Result<Self, Problem> {
        let reader = guarded(|| SerializedFileReader::new(file).map_err(problem))?;
        let metadata = reader.metadata().file_metadata();
        let names = metadata.schema_descr().columns().iter().map(|leaf| named(leaf)).collect();
        let rows = u64::try_from(metadata.num_rows()).unwrap_or(0);
        let entries = metadata.key_value_metadata().into_iter().flatten();
        let schema =
            entries.filter(|entry| entry.key == durations::KEY).find_map(|entry| entry.value.as_deref());
        Ok(Self {
            names,
            durations: schema.map(durations::units_per_s).unwrap_or_default(),
            columns: Vec::new(),
            next_group: 0,
            left_in_group: 0,
            in_batch: 0,
            next_in_batch: 0,
            now: 0,
            rows_read: 0,
            rows,
            selects: false,
            no_rows: false,
            reader,
        })
    }

    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Meaning of a column. Errors: no numbers and no times.
    pub(crate) fn meaning(&self, leaf: usize) -> Result<Meaning, Problem> {
        self.meant(leaf, Meaning::of)
    }

    /// Meaning of a column that is given as the clock: numbers, times or text of times.
    pub(crate) fn clock_meaning(&self, leaf: usize) -> Result<Meaning, Problem> {
        self.meant(leaf, Meaning::of_clock)
    }

    fn meant(
        &self,
        leaf: usize,
        of: fn(&ColumnDescriptor, Option<f64>) -> Result<Meaning, String>,
    ) -> Result<Meaning, Problem> {
        let column = &self.names[leaf];
        let described = &self.reader.metadata().file_metadata().schema_descr().columns()[leaf];
        of(described, self.durations.get(column).copied())
            .map_err(|found| Problem::ColumnType { column: column.clone(), found })
    }

    /// Reads one more column, of numbers; to be given before the first row. Errors: it holds something else.
    pub(crate) fn choose(&mut self, leaf: usize) -> Result<(), Problem> {
        let meaning = self.meaning(leaf)?;
        if meaning.quantity == Quantity::Time {
            let (column, found) = (self.names[leaf].clone(), "times".to_owned());
            return Err(Problem::ColumnType { column, found });
        }
        self.take(leaf, meaning);
        Ok(())
    }

    /// The same for a column of numbers, times or text of times, which come in s. Errors: it holds none of them.
    pub(crate) fn choose_clock(&mut self, leaf: usize) -> Result<(), Problem> {
        let meaning = self.clock_meaning(leaf)?;
        self.take(leaf, meaning);
        Ok(())
    }

    /// Reads one more column, of one of these words a row: its place among them comes, and minus one for any other.
    /// Errors: it holds no text.
    pub(crate) fn choose_words(
        &mut self,
        leaf: usize,
        words: &'static [&'static str],
    ) -> Result<(), Problem> {
        let described = &self.reader.metadata().file_metadata().schema_descr().columns()[leaf];
        let meaning = Meaning::of_words(described, words).map_err(|found| {
            let (column, expected) = (&self.names[leaf], words.join(", "));
            Problem::Refused(format!("column {column} holds {found}, expected one of the words {expected}"))
        })?;
        self.take(leaf, meaning);
        Ok(())
    }

    /// Of the rows, only those that have this in a column of numbers or text. Errors: it holds something else.
    pub(crate) fn choose_rows(&mut self, leaf: usize, selection: &Selection) -> Result<(), Problem> {
        let described = &self.reader.metadata().file_metadata().schema_descr().columns()[leaf];
        let meaning = Meaning::of_words(described, &[]).or_else(|_| Meaning::of(described, None));
        let column = || self.names[leaf].clone();
        let meaning = meaning.map_err(|found| Problem::ColumnType { column: column(), found })?;
        self.take(leaf, meaning);
        self.selects = true;
        if let Some(column) = self.columns.last_mut() {
            column.selection = Some(selection.clone());
        }
        Ok(())
    }

    fn take(&mut self, leaf: usize, meaning: Meaning) {
        let present = self.reader.metadata().file_metadata().schema_descr().columns()[leaf].max_def_level();
        let name = self.names[leaf].clone();
        let (reader, values, levels) = Default::default();
        self.columns.push(Column { name, meaning, selection: None, present, leaf, reader, values, levels });
    }

    pub(crate) fn rows(&self) -> u64 {
        self.rows
    }

    /// Goes to the next row; `None` after the last.
    pub(crate) fn advance(&mut self) -> Result<Option<Place>, Problem> {
        loop {
            let place = self.step()?;
            let is_meant = |column: &Column| column.selection.is_none() || column.values[self.now] == 1.0;
            if !self.selects || place.is_none() || self.columns.iter().all(is_meant) {
                return Ok(place);
            }
        }
    }

    fn step(&mut self) -> Result<Option<Place>, Problem> {
        if self.no_rows {
            return Ok(None);
        }
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

    /// The row's values of the columns, in the order in which they were chosen; NaN where nothing finite is.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        self.columns.iter().map(|column| column.values[self.now])
    }

    pub(crate) fn value(&self, place: usize) -> f64 {
        self.columns[place].values[self.now]
    }

    fn open_next_group(&mut self) -> Result<bool, Problem> {
        if self.next_group == self.reader.num_row_groups() {
            return Ok(false);
        }
        let group = self.reader.get_row_group(self.next_group).map_err(problem)?;
        self.next_group += 1;
        self.left_in_group = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for column in &mut self.columns {
            if group.metadata().column(column.leaf).compression() == Compression::LZO {
                let why =
                    "it is compressed by LZO, expected zstd, snappy, gzip, brotli, lz4 or no compression";
                return Err(Problem::Parquet(why.to_owned()));
            }
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
                return Err(Problem::Parquet(on_one_line(&text)));
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
        let Self { reader, meaning, selection, present, values, levels, .. } = self;
        let is_meant =
            |bytes: &[u8]| selection.as_ref().map(|one| one.takes(&String::from_utf8_lossy(bytes)));
        let is_text = matches!(reader, Some(ColumnReader::ByteArrayColumnReader(_)));
        let mut into = Cells { present: *present, levels, values };
        match reader {
            Some(ColumnReader::BoolColumnReader(r)) => into.read(r, wanted, |v| f64::from(u8::from(*v))),
            Some(ColumnReader::Int32ColumnReader(r)) => into.read(r, wanted, |v| meaning.of_i32(*v)),
            Some(ColumnReader::Int64ColumnReader(r)) => into.read(r, wanted, |v| meaning.of_i64(*v)),
            Some(ColumnReader::Int96ColumnReader(r)) => {
                into.read(r, wanted, |v| meaning::seconds_of_int96(*v))
            }
            Some(ColumnReader::FloatColumnReader(r)) => into.read(r, wanted, |v| f64::from(*v)),
            Some(ColumnReader::DoubleColumnReader(r)) => into.read(r, wanted, |v| *v),
            Some(ColumnReader::ByteArrayColumnReader(r)) => {
                let of_text = |meant: bool| f64::from(u8::from(meant));
                into.read(r, wanted, |v| {
                    is_meant(v.data()).map_or_else(|| meaning.of_bytes(v.data()), of_text)
                })
            }
            Some(ColumnReader::FixedLenByteArrayColumnReader(r)) => {
                into.read(r, wanted, |v| meaning.of_bytes(v.data()))
            }
            None => Ok(()),
        }
        .map_err(problem)?;
        if let Some(selection) = selection.as_ref().filter(|_| !is_text) {
            values.iter_mut().for_each(|value| *value = f64::from(u8::from(selection.takes_number(*value))));
        }
        Ok(())
    }
}

struct Cells<'a> {
    present: i16,
    levels: &'a mut Vec<i16>,
    values: &'a mut Vec<f64>,
}

impl Cells<'_> {
    /// Decodes up to `wanted` records and puts NaN where a null was.
    fn read<T: DataType>(
        &mut self,
        reader: &mut ColumnReaderImpl<T>,
        wanted: usize,
        to_f64: impl Fn(&T::T) -> f64,
    ) -> Result<(), ParquetError> {
        let mut there = Vec::new();
        let (records, _, _) = reader.read_records(wanted, Some(self.levels), None, &mut there)?;
        let mut there = there.iter().map(to_f64).map(|v| if v.is_finite() { v } else { f64::NAN });
        if self.levels.is_empty() {
            // A required column has no definition levels: everything is there.
            self.values.extend(there);
        } else {
            let present = self.present;
            let cells = self.levels.iter().take(records);
            self.values.extend(
                cells.map(
                    |level| {
                        if *level == present { there.next().unwrap_or(f64::NAN) } else { f64::NAN }
                    },
                ),
            );
        }
        Ok(())
    }
}

/// The first rows of a file as text, with the names of their columns; `None` of a folder, or where that cannot be had.
pub(crate) fn first_rows(path: &std::path::Path, rows: usize) -> Option<(Vec<String>, Vec<Vec<String>>)> {
    let read = || -> Option<(Vec<String>, Vec<Vec<String>>)> {
        let reader = SerializedFileReader::new(File::open(path).ok()?).ok()?;
        let schema = reader.metadata().file_metadata().schema();
        let names = schema.get_fields().iter().map(|field| field.name().to_owned()).collect();
        let cell = |field: &parquet::record::Field| field.to_string().trim_matches('"').to_owned();
        let row = |row: parquet::record::Row| row.get_column_iter().map(|(_, field)| cell(field)).collect();
        let rows = reader.get_row_iter(None).ok()?.take(rows).map_while(Result::ok).map(row).collect();
        Some((names, rows))
    };
    catch_unwind(AssertUnwindSafe(read)).ok().flatten()
}

/// The library panics on some damaged files (a negative offset, a dictionary that is not there) instead of
/// returning an error. After an error nothing more is read, so no half-changed state is ever used.
fn guarded<T>(read: impl FnOnce() -> Result<T, Problem>) -> Result<T, Problem> {
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(Problem::Parquet("its contents contradict each other".to_owned())))
}

/// The name of a column: a list's own, else the path of a nested one.
fn named(leaf: &ColumnDescriptor) -> String {
    let parts = leaf.path().parts();
    match parts {
        [name, list, _] if leaf.max_rep_level() == 1 && list == "list" => name.clone(),
        _ => leaf.path().string(),
    }
}

/// A message that quotes the file: a name in it may hold a line break.
fn on_one_line(text: &str) -> String {
    text.replace(|c: char| c.is_control(), " ")
}

fn problem(error: ParquetError) -> Problem {
    match error {
        ParquetError::General(text) | ParquetError::EOF(text) if text.contains("encrypt") => {
            Problem::Parquet("it is encrypted, expected a file without".to_owned())
        }
        ParquetError::General(text) | ParquetError::EOF(text) => Problem::Parquet(on_one_line(&text)),
        other => Problem::Parquet(on_one_line(&other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_that_quotes_a_line_break_is_one_line() {
        let error = ParquetError::General("MAP cannot be applied to field 'a\0\nb'".to_owned());
        let Problem::Parquet(text) = problem(error) else { panic!("another problem") };
        assert_eq!(text, "MAP cannot be applied to field 'a  b'");
    }
}
