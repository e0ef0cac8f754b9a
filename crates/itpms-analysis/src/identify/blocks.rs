//! Linear least squares over blocks of rows, each with an intercept of its own, and a covariance that comes from how
//! much the blocks disagree (docs/math/identification.md, eq. 3-6).
//!
//! Called by the identifications with strokes or groups of periods as blocks. Within a block the errors may be
//! correlated in any way and of any size: only the blocks have to be independent of each other.

use nalgebra::{DMatrix, DVector};

/// Sums of one block: regressors and target about their means in the block.
#[derive(Debug, Clone)]
pub(super) struct Block {
    xx: DMatrix<f64>,
    xy: DVector<f64>,
    yy: f64,
    rows: f64,
}

impl Block {
    /// `rows` gives per row the regressors (all of length `width`) and the target.
    pub(super) fn new<R: AsRef<[f64]>>(width: usize, rows: &[(R, f64)]) -> Self {
        let count = rows.len() as f64;
        let mut mean = DVector::<f64>::zeros(width);
        let mut target = 0.0;
        for (x, y) in rows {
            for (m, value) in mean.iter_mut().zip(x.as_ref()) {
                *m += value / count;
            }
            target += y / count;
        }
        let mut block =
            Self { xx: DMatrix::zeros(width, width), xy: DVector::zeros(width), yy: 0.0, rows: count };
        let mut centred = vec![0.0; width];
        for (x, y) in rows {
            for ((c, value), m) in centred.iter_mut().zip(x.as_ref()).zip(mean.iter()) {
                *c = value - m;
            }
            block.add(&centred, y - target);
        }
        block.xx.fill_upper_triangle_with_lower_triangle();
        block
    }

    /// The same about zero: the regressors have an intercept among them, if any, that all blocks share.
    pub(super) fn about_zero<R: AsRef<[f64]>>(width: usize, rows: &[(R, f64)]) -> Self {
        let mut block = Self {
            xx: DMatrix::zeros(width, width),
            xy: DVector::zeros(width),
            yy: 0.0,
            rows: rows.len() as f64,
        };
        for (x, y) in rows {
            block.add(x.as_ref(), *y);
        }
        block.xx.fill_upper_triangle_with_lower_triangle();
        block
    }

    /// One more row, in the lower triangle.
    fn add(&mut self, x: &[f64], y: f64) {
        for i in 0..x.len() {
            for j in 0..=i {
                self.xx[(i, j)] += x[i] * x[j];
            }
            self.xy[i] += x[i] * y;
        }
        self.yy += y * y;
    }

    pub(super) fn joined(mut self, other: &Self) -> Self {
        self.xx += &other.xx;
        self.xy += &other.xy;
        self.yy += other.yy;
        self.rows += other.rows;
        self
    }

    /// The same block counted `weight` times.
    pub(super) fn weighted(mut self, weight: f64) -> Self {
        self.xx *= weight;
        self.xy *= weight;
        self.yy *= weight;
        self
    }
}

#[derive(Debug, Clone)]
pub(super) struct BlockFit {
    pub(super) coefficients: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    /// Effective degrees of freedom of each coefficient's variance.
    pub(super) dof: DVector<f64>,
    pub(super) residual_rms: f64,
}

fn total(blocks: &[Block], without: Option<usize>) -> Option<Block> {
    let mut used = blocks.iter().enumerate().filter(|(i, _)| Some(*i) != without).map(|(_, block)| block);
    let first = used.next()?.clone();
    Some(used.fold(first, Block::joined))
}

/// The coefficients alone, and the root mean squared residual; `None` where the regressors do not tell them apart.
pub(super) fn solve(blocks: &[Block]) -> Option<(DVector<f64>, f64)> {
    let sum = total(blocks, None)?;
    let coefficients = well_posed(&sum.xx)?.solve(&sum.xy);
    let squares = (sum.yy - coefficients.dot(&sum.xy)).max(0.0);
    Some((coefficients, (squares / sum.rows).sqrt()))
}

/// Cholesky's factors, unless a regressor is nearly a sum of others.
fn well_posed(xx: &DMatrix<f64>) -> Option<nalgebra::Cholesky<f64, nalgebra::Dyn>> {
    let factors = xx.clone().cholesky()?;
    let l = factors.l_dirty();
    // L_ii² is what the others leave of a regressor's square sum.
    (0..xx.nrows()).all(|i| l[(i, i)] * l[(i, i)] > 1e-9 * xx[(i, i)]).then_some(factors)
}

/// Least squares with the jackknife's covariance: every block is left out once. `None` for fewer than two blocks, or where
/// the regressors do not tell the coefficients apart.
pub(super) fn jackknife(blocks: &[Block]) -> Option<BlockFit> {
    let n = blocks.len();
    if n < 2 {
        return None;
    }
    let all = total(blocks, None)?;
    let factors = well_posed(&all.xx)?;
    let (coefficients, residual_rms) = solve(blocks)?;
    let width = coefficients.len();
    let mut covariance = DMatrix::zeros(width, width);
    for i in 0..n {
        let rest = total(blocks, Some(i))?;
        let difference = well_posed(&rest.xx)?.solve(&rest.xy) - &coefficients;
        covariance += &difference * difference.transpose();
    }
    covariance *= (n - 1) as f64 / n as f64;
    // How evenly the blocks share what is known about each coefficient.
    let inverse = factors.inverse();
    let dof = DVector::from_fn(width, |j, _| {
        let a = inverse.column(j);
        let (sum, squares) = blocks.iter().fold((0.0, 0.0), |(sum, squares), block| {
            let share = (&block.xx * a).dot(&a);
            (sum + share, squares + share * share)
        });
        (sum * sum / squares - 1.0).max(1.0)
    });
    Some(BlockFit { coefficients, covariance, dof, residual_rms })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_blocks_give_the_mean_slope_and_its_ordinary_standard_error() {
        // Blocks of the same abscissas: slope k_b each, so the estimate is their mean and its variance sd²/n.
        let slopes = [1.0, 1.3, 0.9, 1.1, 1.6];
        let blocks: Vec<Block> = slopes
            .iter()
            .enumerate()
            .map(|(i, k)| {
                let rows: Vec<_> = [0.0, 1.0, 3.0].iter().map(|x| ([*x], k * x + 7.0 * i as f64)).collect();
                Block::new(1, &rows)
            })
            .collect();
        let fit = jackknife(&blocks).unwrap();
        let mean = slopes.iter().sum::<f64>() / 5.0;
        let variance = slopes.iter().map(|k| (k - mean).powi(2)).sum::<f64>() / 4.0 / 5.0;
        assert!((fit.coefficients[0] - mean).abs() < 1e-12);
        assert!((fit.covariance[(0, 0)] - variance).abs() < 1e-12);
        assert!((fit.dof[0] - 4.0).abs() < 1e-9);
    }

    #[test]
    fn regressors_that_say_the_same_are_refused() {
        let rows: Vec<_> = (0..9).map(|i| ([f64::from(i), 2.0 * f64::from(i)], f64::from(i * i))).collect();
        assert!(jackknife(&[Block::new(2, &rows), Block::new(2, &rows)]).is_none());
    }
}
