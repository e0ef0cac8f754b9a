//! A word about several sensors, what would be said, and how a corner looks in the hop band.

use crate::diagnosis::debounce::{Evidence, Latch, Patience};
use crate::diagnosis::{Fault, Malfunction};
use crate::real::Real;

/// What the sensors of a corner look like in the hop band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Looks {
    Right,
    /// The body moves as a wheel does.
    BodyIsWheel,
    /// The wheel moves as a body does.
    WheelIsBody,
    /// Both.
    Crossed,
}

/// A latch and what it would say.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Word<T> {
    pub(crate) latch: Latch,
    pub(crate) malfunction: Option<Malfunction<T>>,
}

impl<T: Real> Word<T> {
    pub(crate) fn new() -> Self {
        Self { latch: Latch::new(), malfunction: None }
    }

    /// Takes evidence for this malfunction. Once said, it stays what it was called.
    pub(crate) fn update(
        &mut self,
        [time_s, step_s]: [f64; 2],
        evidence: Evidence,
        patience: Patience,
        malfunction: impl FnOnce() -> Malfunction<T>,
    ) {
        if !self.latch.is_said() && evidence == Evidence::For {
            self.malfunction = Some(malfunction());
        }
        self.latch.update(time_s, step_s, evidence, patience);
    }

    /// Forgets what speaks for it, if that is not enough to say it.
    pub(crate) fn drop_suspicion(&mut self) {
        if !self.latch.is_said() {
            self.latch = Latch::new();
        }
    }

    /// What is said, while it is.
    pub(crate) fn fault(&self) -> Option<Fault<T>> {
        let malfunction = self.malfunction.filter(|_| self.latch.is_said())?;
        Some(Fault::said_by(&self.latch, malfunction))
    }
}
