//! Where rows come from, whatever the format: names first, then values, row by row. Called by the reader alone.

#[cfg(feature = "parquet")]
use std::fs;
use std::fs::Metadata;
use std::path::Path;

use itpms_files::{FileProblem, input};

use super::csv_source::CsvSource;
use super::format::{Format, LogFormat};
use super::header::Header;
use super::memory_source::MemorySource;
use super::options::LogOptions;
#[cfg(feature = "parquet")]
use super::parquet_source::ParquetSource;
use super::row::RawRow;
#[cfg(any(feature = "can", feature = "mdf4"))]
use super::signal_source::SignalSource;
use crate::error::{DataError, Place, Problem};
use crate::signals::SignalMap;
use crate::signals::align::AlignmentReport;

/// An open drive log.
#[derive(Debug)]
pub(super) enum Source {
    Csv(CsvSource),
    Memory(MemorySource),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetSource>),
    #[cfg(any(feature = "can", feature = "mdf4"))]
    Signals(Box<SignalSource>),
}

/// What is under the name of a log, which may be a folder of part files.
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
                Self::table(format, path, options.any_map()?.as_ref())
            }
            #[cfg(feature = "mdf4")]
            LogFormat::Mdf4 => Ok(Source::Signals(Box::new(SignalSource::mdf4(path, options)?))),
            #[cfg(feature = "can")]
            LogFormat::Can => Ok(Source::Signals(Box::new(SignalSource::can(path, options)?))),
        }
    }

    fn table(format: Format, path: &Path, map: Option<&SignalMap>) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        match format {
            Format::Csv => {
                let (file, about) = input::open(path).map_err(fail)?;
                CsvSource::new(path, file, about.len(), map).map(Source::Csv)
            }
            #[cfg(feature = "parquet")]
            Format::Parquet => ParquetSource::new(path, map).map(|source| Source::Parquet(Box::new(source))),
        }
    }

    pub(super) fn header(&self) -> &Header {
        match self {
            Source::Csv(source) => source.header(),
            Source::Memory(source) => source.header(),
            #[cfg(feature = "parquet")]
            Source::Parquet(source) => source.header(),
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.header(),
        }
    }

    /// Fills `row` with the next row, NaN where missing; `None` at the end.
    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        match self {
            Source::Csv(source) => source.next_row(row),
            Source::Memory(source) => source.next_row(row),
            #[cfg(feature = "parquet")]
            Source::Parquet(source) => source.next_row(row),
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.next_row(row),
        }
    }

    /// When time 0 was, in ns since 1970; 0 where only the times themselves know.
    pub(super) fn start_ns(&self) -> u64 {
        match self {
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.start_ns(),
            _ => 0,
        }
    }

    /// Whether rows come in the order of their times.
    pub(super) fn is_in_order(&self) -> bool {
        match self {
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(_) => true,
            _ => false,
        }
    }

    /// Share of the file that has been read, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        match self {
            Source::Csv(source) => source.progress(),
            Source::Memory(source) => source.progress(),
            #[cfg(feature = "parquet")]
            Source::Parquet(source) => source.progress(),
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.progress(),
        }
    }

    /// Whether the last line was cut off and left out.
    pub(super) fn cut_off(&self) -> bool {
        match self {
            Source::Csv(source) => source.cut_off(),
            Source::Memory(_) => false,
            #[cfg(feature = "parquet")]
            Source::Parquet(_) => false,
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(_) => false,
        }
    }

    /// What the format's own reader mended, left out or assumed so far.
    pub(super) fn repairs(&self) -> Vec<String> {
        match self {
            Source::Csv(source) => source.repairs(),
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.repairs(),
            _ => Vec::new(),
        }
    }

    /// Which signal became which column; empty for tables with our names.
    pub(super) fn mapping(&self) -> &[String] {
        &self.header().mapping
    }

    /// How signals came into order and into rows, in words; nothing for tables.
    pub(super) fn remarks(&self) -> Vec<String> {
        match self {
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.remarks(),
            _ => Vec::new(),
        }
    }

    /// How signals were put into rows; `None` for tables.
    pub(super) fn alignment(&self) -> Option<AlignmentReport> {
        match self {
            #[cfg(any(feature = "can", feature = "mdf4"))]
            Source::Signals(source) => source.alignment(),
            _ => None,
        }
    }
}
