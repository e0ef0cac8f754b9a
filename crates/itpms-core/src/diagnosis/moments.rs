//! Running second moments of signals, in blocks, each block weighing the same however rough its road is: a pothole must
//! not outvote a minute.

use nalgebra::SMatrix;

use crate::memory::Blank;
use crate::real::Real;

/// Second moments of `N` signals, an exponential mean over blocks.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Moments<T: Real, const N: usize> {
    block: SMatrix<T, N, N>,
    count: u32,
    mean: SMatrix<T, N, N>,
    /// Share of the mean that has been filled, 0 to 1.
    filled: T,
}

impl<T: Real, const N: usize> Moments<T, N> {
    /// Adds a value of every signal to the block that runs.
    pub(crate) fn push(&mut self, z: &[T; N]) {
        for i in 0..N {
            for j in 0..=i {
                self.block[(i, j)] += z[i] * z[j];
            }
        }
        self.count += 1;
    }

    /// Ends the block: the moments in it alone, as means per value. `None` if it was empty.
    pub(crate) fn end_block(&mut self) -> Option<SMatrix<T, N, N>> {
        let (block, count) = (core::mem::replace(&mut self.block, SMatrix::zeros()), self.count);
        self.count = 0;
        if count == 0 {
            return None;
        }
        let scale = T::one() / T::lit(f64::from(count));
        Some(SMatrix::from_fn(|i, j| scale * block[(i.max(j), i.min(j))]))
    }

    /// Takes a block, divided by `scale`, into the mean, whose memory is so many blocks.
    pub(crate) fn add_block(&mut self, block: &SMatrix<T, N, N>, scale: T, blocks: f64) {
        let share = T::lit(1.0 / blocks);
        if !(scale > T::zero() && scale.is_finite()) {
            return;
        }
        self.mean += (block / scale - self.mean) * share;
        self.filled += (T::one() - self.filled) * share;
    }

    /// The mean, as far as it is filled; `None` before the share `filled` of it is.
    pub(crate) fn mean(&self, filled: f64) -> Option<SMatrix<T, N, N>> {
        (self.filled >= T::lit(filled)).then(|| self.mean / self.filled)
    }
}
