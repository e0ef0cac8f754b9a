//! Where rows come from, whatever the format: names first, then values, row by row. Called by the reader alone.

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
use super::table::{Rows, Table, TableSource};
use super::telling;
use crate::error::{DataError, Place, Problem};
use crate::signals::align::AlignmentReport;

#[derive(Debug)]
pub(super) enum Source {
    Table(Box<TableSource>),
    Signals(Box<SignalSource>),
}

/// Metadata of a log, which may be a folder of part files.
fn look_at(path: &Path) -> Result<Metadata, FileProblem> {
    #[cfg(feature = "parquet")]
    if crate::parquet_columns::is_folder_of_parts(path) {
        return fs::metadata(path).map_err(input::refused);
    }
    input::look(path)
}

impl Source {
    pub(super) fn open(path: &Path, options: &LogOptions) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        // Whether it is there is reported before what its name says.
        let about = look_at(path).map_err(|problem| DataError::new(path, problem))?;
        if about.is_file() && about.len() == 0 {
            return Err(fail(LogFormat::of(path)?.without_bytes()));
        }
        let format = LogFormat::of_log(path, options.dbc.as_deref())?;
        match format {
            LogFormat::Table(format) => {
                options.refuse_for_tables().map_err(fail)?;
                Table::open(format, path, options).map(Self::of_table)
            }
            #[cfg(feature = "mdf4")]
            LogFormat::Mdf4 => Ok(Source::Signals(Box::new(SignalSource::mdf4(path, options)?))),
            #[cfg(feature = "can")]
            LogFormat::Can => Ok(Source::Signals(Box::new(SignalSource::can(path, options)?))),
            #[cfg(feature = "mcap")]
            LogFormat::Mcap => Ok(Source::Signals(Box::new(SignalSource::mcap(path, options)?))),
        }
    }

    /// A table; one with a message in each row, or with sensors of several rates, holds signal after signal, as a bus does.
    pub(super) fn of_table(table: Table) -> Self {
        let table = Box::new(TableSource::new(table));
        if table.rows() != Rows::Samples {
            return Source::Signals(Box::new(SignalSource::table(table)));
        }
        Source::Table(table)
    }

    pub(super) fn header(&self) -> &Header {
        match self {
            Source::Table(source) => source.header(),
            Source::Signals(source) => source.header(),
        }
    }

    /// Fills `row` with the next row, NaN where missing; `None` at the end.
    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        match self {
            Source::Table(source) => source.next_row(row),
            Source::Signals(source) => source.next_row(row),
        }
    }

    /// When time 0 was, in ns since 1970; 0 where only the times themselves know.
    pub(super) fn start_ns(&self) -> u64 {
        match self {
            Source::Table(_) => 0,
            Source::Signals(source) => source.start_ns(),
        }
    }

    /// Whether rows come in the order of their times.
    pub(super) fn is_in_order(&self) -> bool {
        matches!(self, Source::Signals(_))
    }

    /// Share of the file that has been read, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        match self {
            Source::Table(source) => source.progress(),
            Source::Signals(source) => source.progress(),
        }
    }

    /// Whether the last line was cut off and left out.
    pub(super) fn cut_off(&self) -> bool {
        match self {
            Source::Table(source) => source.cut_off(),
            Source::Signals(source) => source.cut_off(),
        }
    }

    /// Repairs, omissions and assumptions of the format's own reader so far.
    pub(super) fn repairs(&self) -> Vec<String> {
        match self {
            Source::Table(source) => source.repairs(),
            Source::Signals(source) => source.repairs(),
        }
    }

    /// Which signal became which column; empty for tables with our names.
    pub(super) fn mapping(&self) -> &[String] {
        &self.header().mapping
    }

    /// How the clock and the rows of a table were understood, how signals came into order and into rows, in words.
    pub(super) fn remarks(&self) -> Vec<String> {
        match self {
            Source::Table(source) => source.remarks(),
            Source::Signals(source) => source.remarks(),
        }
    }

    /// The speed of a table, where it comes at a rate of its own; that of signals is in every row.
    pub(super) fn slow_speed(&self) -> SlowSpeed {
        match self {
            Source::Table(source) => source.slow_speed(),
            Source::Signals(_) => SlowSpeed::default(),
        }
    }

    /// Remedy where the rows are of two recordings.
    pub(super) fn one_of_two(&self, path: &Path) -> Option<String> {
        match self.overlap() {
            Some((one, other)) => Some(format!(
                "the parts {one} and {other} have rows of the same time: give one of the two, or a folder for each recording"
            )),
            None => self.table()?.format().and_then(|format| telling::way_out(path, format)),
        }
    }

    /// Two parts of a folder that have rows of the same time.
    pub(super) fn overlap(&self) -> Option<(String, String)> {
        self.table()?.overlap().cloned()
    }

    fn table(&self) -> Option<&TableSource> {
        match self {
            Source::Table(source) => Some(&**source),
            Source::Signals(source) => source.of_table(),
        }
    }

    /// How signals were put into rows; `None` for tables of samples.
    pub(super) fn alignment(&self) -> Option<AlignmentReport> {
        match self {
            Source::Table(_) => None,
            Source::Signals(source) => source.alignment(),
        }
    }
}
