//! Least squares over bands of frequency: each band weighs by what the model leaves of it, and the standard errors come
//! from how much blocks of time disagree. Called by `corner` for the body and for the tire.

use nalgebra::DVector;

use super::super::blocks::{Block, BlockFit, jackknife, solve};
use super::super::estimate::Estimate;
use super::super::{IdentifyError, Result};

/// Into how many blocks the motion is cut; the covariance is the mean over these, for where a cut falls is chance.
const PARTITIONS: std::ops::RangeInclusive<usize> = 6..=10;
/// Relative error beside the data's: central differences, and friction that turns round otherwise than it is taken to.
const METHOD: f64 = 0.01;
/// Rounds in which the weights settle.
const ROUNDS: usize = 6;

/// Regressors (one column each) and target of one band, in the rows of the free motion.
pub(super) struct BandRows {
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) target: Vec<f64>,
}

#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// Once from blocks of equal time, once from blocks of equal way. What dies away with the motion is known from its beginning,
    /// what does not from all of it.
    cut: [BlockFit; 2],
    /// Share of the lowest band's target that is explained.
    pub(super) explained: f64,
}

impl Fit {
    /// Fits all bands with one set of coefficients. `velocity` is what the motion's way is counted by, `what` is what cannot be
    /// distinguished if they cannot.
    pub(super) fn of(bands: &[BandRows], velocity: &[f64], what: &'static str) -> Result<Self> {
        let singular = || IdentifyError::singular(what);
        let mut weights = vec![1.0; bands.len()];
        let mut residuals = Vec::new();
        for _ in 0..ROUNDS {
            let (coefficients, _) =
                solve(&[whole(bands, &weights).ok_or_else(singular)?]).ok_or_else(singular)?;
            residuals = bands.iter().map(|band| mean_square(&band.residuals(&coefficients))).collect();
            weights = residuals.iter().map(|r: &f64| 1.0 / r.max(f64::MIN_POSITIVE)).collect();
        }
        let even = vec![1.0; velocity.len()];
        let by_time = averaged(bands, &weights, &even).ok_or_else(singular)?;
        let by_way = averaged(bands, &weights, velocity).ok_or_else(singular)?;
        let explained = bands.first().zip(residuals.first()).map_or(0.0, |(band, residual)| {
            let mean = band.target.iter().sum::<f64>() / band.target.len() as f64;
            let all: Vec<f64> = band.target.iter().map(|y| y - mean).collect();
            1.0 - residual / mean_square(&all)
        });
        Ok(Self { cut: [by_time, by_way], explained })
    }

    pub(super) fn coefficient(&self, index: usize, factor: f64) -> Estimate {
        self.of_factors(&[(index, factor)])
    }

    /// A value whose derivatives by the coefficients are `gradient`.
    pub(super) fn function(&self, value: f64, gradient: &[(usize, f64)]) -> Estimate {
        Estimate { value, ..self.of_factors(gradient) }
    }

    /// By the cut whose blocks share more evenly what is known of these coefficients, which no residual decides.
    fn of_factors(&self, factors: &[(usize, f64)]) -> Estimate {
        let [by_time, by_way] = self.cut.each_ref().map(|fit| Estimate::of(fit, factors));
        let chosen = if by_way.degrees_of_freedom > by_time.degrees_of_freedom { by_way } else { by_time };
        Estimate { standard_error: chosen.standard_error.hypot(METHOD * chosen.value), ..chosen }
    }

    pub(super) fn fitted(&self, band: &BandRows) -> Vec<f64> {
        band.fitted(&self.cut[0].coefficients)
    }
}

impl BandRows {
    fn row(&self, i: usize) -> Vec<f64> {
        self.columns.iter().map(|column| column[i]).collect()
    }

    fn fitted(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        (0..self.target.len())
            .map(|i| self.columns.iter().zip(coefficients.iter()).map(|(column, c)| c * column[i]).sum())
            .collect()
    }

    fn residuals(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        self.fitted(coefficients).iter().zip(&self.target).map(|(fit, y)| y - fit).collect()
    }

    fn block(&self, rows: std::ops::Range<usize>) -> Block {
        let rows: Vec<_> = rows.map(|i| (self.row(i), self.target[i])).collect();
        Block::about_zero(self.columns.len(), &rows)
    }
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64
}

fn summed(bands: &[BandRows], weights: &[f64], rows: std::ops::Range<usize>) -> Option<Block> {
    bands
        .iter()
        .zip(weights)
        .map(|(band, weight)| band.block(rows.clone()).weighted(*weight))
        .reduce(|sum, band| sum.joined(&band))
}

fn whole(bands: &[BandRows], weights: &[f64]) -> Option<Block> {
    summed(bands, weights, 0..bands.first()?.target.len())
}

/// The fit with its mean covariance over all numbers of blocks that cover the same way of `velocity`.
fn averaged(bands: &[BandRows], weights: &[f64], velocity: &[f64]) -> Option<BlockFit> {
    let fits: Vec<BlockFit> = PARTITIONS
        .map(|blocks| jackknife(&partition(bands, weights, &cuts(velocity, blocks))?))
        .collect::<Option<_>>()?;
    let count = fits.len() as f64;
    let mut sum = fits.first()?.clone();
    for fit in &fits[1..] {
        sum.covariance += &fit.covariance;
        sum.dof += &fit.dof;
    }
    Some(BlockFit { covariance: sum.covariance / count, dof: sum.dof / count, ..sum })
}

/// The same in blocks of time, from one cut to the next.
fn partition(bands: &[BandRows], weights: &[f64], cuts: &[usize]) -> Option<Vec<Block>> {
    cuts.windows(2).map(|cut| summed(bands, weights, cut[0]..cut[1])).collect()
}

/// Rows between which each of `blocks` blocks covers the same way.
fn cuts(velocity: &[f64], blocks: usize) -> Vec<usize> {
    let whole: f64 = velocity.iter().map(|v| v.abs()).sum();
    let mut covered = 0.0;
    let mut out = vec![0];
    for (row, v) in velocity.iter().enumerate() {
        covered += v.abs();
        if covered > whole * out.len() as f64 / blocks as f64 && out.len() < blocks {
            out.push(row);
        }
    }
    out.push(velocity.len());
    out
}
