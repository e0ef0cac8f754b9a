//! Products of the residual's derivatives on a road of unit power, bin by bin (docs/math/shared-road.md, section 4). They change as slowly
//! as the car does: of those that are known, one bin is computed anew with every frame.

use crate::belief::measurement::{BINS, Gram};
use crate::memory::blank;
use crate::real::Real;

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ExpectedProducts<T: Real> {
    of_bin: [Gram<T>; BINS],
    due: usize,
    known: bool,
}

blank!(ExpectedProducts<T> { of_bin, due, known });

impl<T: Real> ExpectedProducts<T> {
    /// Nothing is known: the next frame computes all bins.
    pub(crate) fn forget(&mut self) {
        self.known = false;
    }

    /// As before the first frame.
    pub(crate) fn restart(&mut self) {
        self.of_bin.iter_mut().for_each(|products| products.fill(T::zero()));
        (self.due, self.known) = (0, false);
    }

    /// Brings the bin that is due up to date, or all where nothing is known; gives those of all bins.
    pub(crate) fn refresh(&mut self, compute: impl Fn(usize) -> Gram<T>) -> &[Gram<T>; BINS] {
        for (bin, products) in self.of_bin.iter_mut().enumerate() {
            if !self.known || bin == self.due {
                *products = compute(bin);
            }
        }
        (self.known, self.due) = (true, (self.due + 1) % BINS);
        &self.of_bin
    }
}
