//! By the stamp, over seconds, in bounded memory.
//!
//! Rows in order pass without being moved; a batch out of order is sorted once, stably, so that equal stamps keep the file's order.

use std::collections::VecDeque;

use super::{Stamped, WINDOW_S};

/// While samples are out of order they wait so much longer, in s, and are sorted in one go.
const BATCH_S: f64 = 0.5 * WINDOW_S;

#[derive(Debug)]
pub(in crate::log) struct Sorted<T> {
    waiting: VecDeque<T>,
    most: usize,
    in_order: bool,
    oldest_s: f64,
    newest_s: f64,
    /// Everything up to here may go.
    until_s: f64,
    /// Samples that came after a later one.
    pub(in crate::log) moved: u64,
}

impl<T: Stamped> Sorted<T> {
    pub(in crate::log) fn new(most: usize) -> Self {
        Self {
            waiting: VecDeque::new(),
            most,
            in_order: true,
            oldest_s: f64::INFINITY,
            newest_s: f64::NEG_INFINITY,
            until_s: f64::NEG_INFINITY,
            moved: 0,
        }
    }

    /// Takes a sample; false, and it is left out, where later ones have gone.
    pub(in crate::log) fn push(&mut self, sample: T) -> bool {
        let time_s = sample.time_s();
        if time_s < self.newest_s {
            self.moved += 1;
            if time_s < self.until_s {
                return false;
            }
            self.in_order = false;
        }
        self.oldest_s = self.oldest_s.min(time_s);
        self.newest_s = self.newest_s.max(time_s);
        self.waiting.push_back(sample);
        let full = self.waiting.len() >= self.most;
        let wait_s = if self.in_order { WINDOW_S } else { WINDOW_S + BATCH_S };
        if full || self.newest_s - self.oldest_s >= wait_s {
            self.sort();
            self.until_s = self.until_s.max(self.newest_s - WINDOW_S);
            if full {
                let half = self.waiting.get(self.waiting.len() / 2).map_or(self.newest_s, Stamped::time_s);
                self.until_s = self.until_s.max(half);
            }
        }
        true
    }

    /// There are no more samples.
    pub(in crate::log) fn finish(&mut self) {
        self.sort();
        self.until_s = f64::INFINITY;
    }

    /// The next sample that no earlier one can precede.
    pub(in crate::log) fn pop(&mut self) -> Option<T> {
        // Out of order the next one is not known; then all that may go has gone.
        let next = self.waiting.front().filter(|next| self.in_order && next.time_s() <= self.until_s)?;
        let next = *next;
        self.waiting.pop_front();
        self.oldest_s = self.waiting.front().map_or(f64::INFINITY, Stamped::time_s);
        Some(next)
    }

    fn sort(&mut self) {
        if !self.in_order {
            self.waiting.make_contiguous().sort_by(|a, b| a.time_s().total_cmp(&b.time_s()));
            self.in_order = true;
        }
        self.oldest_s = self.waiting.front().map_or(f64::INFINITY, Stamped::time_s);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::tests::Sample;
    use super::*;

    fn sorted(samples: impl IntoIterator<Item = Sample>) -> (Vec<Sample>, u64) {
        let (mut out, mut late) = (Vec::new(), 0);
        let mut sorted = Sorted::new(1 << 14);
        for sample in samples {
            late += u64::from(!sorted.push(sample));
            out.extend(std::iter::from_fn(|| sorted.pop()));
        }
        sorted.finish();
        out.extend(std::iter::from_fn(|| sorted.pop()));
        (out, late)
    }

    #[test]
    fn blocks_of_two_writers_come_together() {
        // Two seconds of one, then the same two seconds of the other.
        let block = |k: u32, of: u32| (0..1000).map(move |i| (f64::from(k) * 2.0 + f64::from(i) * 0.002, of));
        let (out, late) = sorted((0..30).flat_map(|k| block(k, 0).chain(block(k, 1))));
        assert_eq!((out.len(), late), (60_000, 0));
        for (i, pair) in out.chunks(2).enumerate() {
            // Equal stamps in the order of the file.
            assert_eq!((pair[0].1, pair[1].1), (0, 1), "{i}");
            assert!((pair[0].0 - i as f64 * 0.002).abs() < 1e-9 && pair[0].0 == pair[1].0, "{i}");
        }
    }

    proptest! {
        /// Displaced by less than the window: the order of the stamps, nothing lost.
        #[test]
        fn any_displacement_within_the_window(late in prop::collection::vec(0u32..900, 3000)) {
            // At 100 Hz.
            let mut file: Vec<(u32, Sample)> =
                late.iter().zip(0u32..).map(|(late, k)| (k + late, (f64::from(k) * 0.01, k))).collect();
            file.sort_by_key(|(place, _)| *place);
            let (out, late) = sorted(file.into_iter().map(|(_, sample)| sample));
            prop_assert_eq!(late, 0);
            prop_assert!(out.iter().map(|sample| sample.1).eq(0..3000));
        }

        /// Whatever comes: in order, and none more than may wait.
        #[test]
        fn anything(stamps in prop::collection::vec(-1e3f64..1e3, 0..2000)) {
            let (out, late) = sorted(stamps.iter().map(|stamp| (*stamp, 0)));
            prop_assert!(out.is_sorted_by(|a, b| a.0 <= b.0));
            prop_assert_eq!(out.len() as u64 + late, stamps.len() as u64);
        }
    }
}
