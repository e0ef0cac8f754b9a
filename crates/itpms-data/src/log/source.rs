//! Where rows come from, whatever the format: names first, then values, row by row. Called by the reader alone.

use std::fmt::Debug;
#[cfg(feature = "parquet")]
use std::fs;
use std::fs::Metadata;
use std::path::Path;

use itpms_files::{FileProblem, input};

use super::format::LogFormat;
use super::header::Header;
use super::options::LogOptions;
use super::signal_source::SignalSource;
use super::slot::RawRow;
use super::slow_speed::SlowSpeed;
use super::table::{self, Rows, TableFormat, TableSource};
use super::telling;
use crate::error::{DataError, Place, Problem};
use crate::signals::align::AlignmentReport;

/// A log as rows.
pub(super) trait Source: Debug + Send {
    fn header(&self) -> &Header;

    /// Fills `row` with the next row, NaN where missing; `None` at the end.
    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem>;

    /// Share of the file that has been read, 0 to 1.
    fn progress(&self) -> f64;

    /// Repairs, omissions and assumptions of the format's own reader so far.
    fn repairs(&self) -> Vec<String>;

    /// How the clock and the rows of a table were understood, how signals came into order and into rows, in words.
    fn remarks(&self) -> Vec<String>;

    /// The table that the rows come from.
    fn table(&self) -> Option<&TableSource>;

    /// When time 0 was, in ns since 1970; 0 where only the times themselves know.
    fn start_ns(&self) -> u64 {
        0
    }

    /// Whether rows come in the order of their times.
    fn is_in_order(&self) -> bool {
        false
    }

    /// The speed of a table, where it comes at a rate of its own; that of signals is in every row.
    fn slow_speed(&self) -> SlowSpeed {
        SlowSpeed::default()
    }

    /// How signals were put into rows; `None` for tables of samples.
    fn alignment(&self) -> Option<AlignmentReport> {
        None
    }

    /// Remedy where the rows are of two recordings.
    fn one_of_two(&self, path: &Path) -> Option<String> {
        let table = self.table()?;
        match table.overlap() {
            Some((one, other)) => Some(format!(
                "the parts {one} and {other} have rows of the same time: give one of the two, or a folder for each recording"
            )),
            None => table.format().and_then(|format| telling::way_out(path, format)),
        }
    }
}

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
