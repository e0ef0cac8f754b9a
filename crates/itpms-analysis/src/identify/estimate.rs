//! A number with its standard error, and where that error comes from. Used by all identifications.

use std::fmt;

use serde::Serialize;

use super::blocks::BlockFit;
use super::distribution::t_quantile;

/// Two-sided 5 % point of the normal distribution.
pub(super) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// A value with its standard error.
///
/// The standard error already contains what few degrees of freedom cost: the 95 % interval is `value ± 1.96
/// standard_error`, however many there are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    pub value: f64,
    /// Half the width of the 95 % interval over 1.96, in the unit of the value.
    pub standard_error: f64,
    /// Degrees of freedom behind the standard error.
    pub degrees_of_freedom: f64,
}

impl Estimate {
    /// From a variance that rests on `dof` degrees of freedom.
    pub(super) fn new(value: f64, variance: f64, dof: f64) -> Self {
        let widening = t_quantile(0.05, dof) / NORMAL_95;
        Self { value, standard_error: variance.max(0.0).sqrt() * widening, degrees_of_freedom: dof }
    }

    pub(super) fn of(fit: &BlockFit, factors: &[(usize, f64)]) -> Self {
        let value = factors.iter().map(|(i, a)| a * fit.coefficients[*i]).sum();
        let variance = factors
            .iter()
            .flat_map(|(i, a)| factors.iter().map(move |(j, b)| a * b * fit.covariance[(*i, *j)]))
            .sum();
        let dof = factors.iter().map(|(i, _)| fit.dof[*i]).fold(f64::INFINITY, f64::min);
        Self::new(value, variance, dof)
    }

    /// The ends of the 95 % interval.
    pub fn interval_95(&self) -> (f64, f64) {
        let half = NORMAL_95 * self.standard_error;
        (self.value - half, self.value + half)
    }

    /// How many standard errors the value is from another.
    pub fn deviation(&self, from: f64) -> f64 {
        (self.value - from) / self.standard_error
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorBasis {
    /// The disagreement of so many blocks (strokes, groups of periods): right whatever the correlation within a block.
    Blocks(usize),
    /// The residuals' own correlation over so many rows (Newey and West): for too few strokes to compare.
    Autocorrelation(usize),
    /// Residuals taken as independent: too few rows to learn their correlation.
    Independent,
}

impl fmt::Display for ErrorBasis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ErrorBasis::Blocks(n) => write!(f, "how much {n} blocks disagree"),
            ErrorBasis::Autocorrelation(rows) => {
                write!(f, "the correlation of residuals over {rows} rows")
            }
            ErrorBasis::Independent => write!(f, "residuals taken as independent"),
        }
    }
}
