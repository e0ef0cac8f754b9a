//! Products of the residual's derivatives on a road of unit power, bin by bin (docs/math/shared-road.md, section 4). They change as slowly
//! as the car does: once all are known, one bin is computed anew with every frame.

use crate::belief::measurement::{BINS, Products};
use crate::memory::Blank;
use crate::real::Real;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ExpectedProducts<T: Real> {
    of_bin: [Products<T>; BINS],
    /// Which bin is next, and how many are not known.
    due: usize,
    pub(crate) missing: usize,
}

impl<T: Real> ExpectedProducts<T> {
    /// Nothing is known any more.
    pub(crate) fn forget(&mut self) {
        self.missing = BINS;
    }

    /// As before the first frame.
    pub(crate) fn restart(&mut self) {
        self.of_bin.iter_mut().for_each(|products| products.fill(T::zero()));
        (self.due, self.missing) = (0, BINS);
    }

    pub(crate) fn advance(&mut self, compute: impl Fn(usize) -> Products<T>) {
        if let Some(of_bin) = self.of_bin.get_mut(self.due) {
            *of_bin = compute(self.due);
        }
        self.missing = self.missing.saturating_sub(1);
        self.due = (self.due + 1) % BINS;
    }

    pub(crate) fn of_all_bins(&self) -> &[Products<T>; BINS] {
        &self.of_bin
    }
}
