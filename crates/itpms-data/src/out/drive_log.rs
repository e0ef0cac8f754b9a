//! A drive log out, in the columns the reader takes in: a table, MDF4, MCAP, or the frames of a bus. Called by the simulate and
//! convert commands and by tests.

use std::path::Path;

use itpms_files::AtomicFile;

use super::cell::{Cell, Kind};
#[cfg(feature = "can")]
use super::log_frames::LogFrames;
#[cfg(feature = "mcap")]
use super::mcap::McapLog;
use super::table::Table;
use crate::error::DataError;
#[cfg(feature = "mdf4")]
use crate::log::Slot;
use crate::log::{LogColumns, LogFormat, LogOptions, LogRow};
#[cfg(feature = "mdf4")]
use crate::mdf4::{ChannelSpec, Compression, GroupSpec, Mdf4Writer, SampleFormat};

#[derive(Debug)]
pub struct LogWriter {
    sink: Sink,
    columns: LogColumns,
}

#[derive(Debug)]
enum Sink {
    Table {
        table: Table,
        cells: Vec<Cell<'static>>,
    },
    #[cfg(feature = "can")]
    Frames(Box<LogFrames>),
    #[cfg(feature = "mdf4")]
    Channels {
        writer: Box<Mdf4Writer>,
        values: Vec<f64>,
    },
    #[cfg(feature = "mcap")]
    Messages(Box<McapLog>),
}

/// Whether a format that can be compressed is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Packing {
    #[default]
    Packed,
    /// For programs that cannot read it otherwise.
    Plain,
}

#[cfg(feature = "mdf4")]
impl From<Packing> for Compression {
    fn from(packing: Packing) -> Self {
        match packing {
            Packing::Packed => Compression::Transposed,
            Packing::Plain => Compression::None,
        }
    }
}

impl LogWriter {
    /// Starts the file with these columns, in the format that its extension asks for.
    /// Errors: the file cannot be created, or its extension is not known; a CAN log needs [`LogWriter::create_with`].
    pub fn create(path: &Path, columns: LogColumns) -> Result<Self, DataError> {
        Self::create_with(path, columns, &LogOptions::default(), Packing::default())
    }

    /// The same for a CAN log, too: the DBC file and the map say which signals carry the columns.
    #[cfg_attr(
        not(all(feature = "can", feature = "mdf4")),
        allow(unused_variables, reason = "tables take no start")
    )]
    pub fn create_with(
        path: &Path,
        columns: LogColumns,
        options: &LogOptions,
        packing: Packing,
    ) -> Result<Self, DataError> {
        let sink = match LogFormat::of_output(path)? {
            #[cfg(feature = "mcap")]
            LogFormat::Mcap => Sink::Messages(Box::new(McapLog::create(path, columns)?)),
            #[cfg(feature = "can")]
            LogFormat::Can => Sink::Frames(Box::new(LogFrames::create(path, &columns, options)?)),
            #[cfg(feature = "mdf4")]
            LogFormat::Mdf4 => {
                Sink::Channels { writer: Box::new(channels(path, &columns, packing)?), values: Vec::new() }
            }
            LogFormat::Table(_) => {
                Sink::Table { table: Table::create(path, &table_columns(&columns))?, cells: Vec::new() }
            }
        };
        Ok(Self { sink, columns })
    }

    /// Says when time 0 was, in ns since 1970, before the first row; for MCAP, whose messages have a date.
    #[cfg_attr(not(feature = "mcap"), allow(unused_variables, reason = "no other file has a date"))]
    pub fn set_start_ns(&mut self, start_ns: u64) {
        #[cfg(feature = "mcap")]
        if let Sink::Messages(log) = &mut self.sink {
            log.set_start_ns(start_ns);
        }
    }

    /// Adds a row. Values without a column are left out, columns without a value are empty.
    pub fn write(&mut self, row: &LogRow) -> Result<(), DataError> {
        match &mut self.sink {
            Sink::Table { table, cells } => {
                cells.clear();
                cells.extend(self.columns.slots().map(|slot| Cell::Number(row.value(slot))));
                table.write(cells)
            }
            #[cfg(feature = "can")]
            Sink::Frames(frames) => frames.write(row),
            #[cfg(feature = "mdf4")]
            Sink::Channels { writer, values } => {
                values.clear();
                values.extend(measured(&self.columns).map(|slot| row.value(slot)));
                Ok(writer.write(0, row.time_s, values)?)
            }
            #[cfg(feature = "mcap")]
            Sink::Messages(log) => log.write(row),
        }
    }

    /// Parts of the rows that were not written so far, a sentence each.
    pub fn losses(&self) -> Vec<String> {
        match &self.sink {
            #[cfg(feature = "can")]
            Sink::Frames(frames) => frames.losses(),
            _ => Vec::new(),
        }
    }

    /// Everything onto the disk; [`AtomicFile::commit`] then gives the file its name.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        match self.sink {
            Sink::Table { table, .. } => table.finish(),
            #[cfg(feature = "can")]
            Sink::Frames(frames) => frames.finish(),
            #[cfg(feature = "mdf4")]
            Sink::Channels { writer, .. } => Ok(writer.finish()?),
            #[cfg(feature = "mcap")]
            Sink::Messages(log) => log.finish(),
        }
    }
}

/// The columns of a drive log as those of a table.
pub(super) fn table_columns(columns: &LogColumns) -> Vec<(String, Kind)> {
    columns.slots().map(|slot| (slot.name(), Kind::Number)).collect()
}

#[cfg(feature = "mdf4")]
fn measured(columns: &LogColumns) -> impl Iterator<Item = Slot> {
    columns.slots().filter(|slot| *slot != Slot::Time)
}

/// An MDF4 file with one channel group.
#[cfg(feature = "mdf4")]
fn channels(path: &Path, columns: &LogColumns, packing: Packing) -> Result<Mdf4Writer, DataError> {
    let channel = |slot: Slot| ChannelSpec::new(&slot.name(), slot.unit(), SampleFormat::Float64);
    let channels = measured(columns).map(channel).collect();
    let group = GroupSpec { name: "drive".to_owned(), comment: String::new(), channels };
    Ok(Mdf4Writer::create(path, &[group], packing.into())?)
}
