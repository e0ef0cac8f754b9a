//! Problems of a scenario, with the expected value.

use std::path::PathBuf;

use itpms_core::model::ParameterError;
use thiserror::Error;

pub type Result<T, E = InvalidValue> = std::result::Result<T, E>;

/// A value outside its range.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct InvalidValue {
    /// The field as it is written in a scenario file, for example `road.surface.iso8608.slope`.
    pub field: String,
    pub found: String,
    pub expected: &'static str,
}

impl InvalidValue {
    pub(crate) fn new(field: impl Into<String>, found: impl ToString, expected: &'static str) -> Self {
        Self { field: field.into(), found: found.to_string(), expected }
    }

    /// The same, one table further out: `slope` within `road` is `road.slope`.
    pub(crate) fn within(self, table: &str) -> Self {
        Self { field: format!("{table}.{}", self.field), ..self }
    }
}

impl From<ParameterError> for InvalidValue {
    fn from(e: ParameterError) -> Self {
        Self::new(e.name, e.value, e.expected)
    }
}

/// `Ok` if `value` is finite and within `low..=high`; NaN is not.
pub(crate) fn within(field: &str, value: f64, low: f64, high: f64, expected: &'static str) -> Result<()> {
    if value >= low && value <= high && value.is_finite() {
        Ok(())
    } else {
        Err(InvalidValue::new(field, value, expected))
    }
}

/// `Ok` if `value` is finite and positive; NaN is not.
pub(crate) fn positive(field: &str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(InvalidValue::new(field, value, "a positive, finite number"))
    }
}

/// `Ok` if `value` is finite and not negative; NaN is not.
pub(crate) fn not_negative(field: &str, value: f64) -> Result<()> {
    within(field, value, 0.0, f64::MAX, "a finite number, zero or more")
}

/// A measured road profile that cannot be used.
#[derive(Debug, Error)]
pub enum ProfileError {
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}, line {line}: found `{found}`, expected a station and an elevation in m", path.display())]
    Line { path: PathBuf, line: usize, found: String },
    #[error("station {found} in row {row} follows {previous}, expected stations that increase")]
    NotIncreasing { row: usize, found: f64, previous: f64 },
    #[error("row {row} is not finite")]
    NotFinite { row: usize },
    #[error("{found} points, expected at least 4")]
    TooFewPoints { found: usize },
}

/// A scenario that cannot be driven.
#[derive(Debug, Error)]
pub enum ScenarioError {
    #[error("no scenario `{name}`{}; built in: {}; or give a TOML file", did_you_mean(nearest.as_deref()), known.join(", "))]
    Unknown { name: String, nearest: Option<String>, known: Vec<String> },
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{origin}, line {line}, column {column}: {message}")]
    Syntax { origin: String, line: usize, column: usize, message: String },
    #[error("scenario `{scenario}`: {source}")]
    Invalid { scenario: String, source: InvalidValue },
    #[error("scenario `{scenario}`, road profile: {source}")]
    Profile { scenario: String, source: ProfileError },
    #[error("cannot write the scenario as TOML: {0}")]
    Write(String),
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map(|n| format!(" (did you mean `{n}`?)")).unwrap_or_default()
}
