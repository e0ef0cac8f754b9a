//! Why there is no study.

use itpms_core::model::{ParameterError, RegressionError};
use itpms_sim::error::{InvalidValue, ScenarioError};
use thiserror::Error;

use itpms_analysis::bound::BoundError;
use itpms_analysis::spectrum::{FitError, WelchError};

#[derive(Debug, Error)]
pub enum PaperError {
    #[error("0 seeds, expected at least one")]
    NoSeeds,
    #[error("scenario {0} has no front left corner, expected one")]
    NoCorner(String),
    #[error("stopped")]
    Stopped,
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Value(#[from] InvalidValue),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Regression(#[from] RegressionError),
    #[error(transparent)]
    Welch(#[from] WelchError),
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Bound(#[from] BoundError),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}
