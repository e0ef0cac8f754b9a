//! A drive log in MCAP: the columns of `/signals`, a topic per wheel. Called by the writer of drive logs, and by that of results, which adds
//! topics of its own.

use std::io;
use std::path::{Path, PathBuf};

use itpms_files::AtomicFile;

use super::{McapWriter, RowTopics};
use crate::error::{DataError, FileProblem};
use crate::log::{LogColumns, LogRow};
use crate::out::cell::Cell;
use crate::out::drive_log::table_columns;

#[derive(Debug)]
pub(in crate::out) struct McapLog {
    target: PathBuf,
    writer: McapWriter<AtomicFile>,
    columns: LogColumns,
    signals: RowTopics,
    cells: Vec<Cell<'static>>,
}

impl McapLog {
    pub(in crate::out) fn create(path: &Path, columns: LogColumns) -> Result<Self, DataError> {
        let file = AtomicFile::create(path)?;
        let begun = McapWriter::new(file).and_then(|mut writer| {
            let signals = RowTopics::create(&mut writer, "/signals", &table_columns(&columns))?;
            Ok((writer, signals))
        });
        let (writer, signals) = begun.map_err(|error| DataError::new(path, FileProblem::Write(error)))?;
        Ok(Self { target: path.to_owned(), writer, columns, signals, cells: Vec::new() })
    }

    pub(in crate::out) fn set_start_ns(&mut self, start_ns: u64) {
        self.writer.set_start_ns(start_ns);
    }

    pub(in crate::out) fn write(&mut self, row: &LogRow) -> Result<(), DataError> {
        self.cells.clear();
        self.cells.extend(self.columns.slots().map(|slot| Cell::Number(row.value(slot))));
        let written = self.signals.write(&mut self.writer, row.time_s, &self.cells);
        written.map_err(|error| DataError::new(&self.target, FileProblem::Write(error)))
    }

    pub(super) fn add<T>(
        &mut self,
        add: impl FnOnce(&mut McapWriter<AtomicFile>) -> io::Result<T>,
    ) -> Result<T, DataError> {
        add(&mut self.writer).map_err(|error| DataError::new(&self.target, FileProblem::Write(error)))
    }

    pub(in crate::out) fn finish(self) -> Result<AtomicFile, DataError> {
        let finished = self.writer.finish();
        let mut file = finished.map_err(|error| DataError::new(&self.target, FileProblem::Write(error)))?;
        file.settle()?;
        Ok(file)
    }
}
