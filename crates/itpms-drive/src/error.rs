//! Why there is no result.

use std::io;

use itpms_core::model::ParameterError;
use itpms_data::DataError;
use itpms_data::crg::CrgError;
use itpms_data::error::FileError;
use itpms_sim::error::ScenarioError;
use thiserror::Error;

/// Why a drive was not estimated. Its message is complete.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DriveError {
    #[error(transparent)]
    Data(#[from] DataError),
    /// A parameter that the estimator or its monitor refuses.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Nothing can be learned of these drives.
    #[error(transparent)]
    Learn(#[from] itpms_analysis::learn::LearnError),
    /// A log that contradicts itself, or does not show what is looked for.
    #[error("{0}")]
    Log(String),
    /// Settings and inputs that do not go together.
    #[error("{0}")]
    Mismatch(String),
    #[error("the report cannot be made: {0}")]
    Report(io::Error),
    #[error("interrupted")]
    Stopped,
}

impl From<FileError> for DriveError {
    fn from(error: FileError) -> Self {
        Self::Data(error.into())
    }
}

impl From<CrgError> for DriveError {
    fn from(error: CrgError) -> Self {
        Self::Data(error.into())
    }
}
