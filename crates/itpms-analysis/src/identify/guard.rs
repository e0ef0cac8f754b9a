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
pub(super) fn pair((x_name, x): (&'static str, &[f64]), (y_name, y): (&'static str, &[f64])) -> Result<()> {
    if x.len() != y.len() {
        return Err(IdentifyError::Lengths { first: x.len(), second: y.len() });
    }
    for (what, column) in [(x_name, x), (y_name, y)] {
        if let Some(row) = column.iter().position(|value| !value.is_finite()) {
            return Err(IdentifyError::NotFinite { what, row: row + 1 });
        }
    }
    Ok(())
}

/// As people write it, with its power of ten where there would be more zeros than anybody counts.
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

pub(super) fn varies(what: &'static str, values: &[f64]) -> Result<(f64, f64)> {
    let (low, high) = range(values);
    // A span below the rounding of the values is none.
    if !(high - low > 1e-9 * low.abs().max(high.abs())) {
        return Err(IdentifyError::Constant { what, value: values.first().copied().unwrap_or(f64::NAN) });
    }
    Ok((low, high))
}

/// The signal does not rest at one of its ends.
pub(super) fn not_clipped(what: &'static str, values: &[f64]) -> Result<()> {
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
            return Err(IdentifyError::Clipped { what, rows, of: values.len(), value, end });
        }
    }
    Ok(())
}
