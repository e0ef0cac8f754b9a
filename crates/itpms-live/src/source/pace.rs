//! When something that was recorded is due again.

use std::thread;
use std::time::{Duration, Instant};

/// Longest time in s to sleep without looking whether an end is wanted.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);

/// How fast a log is replayed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Speed {
    /// So many times as fast as it was recorded; positive.
    Times(f64),
    /// As fast as it can be estimated.
    Max,
}

#[derive(Debug)]
pub(super) struct Pace {
    pub(super) speed: Speed,
    begun: Option<(Instant, f64)>,
}

impl Pace {
    pub(super) fn new(speed: Speed) -> Self {
        Self { speed, begun: None }
    }

    /// Sleeps until what was recorded at `time_s` is due. `false` if an end is wanted.
    pub(super) fn wait(&mut self, time_s: f64, wanted: impl Fn() -> bool) -> bool {
        let Speed::Times(times) = self.speed else { return wanted() };
        let (begun, first_s) = *self.begun.get_or_insert_with(|| (Instant::now(), time_s));
        let after_s = ((time_s - first_s) / times).clamp(0.0, 1e9);
        let due = begun + Duration::from_secs_f64(if after_s.is_finite() { after_s } else { 0.0 });
        loop {
            if !wanted() {
                return false;
            }
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return true;
            }
            thread::sleep(left.min(LONGEST_SLEEP));
        }
    }
}
