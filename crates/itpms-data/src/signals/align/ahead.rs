//! Readings that are stamped far ahead of all others: after a pause that is how a bus goes on, alone it is a broken stamp.
//!
//! Called by the aligner with every reading. Such readings wait until one with a later stamp follows them.

use crate::log::SLOTS;
use crate::signals::Reading;

/// A reading that is so much later than the last one, in s, has to be followed by another one.
const LEAP_S: f64 = 1.0;

#[derive(Debug)]
pub(super) struct Ahead {
    /// Time of the last reading that was passed on; NaN before the first.
    last_s: f64,
    waiting: Vec<Reading>,
    /// Readings that nothing followed.
    pub(super) strays: u64,
}

impl Ahead {
    pub(super) fn new() -> Self {
        Self { last_s: f64::NAN, waiting: Vec::new(), strays: 0 }
    }

    /// Takes a reading; passes on what is in line, in the order in which it came.
    pub(super) fn take(&mut self, reading: Reading, mut pass: impl FnMut(Reading)) {
        if reading.time_s - self.last_s > LEAP_S {
            let after_s = self.waiting.first().map_or(f64::NAN, |first| reading.time_s - first.time_s);
            if !(after_s > 0.0 && after_s <= LEAP_S) {
                // A stamp that stands still and never ends is as broken.
                if after_s != 0.0 || self.waiting.len() >= SLOTS {
                    self.drop_waiting();
                }
                self.waiting.push(reading);
                return;
            }
            self.waiting.drain(..).for_each(&mut pass);
        }
        self.drop_waiting();
        self.last_s = reading.time_s;
        pass(reading);
    }

    /// Nothing follows any more.
    pub(super) fn drop_waiting(&mut self) {
        self.strays += self.waiting.len() as u64;
        self.waiting.clear();
    }
}
