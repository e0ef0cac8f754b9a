//! Why a command ends before its time, and the exit code that says so to a script.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | complete |
//! | 1 | complete, and a goal was missed (`--strict` of a study) |
//! | 2 | an input, an option or an output is unusable; the message says which and why |
//! | 130 | interrupted; nothing was left behind |

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use itpms_data::crg::CrgError;
use itpms_data::error::FileError;
use itpms_data::log::Slot;
use itpms_data::{DataError, Problem};
use itpms_drive::DriveError;
use itpms_sim::error::ScenarioError;
use thiserror::Error;

/// The end of a command that did not complete.
#[derive(Debug, Error)]
pub enum Failure {
    #[error("{error}{hint}", error = .0, hint = remedy(.0))]
    Data(#[from] DataError),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error("{}: cannot be written: {}", .0.display(), .1)]
    Directory(PathBuf, io::Error),
    #[error("{0}")]
    Usage(String),
    #[error("the report cannot be made: {0}")]
    Report(io::Error),
    #[error("{0}")]
    Missed(String),
    #[error("interrupted, nothing was written")]
    Interrupted,
    #[error("interrupted; what is finished is kept, the same command goes on from there")]
    Paused,
}

/// The option with which someone who knows better goes on.
fn remedy(error: &DataError) -> &'static str {
    match &*error.problem {
        Problem::Units(_) => "; if they are right: --trust-units, else state the units in a map: --signals",
        // A table of another's: it has a clock, but not under this name, or wheel speeds of an unknown unit.
        Problem::MissingColumn { column, .. }
            if *column == Slot::Time.name() || column.contains("_wheel_speed_") =>
        {
            "; other names or units: itpms signals LOG --write-map map.toml, then --signals map.toml (there, the unit of a name that states none: fl_wheel_speed_m_s = { signal = \"...\", unit = \"km/h\" })"
        }
        _ => "",
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::Data(error.into())
    }
}

impl From<CrgError> for Failure {
    fn from(error: CrgError) -> Self {
        Self::Data(error.into())
    }
}

impl From<DriveError> for Failure {
    fn from(error: DriveError) -> Self {
        match error {
            DriveError::Data(error) => Failure::Data(error),
            DriveError::Scenario(error) => Failure::Scenario(error),
            DriveError::Report(error) => Failure::Report(error),
            DriveError::Stopped => Failure::Interrupted,
            other => Failure::Usage(other.to_string()),
        }
    }
}

impl Failure {
    pub fn code(&self) -> ExitCode {
        match self {
            Failure::Data(_)
            | Failure::Scenario(_)
            | Failure::Directory(..)
            | Failure::Usage(_)
            | Failure::Report(_) => ExitCode::from(2),
            Failure::Missed(_) => ExitCode::from(1),
            // 128 and the number of SIGINT, as shells count.
            Failure::Interrupted | Failure::Paused => ExitCode::from(130),
        }
    }
}
