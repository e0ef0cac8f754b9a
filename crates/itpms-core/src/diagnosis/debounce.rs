//! Debouncing: a report that is set when a condition has held for a while, and cleared when another one has.

use crate::conditioning::pauses::ROUNDING_S;
use crate::memory::Blank;
use crate::tuning::Tunable;

/// How long a condition has to hold, in s.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DebounceTimes {
    /// For the report to be set.
    pub set_s: f64,
    /// And against it, to be cleared.
    pub clear_s: f64,
}

impl Tunable for DebounceTimes {
    type Numbers = [f64; 2];

    fn numbers(self) -> [f64; 2] {
        [self.set_s, self.clear_s]
    }

    fn of(numbers: &[f64]) -> Option<Self> {
        <[f64; 2]>::of(numbers).map(|[set_s, clear_s]| Self { set_s, clear_s })
    }
}

/// Set at the first sign, and cleared after a second without one.
pub(crate) const AT_ONCE: DebounceTimes = DebounceTimes { set_s: 0.0, clear_s: 1.0 };

/// Present evidence for or against the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Evidence {
    /// The condition to set it holds.
    Prefailed,
    /// The condition to clear it holds.
    Prepassed,
    /// Neither: the report stays as it is, and both times start anew.
    Undecided,
    /// Nothing was seen: neither time runs on.
    NoData,
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Debouncer {
    active: bool,
    /// Seconds of evidence for and against in a row.
    prefailed_s: f64,
    prepassed_s: f64,
    /// When the evidence for it began, and when it was set.
    since_s: f64,
    reported_s: f64,
}

impl Debouncer {
    pub(crate) fn new() -> Self {
        Self { active: false, prefailed_s: 0.0, prepassed_s: 0.0, since_s: f64::NAN, reported_s: f64::NAN }
    }

    /// Takes what the last `step_s` seconds until `time_s` spoke for; true while the report is set.
    pub(crate) fn update(
        &mut self,
        time_s: f64,
        step_s: f64,
        evidence: Evidence,
        patience: DebounceTimes,
    ) -> bool {
        match evidence {
            Evidence::Prefailed => {
                if self.prefailed_s <= 0.0 && !self.active {
                    self.since_s = time_s - step_s;
                }
                self.prefailed_s += step_s;
                self.prepassed_s = 0.0;
            }
            Evidence::Prepassed => {
                self.prepassed_s += step_s;
                self.prefailed_s = 0.0;
            }
            Evidence::Undecided => (self.prefailed_s, self.prepassed_s) = (0.0, 0.0),
            Evidence::NoData => {}
        }
        if !self.active && self.prefailed_s > 0.0 && self.prefailed_s + ROUNDING_S >= patience.set_s {
            self.active = true;
            self.reported_s = time_s;
        } else if self.active && self.prepassed_s > 0.0 && self.prepassed_s + ROUNDING_S >= patience.clear_s {
            self.active = false;
        }
        self.active
    }

    pub(crate) fn is_active(&self) -> bool {
        self.active
    }

    /// Whether anything speaks for it, set or not.
    pub(crate) fn is_suspected(&self) -> bool {
        self.active || self.prefailed_s > 0.0
    }

    /// When the evidence began, in s; means something only while the report is set.
    pub(crate) fn since_s(&self) -> f64 {
        self.since_s
    }

    /// When it was set, in s; means something only while the report is set.
    pub(crate) fn reported_s(&self) -> f64 {
        self.reported_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: DebounceTimes = DebounceTimes { set_s: 2.0, clear_s: 3.0 };

    fn run(debouncer: &mut Debouncer, from_s: f64, to_s: f64, evidence: Evidence) -> bool {
        let steps = ((to_s - from_s) / 0.5).round() as u32;
        let mut active = false;
        for i in 1..=steps {
            active = debouncer.update(from_s + 0.5 * f64::from(i), 0.5, evidence, PATIENCE);
        }
        active
    }

    #[test]
    fn a_word_needs_its_time_and_keeps_through_doubt() {
        let mut debouncer = Debouncer::new();
        assert!(!run(&mut debouncer, 0.0, 1.5, Evidence::Prefailed));
        assert!(!run(&mut debouncer, 1.5, 2.0, Evidence::Undecided));
        assert!(!run(&mut debouncer, 2.0, 3.5, Evidence::Prefailed));
        assert!(!run(&mut debouncer, 3.5, 9.0, Evidence::NoData));
        assert!(run(&mut debouncer, 9.0, 9.5, Evidence::Prefailed));
        assert_eq!((debouncer.since_s(), debouncer.reported_s()), (2.0, 9.5));
        assert!(run(&mut debouncer, 9.5, 12.0, Evidence::Prepassed));
        assert!(run(&mut debouncer, 12.0, 12.5, Evidence::Undecided));
        assert!(run(&mut debouncer, 12.5, 15.0, Evidence::Prepassed));
        assert!(!run(&mut debouncer, 15.0, 15.5, Evidence::Prepassed));
    }
}
