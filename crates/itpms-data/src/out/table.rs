//! A table of named columns, row by row, in the format its file's extension asks for.
//!
//! Called by the three writers beside it; knows nothing of what the columns mean.

use std::path::Path;

use super::AtomicFile;
use super::csv_table::CsvTable;
#[cfg(feature = "parquet")]
use super::parquet_table::ParquetTable;
use crate::error::DataError;
use crate::log::Format;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    Flag,
    Label,
}

/// One value. A number that is NaN is written as missing: an empty cell, a null.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cell {
    Number(f64),
    Flag(bool),
    Label(&'static str),
}

/// A table that goes to a file.
#[derive(Debug)]
pub(super) enum Table {
    Csv(CsvTable),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetTable>),
}

impl Table {
    /// Starts the file and writes the header. A device or pipe without an extension receives CSV.
    pub(super) fn create(path: &Path, columns: &[(String, Kind)]) -> Result<Self, DataError> {
        let format = Format::of(path);
        let file = AtomicFile::create(path)?;
        let format = match format {
            Err(_) if file.is_device() && path.extension().is_none() => Format::Csv,
            other => other?,
        };
        Ok(match format {
            Format::Csv => Table::Csv(CsvTable::new(file, columns)?),
            #[cfg(feature = "parquet")]
            Format::Parquet => Table::Parquet(Box::new(ParquetTable::new(file, columns)?)),
        })
    }

    /// Adds a row, its cells in the order of the columns.
    pub(super) fn write(&mut self, cells: &[Cell]) -> Result<(), DataError> {
        match self {
            Table::Csv(table) => table.write(cells),
            #[cfg(feature = "parquet")]
            Table::Parquet(table) => table.write(cells),
        }
    }

    /// Everything onto the disk; the file still needs its name.
    pub(super) fn finish(self) -> Result<AtomicFile, DataError> {
        match self {
            Table::Csv(table) => table.finish(),
            #[cfg(feature = "parquet")]
            Table::Parquet(table) => table.finish(),
        }
    }
}
