//! Debouncing: a word that is said when a condition has held for a while, and taken back when another one has.

/// How long a condition has to hold, in s.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patience {
    /// Before the word is said.
    pub(crate) raise_s: f64,
    /// Before it is taken back.
    pub(crate) clear_s: f64,
}

/// What speaks for or against the word now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Evidence {
    /// It holds.
    For,
    /// It is over.
    Against,
    /// Neither: whatever was said stays said, and nothing new is.
    Neither,
    /// Nothing was seen: time stands still.
    Nothing,
}

/// A word with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Latch {
    said: bool,
    /// Seconds of evidence for and against in a row.
    for_s: f64,
    against_s: f64,
    /// When the evidence for it began, and when it was said.
    since_s: f64,
    said_s: f64,
}

impl Latch {
    pub(crate) fn new() -> Self {
        Self { said: false, for_s: 0.0, against_s: 0.0, since_s: f64::NAN, said_s: f64::NAN }
    }

    /// Takes what the last `step_s` seconds until `time_s` spoke for; true while the word stands.
    pub(crate) fn update(
        &mut self,
        time_s: f64,
        step_s: f64,
        evidence: Evidence,
        patience: Patience,
    ) -> bool {
        match evidence {
            Evidence::For => {
                if self.for_s <= 0.0 && !self.said {
                    self.since_s = time_s - step_s;
                }
                self.for_s += step_s;
                self.against_s = 0.0;
            }
            Evidence::Against => {
                self.against_s += step_s;
                self.for_s = 0.0;
            }
            Evidence::Neither => (self.for_s, self.against_s) = (0.0, 0.0),
            Evidence::Nothing => {}
        }
        // Steps add up with rounding.
        const SLACK_S: f64 = 1e-6;
        if !self.said && self.for_s > 0.0 && self.for_s + SLACK_S >= patience.raise_s {
            self.said = true;
            self.said_s = time_s;
        } else if self.said && self.against_s > 0.0 && self.against_s + SLACK_S >= patience.clear_s {
            self.said = false;
        }
        self.said
    }

    /// Whether the word stands.
    pub(crate) fn is_said(&self) -> bool {
        self.said
    }

    /// Whether anything speaks for it, said or not.
    pub(crate) fn is_suspected(&self) -> bool {
        self.said || self.for_s > 0.0
    }

    /// When the evidence began, in s; means something only while the word stands.
    pub(crate) fn since_s(&self) -> f64 {
        self.since_s
    }

    /// When it was said, in s; means something only while the word stands.
    pub(crate) fn said_s(&self) -> f64 {
        self.said_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Patience = Patience { raise_s: 2.0, clear_s: 3.0 };

    fn run(latch: &mut Latch, from_s: f64, to_s: f64, evidence: Evidence) -> bool {
        let steps = ((to_s - from_s) / 0.5).round() as u32;
        let mut said = false;
        for i in 1..=steps {
            said = latch.update(from_s + 0.5 * f64::from(i), 0.5, evidence, PATIENCE);
        }
        said
    }

    #[test]
    fn a_word_needs_its_time_and_keeps_through_doubt() {
        let mut latch = Latch::new();
        assert!(!run(&mut latch, 0.0, 1.5, Evidence::For));
        assert!(!run(&mut latch, 1.5, 2.0, Evidence::Neither));
        assert!(!run(&mut latch, 2.0, 3.5, Evidence::For));
        assert!(!run(&mut latch, 3.5, 9.0, Evidence::Nothing));
        assert!(run(&mut latch, 9.0, 9.5, Evidence::For));
        assert_eq!((latch.since_s(), latch.said_s()), (2.0, 9.5));
        assert!(run(&mut latch, 9.5, 12.0, Evidence::Against));
        assert!(run(&mut latch, 12.0, 12.5, Evidence::Neither));
        assert!(run(&mut latch, 12.5, 15.0, Evidence::Against));
        assert!(!run(&mut latch, 15.0, 15.5, Evidence::Against));
    }
}
