//! What a reader of drive logs is told besides the file's name.

use std::path::PathBuf;

use super::units::UnitCheck;
#[cfg(any(feature = "can", feature = "mdf4"))]
use crate::error::{DataError, Problem};
#[cfg(any(feature = "can", feature = "mdf4"))]
use crate::signals::SignalMap;

/// Why a table, whose columns carry our names already, takes no signal map.
pub(crate) const NO_MAP: &str =
    "a signal map is for MDF4 and CAN logs; the columns of a table need our names";

/// How to read a drive log.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LogOptions {
    /// Whether the unit of the accelerations is doubted.
    pub units: UnitCheck,
    /// What the frames of a CAN log mean.
    pub dbc: Option<PathBuf>,
    /// Which signal of an MDF4 or CAN log is which column; `None`: the names tell.
    pub signals: Option<PathBuf>,
}

impl LogOptions {
    /// The map, if there is one.
    #[cfg(any(feature = "can", feature = "mdf4"))]
    pub(crate) fn map(&self) -> Result<Option<SignalMap>, DataError> {
        self.signals.as_deref().map(SignalMap::read).transpose()
    }

    /// What only other logs have.
    pub(super) fn refuse_for_tables(&self) -> Result<(), Problem> {
        let what = match (&self.dbc, &self.signals) {
            (Some(_), _) => "a DBC file says what the frames of a CAN log mean; this is a table",
            (None, Some(_)) => NO_MAP,
            (None, None) => return Ok(()),
        };
        Err(Problem::NotApplicable(what))
    }
}

impl From<UnitCheck> for LogOptions {
    fn from(units: UnitCheck) -> Self {
        Self { units, ..Self::default() }
    }
}
