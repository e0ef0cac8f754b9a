//! A drive log out, in the columns the reader takes in. Called by the simulate command and by tests.

use std::path::Path;

use super::AtomicFile;
use super::table::{Cell, Kind, Table};
use crate::error::DataError;
use crate::log::{LogColumns, LogRow};

/// Writes the rows of a drive.
#[derive(Debug)]
pub struct LogWriter {
    table: Table,
    columns: LogColumns,
    cells: Vec<Cell>,
}

impl LogWriter {
    /// Starts the file with these columns.
    ///
    /// # Errors
    /// The file cannot be created, or its extension is not known.
    pub fn create(path: &Path, columns: LogColumns) -> Result<Self, DataError> {
        let names: Vec<_> = columns.slots().map(|slot| (slot.name(), Kind::Number)).collect();
        Ok(Self { table: Table::create(path, &names)?, columns, cells: Vec::new() })
    }

    /// Adds a row. What the columns do not ask for is left out, what the row lacks is missing.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, row: &LogRow) -> Result<(), DataError> {
        self.cells.clear();
        self.cells.extend(self.columns.slots().map(|slot| Cell::Number(row.value(slot))));
        self.table.write(&self.cells)
    }

    /// Everything onto the disk; [`AtomicFile::commit`] then gives the file its name.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        self.table.finish()
    }
}
