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
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Learn(#[from] itpms_analysis::learn::LearnError),
    #[error("{0}")]
    Log(String),
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
