//! A table of named columns, row by row, in the format its file's extension asks for.
//!
//! Called by the writers beside it and by whoever has a table of results; does not know the columns' meaning.

use std::path::Path;

use itpms_files::AtomicFile;

use super::cell::{Cell, Kind};
use super::csv_table::CsvTable;
#[cfg(feature = "parquet")]
use super::parquet_table::ParquetTable;
use crate::error::DataError;
use crate::log::Format;

/// A table that goes to a file.
#[derive(Debug)]
pub struct Table(Open);

#[derive(Debug)]
enum Open {
    Csv(CsvTable),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetTable>),
}

impl Table {
    /// Starts the file and writes the header. A device or pipe without an extension receives CSV.
    /// Errors: the file cannot be created, or its extension is not known.
    pub fn create(path: &Path, columns: &[(String, Kind)]) -> Result<Self, DataError> {
        let format = Format::of(path);
        let file = AtomicFile::create(path)?;
        let format = match format {
            Err(_) if file.is_device() && path.extension().is_none() => Format::Csv,
            other => other?,
        };
        Ok(Self(match format {
            Format::Csv => Open::Csv(CsvTable::new(file, columns)?),
            #[cfg(feature = "parquet")]
            Format::Parquet => Open::Parquet(Box::new(ParquetTable::new(file, columns)?)),
        }))
    }

    /// Adds a row, its cells in the order of the columns.
    pub fn write(&mut self, cells: &[Cell<'_>]) -> Result<(), DataError> {
        match &mut self.0 {
            Open::Csv(table) => table.write(cells),
            #[cfg(feature = "parquet")]
            Open::Parquet(table) => table.write(cells),
        }
    }

    /// Everything onto the disk; the file still needs its name.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        match self.0 {
            Open::Csv(table) => table.finish(),
            #[cfg(feature = "parquet")]
            Open::Parquet(table) => table.finish(),
        }
    }
}
