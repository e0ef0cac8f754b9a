//! Samples of a file into the order of their stamps, each at its own time.
//!
//! The order of the stamps is the order of the data, whatever the order in the file. Called by the reader of tables with rows, and by
//! the source of signals with readings; a live bus, which cannot wait, does not come here. In this order:
//!
//! | module | idea |
//! |---|---|
//! | `strays` | a short run of stamps that contradict the others of its clock is left out |
//! | `series` | samples of one signal (or the rows of a table) that share a stamp are spread; a clock that was set back is noticed |
//! | `sorted` | everything by its stamp, over [`WINDOW_S`] |
//! | `spread` | the straight line through stamps that are coarser than the samples |

mod series;
mod sorted;
mod spread;
mod strays;

pub(super) use series::{Coarse, Series};
pub(super) use sorted::Sorted;
pub(super) use strays::Strays;

/// Samples further than this from their place in the file, in s, are not put back.
pub(super) const WINDOW_S: f64 = 10.0;
/// Share of samples that may be left out of a log; beyond, what is left is not this drive.
pub(super) const TOLERATED_SHARE: f64 = 0.01;

pub(super) trait Stamped: Copy {
    /// The stamp in s, finite.
    fn time_s(&self) -> f64;
    fn at(self, time_s: f64) -> Self;
    /// Whether it holds the same values, so that with an equal stamp it is the same sample written twice.
    fn has_values_of(&self, other: &Self) -> bool;
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fate<T> {
    Kept(T),
    /// Its stamp contradicts the others.
    Stray(T),
    /// It was written twice, or shares its stamp with another that is kept.
    Repeated(T),
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::log) type Sample = (f64, u32);

    impl Stamped for Sample {
        fn time_s(&self) -> f64 {
            self.0
        }
        fn at(self, time_s: f64) -> Self {
            (time_s, self.1)
        }
        fn has_values_of(&self, other: &Self) -> bool {
            self.1 == other.1
        }
    }
}
