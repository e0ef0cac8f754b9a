//! A log of any format, opened as rows. Called by the reader alone.

#[cfg(feature = "parquet")]
use std::fs;
use std::fs::Metadata;
use std::path::Path;

use itpms_files::{FileProblem, input};

use super::format::LogFormat;
use super::options::LogOptions;
use super::signal_source::SignalSource;
use super::source::Source;
use super::table::{self, Rows, TableSource};
use super::table_format::TableFormat;
use crate::error::DataError;

/// Metadata of a log, which may be a folder of part files.
fn look_at(path: &Path) -> Result<Metadata, FileProblem> {
    #[cfg(feature = "parquet")]
    if crate::parquet_columns::is_folder_of_parts(path) {
        return fs::metadata(path).map_err(input::refused);
    }
    input::look(path)
}

pub(super) fn open(path: &Path, options: &LogOptions) -> Result<Box<dyn Source>, DataError> {
    let fail = |problem| DataError::new(path, problem);
    // Whether it is there is reported before what its name says.
    let about = look_at(path).map_err(|problem| DataError::new(path, problem))?;
    if about.is_file() && about.len() == 0 {
        return Err(fail(LogFormat::of(path)?.without_bytes()));
    }
    Ok(match LogFormat::of_log(path, options.dbc.as_deref())? {
        LogFormat::Table(format) => {
            options.refuse_for_tables().map_err(fail)?;
            of_table(table::open(format, path, options)?)
        }
        #[cfg(feature = "mdf4")]
        LogFormat::Mdf4 => Box::new(SignalSource::mdf4(path, options)?),
        #[cfg(feature = "can")]
        LogFormat::Can => Box::new(SignalSource::can(path, options)?),
        #[cfg(feature = "mcap")]
        LogFormat::Mcap => Box::new(SignalSource::mcap(path, options)?),
    })
}

/// A table; one with a message in each row, or with sensors of several rates, holds signal after signal, as a bus does.
pub(super) fn of_table(table: Box<dyn TableFormat>) -> Box<dyn Source> {
    let table = Box::new(TableSource::new(table));
    if table.rows == Rows::Samples { table } else { Box::new(SignalSource::table(table)) }
}
