//! Measurements that nothing can be identified from, in one sentence. Rows count from one, the header not included.

use thiserror::Error;

use super::guard::plain;

pub type Result<T, E = IdentifyError> = std::result::Result<T, E>;

/// Why an identification is refused.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum IdentifyError {
    #[error("columns of {first} and {second} rows, expected equal lengths")]
    Lengths { first: usize, second: usize },
    #[error("row {row} of {what} is not finite")]
    NotFinite { what: &'static str, row: usize },
    #[error("found {found} {what}, expected at least {expected}")]
    TooFew { what: &'static str, found: usize, expected: usize },
    #[error("{what} is constant ({value})")]
    Constant { what: &'static str, value: f64 },
    #[error(
        "{what} looks clipped: {rows} of {of} rows are exactly {value}, its {end}; expected a signal within its range"
    )]
    Clipped { what: &'static str, rows: usize, of: usize, value: f64, end: &'static str },
    #[error("wrong units suspected: {what} is {found}, expected {expected}{hint}")]
    Units { what: &'static str, found: String, expected: &'static str, hint: &'static str },
    #[error("{what} is not distinguishable from zero: {value:.4} ± {standard_error:.4} {unit}")]
    NoSlope { what: &'static str, value: f64, standard_error: f64, unit: &'static str },
    #[error("time_s does not increase at row {row}: {from_s} is followed by {to_s}")]
    TimeOrder { row: usize, from_s: f64, to_s: f64 },
    #[error(
        "time_s steps by {step_s:.6} s at row {row}, expected {mean_s:.6} s as on average: one rate throughout"
    )]
    UnevenTime { row: usize, step_s: f64, mean_s: f64 },
    #[error("found {rate_hz:.1} rows per second, expected at least {expected_hz}")]
    TooSlow { rate_hz: f64, expected_hz: f64 },
    #[error(
        "the longest stretch of one steady sine has {found} periods, expected at least {expected} of the same frequency and amplitude"
    )]
    TooFewPeriods { found: usize, expected: usize },
    #[error("{rows_per_period:.1} rows per period at {frequency_hz:.3} Hz, expected at least {expected}")]
    SampledTooSlowly { frequency_hz: f64, rows_per_period: f64, expected: usize },
    #[error(
        "the damping is {value:.1} N s/m with the sign in which the spring pulls back: force_n and displacement_m are not of the same instant, or not of this part"
    )]
    NegativeDamping { value: f64 },
    #[error(
        "stiffness falls with pressure ({value:.1} ± {standard_error:.1} N/m per kPa), expected it to rise"
    )]
    FallingStiffness { value: f64, standard_error: f64 },
    #[error(
        "the line meets zero pressure at {value:.0} ± {standard_error:.0} N/m, expected zero or more: measure over more pressures"
    )]
    NegativeIntercept { value: f64, standard_error: f64 },
    #[error("{0} cannot be separated by these data")]
    Singular(&'static str),
}

impl IdentifyError {
    pub(super) fn units(
        what: &'static str,
        (value, unit): (f64, &str),
        expected: &'static str,
        hint: &'static str,
    ) -> Self {
        Self::Units { what, found: format!("{} {unit}", plain(value)), expected, hint }
    }
}
