//! Measurements that nothing can be identified from, in one sentence. Rows count from one, the header not included.

use thiserror::Error;

use super::estimate::Estimate;
use super::guard::plain;

pub type Result<T, E = IdentifyError> = std::result::Result<T, E>;

/// Why an identification is refused.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum IdentifyError {
    #[error("{0}")]
    Refused(String),
    #[error(
        "the longest stretch of one steady sine has {found} periods, expected at least {expected} of the same frequency and amplitude"
    )]
    TooFewPeriods { found: usize, expected: usize },
}

impl IdentifyError {
    pub(super) fn no_slope(what: &str, estimate: &Estimate, unit: &str) -> Self {
        let Estimate { value, standard_error, .. } = estimate;
        let distance = format!("{value:.4} ± {standard_error:.4} {unit}");
        Self::Refused(format!("{what} is not distinguishable from zero: {distance}"))
    }

    pub(super) fn too_few(what: &str, found: usize, expected: usize) -> Self {
        Self::Refused(format!("found {found} {what}, expected at least {expected}"))
    }

    pub(super) fn units(what: &str, found: &str, expected: &str, hint: &str) -> Self {
        Self::Refused(format!("wrong units suspected: {what} is {found}, expected {expected}{hint}"))
    }

    pub(super) fn unit(what: &str, (value, unit): (f64, &str), expected: &str, hint: &str) -> Self {
        Self::units(what, &format!("{} {unit}", plain(value)), expected, hint)
    }

    pub(super) fn singular(what: &str) -> Self {
        Self::Refused(format!("{what} cannot be separated by these data"))
    }

    pub(super) fn constant(what: &str, values: &[f64]) -> Self {
        Self::Refused(format!("{what} is constant ({})", values.first().unwrap_or(&f64::NAN)))
    }

    pub(super) fn time_order(row: usize, from_s: f64, to_s: f64) -> Self {
        Self::Refused(format!("time_s does not increase at row {row}: {from_s} is followed by {to_s}"))
    }
}
