//! Options of a reader of drive logs besides the file's name.

use std::path::PathBuf;

use super::selection::Selection;
use super::units::UnitCheck;
use crate::error::{DataError, Problem};
use crate::signals::SignalMap;

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LogOptions {
    /// Whether the unit of the accelerations is doubted.
    pub units: UnitCheck,
    pub dbc: Option<PathBuf>,
    /// Which signal, or column of a table, is which of our columns; `None`: the names tell.
    pub signals: Option<PathBuf>,
    /// Of a table, which rows.
    pub rows: Vec<Selection>,
}

impl LogOptions {
    pub(crate) fn any_map(&self) -> Result<Option<SignalMap>, DataError> {
        self.signals.as_deref().map(SignalMap::read).transpose()
    }

    /// The same for a log that has a clock of its own.
    #[cfg(any(feature = "can", feature = "mdf4"))]
    pub(crate) fn map(&self) -> Result<Option<SignalMap>, DataError> {
        let map = self.any_map()?;
        match &map {
            Some(map) if map.time().is_some() => Err(DataError::new(
                map.path(),
                "time_s is for tables: MDF4 and CAN logs have their own clock",
            )),
            _ => Ok(map),
        }
    }

    /// Options of tables alone.
    #[cfg(any(feature = "can", feature = "mdf4"))]
    pub(super) fn refuse_for_signals(&self) -> Result<(), Problem> {
        let what = "rows are selected of tables (--where); this log holds signals, each on its own clock";
        if self.rows.is_empty() { Ok(()) } else { Err(what.into()) }
    }

    /// Options of other logs alone.
    pub(super) fn refuse_for_tables(&self) -> Result<(), Problem> {
        let what = "a DBC file says what the frames of a CAN log mean; this is a table";
        self.dbc.as_ref().map_or(Ok(()), |_| Err(what.into()))
    }
}

impl From<UnitCheck> for LogOptions {
    fn from(units: UnitCheck) -> Self {
        Self { units, ..Self::default() }
    }
}
