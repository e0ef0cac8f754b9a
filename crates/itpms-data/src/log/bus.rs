//! Logs that hold frames: which ones they are, and what says what their frames mean.
//!
//! Called by everybody who opens such a log.

use std::path::Path;

use super::format::LogFormat;
#[cfg(feature = "mdf4")]
use crate::can::CanProblem;
use crate::dbc::Dbc;
use crate::error::DataError;

/// Whether a log holds frames of a bus and is read by their description: a CAN log, or an MDF4 file with frames and no other signals. One that has
/// both is read by its frames where a description is given. Errors: the extension is unknown, or an MDF4 file cannot be read.
pub fn holds_frames(log: &Path, dbc: Option<&Path>) -> Result<bool, DataError> {
    Ok(LogFormat::of_log(log, dbc)? == LogFormat::Can)
}

/// The database of a log's frames: the DBC file that is given, else the one that is attached inside the log.
/// Errors: there is none, or it cannot be read.
pub fn frame_description(log: &Path, dbc: Option<&Path>) -> Result<Dbc, DataError> {
    let attached = || {
        attached(log)?.ok_or_else(|| {
            let what =
                "is a CAN log, whose frames mean nothing by themselves; expected a DBC file (--dbc car.dbc)";
            DataError::new(log, what)
        })
    };
    dbc.map_or_else(attached, crate::dbc::described)
}

/// The description that is attached inside a log, if there is one. Errors: it is damaged, or no description.
#[cfg(feature = "mdf4")]
pub(crate) fn attached(log: &Path) -> Result<Option<Dbc>, DataError> {
    if LogFormat::of(log)? != LogFormat::Mdf4 {
        return Ok(None);
    }
    let reader = crate::mdf4::Mdf4Reader::open(log)?;
    let is_description = |name: &str| name.to_lowercase().ends_with(".dbc");
    match reader.attachment(is_description, crate::dbc::LARGEST)? {
        Some((_, bytes)) => {
            Dbc::from_bytes(&bytes).map(Some).map_err(|error| DataError::new(log, CanProblem::Dbc(error)))
        }
        None => Ok(None),
    }
}

#[cfg(not(feature = "mdf4"))]
pub(crate) fn attached(_: &Path) -> Result<Option<Dbc>, DataError> {
    Ok(None)
}
