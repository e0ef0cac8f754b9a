//! Looks at a column before anything is computed from it. Called by the identifications.

use super::{IdentifyError, Result};

/// Share of rows at one extreme from which a signal counts as clipped. A sine or a triangle resolved to a hundredth of
/// its amplitude stays there for 4.5 % or 0.5 % of the time; cut at 95 % of its amplitude, a sine stays 10 %.
const CLIPPED_SHARE: f64 = 0.05;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// Values that no part of a car has in the unit of their column are refused.
    #[default]
    Checked,
    /// The user knows better.
    Trusted,
}

/// Finite, and as long as the other column.
pub(super) fn pair((x_name, x): (&str, &[f64]), (y_name, y): (&str, &[f64])) -> Result<()> {
    if x.len() != y.len() {
        let lengths = format!("columns of {} and {} rows, expected equal lengths", x.len(), y.len());
        return Err(IdentifyError::Refused(lengths));
    }
    finite(x_name, x)?;
    finite(y_name, y)
}

pub(super) fn finite(what: &str, column: &[f64]) -> Result<()> {
    let row = column.iter().position(|value| !value.is_finite());
    let refused = |row| Err(IdentifyError::Refused(format!("row {} of {what} is not finite", row + 1)));
    row.map_or(Ok(()), refused)
}

pub(super) fn at_least(what: &str, found: usize, expected: usize) -> Result<()> {
    if found < expected { Err(IdentifyError::too_few(what, found, expected)) } else { Ok(()) }
}

/// A number for a person, with its power of ten where there would be many zeros.
pub(super) fn plain(value: f64) -> String {
    match value.abs() {
        size if size > 0.0 && !(1e-4..1e9).contains(&size) => format!("{value:.2e}"),
        size if size >= 1e3 => format!("{value:.1}"),
        _ => format!("{value:.4}"),
    }
}

pub(super) fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

pub(super) fn varies(what: &str, values: &[f64]) -> Result<(f64, f64)> {
    let (low, high) = range(values);
    // A span below the rounding of the values is none.
    if !(high - low > 1e-9 * low.abs().max(high.abs())) {
        return Err(IdentifyError::constant(what, values));
    }
    Ok((low, high))
}

/// The signal does not rest at one of its ends.
pub(super) fn not_clipped(what: &str, values: &[f64]) -> Result<()> {
    let (low, high) = range(values);
    for (value, end) in [(high, "maximum"), (low, "minimum")] {
        // One visit to the end is longer than a chance meeting of two rows.
        let mut longest = 0;
        let mut run = 0;
        let mut rows = 0;
        for v in values {
            run = if *v == value { run + 1 } else { 0 };
            rows += usize::from(*v == value);
            longest = longest.max(run);
        }
        if longest >= 3 && rows as f64 > CLIPPED_SHARE * values.len() as f64 {
            let shown = format!("{rows} of {} rows are exactly {value}, its {end}", values.len());
            let sentence = format!("{what} looks clipped: {shown}; expected a signal within its range");
            return Err(IdentifyError::Refused(sentence));
        }
    }
    Ok(())
}
