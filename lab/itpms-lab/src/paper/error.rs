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
    /// A scenario without the corner that the study drives.
    #[error("scenario {0} has no front left corner, expected one")]
    NoCorner(String),
    /// The progress callback asked for it.
    #[error("stopped")]
    Stopped,
    /// A scenario, or a parameter that it refuses.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A history of pressure or speed.
    #[error(transparent)]
    Value(#[from] InvalidValue),
    /// A parameter that an estimator refuses.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The line through Table 1.
    #[error(transparent)]
    Regression(#[from] RegressionError),
    #[error(transparent)]
    Welch(#[from] WelchError),
    /// The line through the road's spectrum.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// A drive that has no bound.
    #[error(transparent)]
    Bound(#[from] BoundError),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}
