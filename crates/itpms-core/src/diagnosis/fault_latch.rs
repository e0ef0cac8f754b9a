//! A fault that it takes several sensors to tell, debounced, with what it would be called; and how a corner looks in the hop band.

use crate::diagnosis::debounce::{DebounceTimes, Debouncer, Evidence};
use crate::diagnosis::{Fault, Malfunction};
use crate::memory::{Blank, Placed};
use crate::real::Real;

/// Signals of a corner's sensors in the hop band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum SwapPattern {
    #[blank]
    AsLabeled,
    /// The body moves as a wheel does.
    BodyIsWheel,
    /// The wheel moves as a body does.
    WheelIsBody,
    Crossed,
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FaultLatch<T: Real> {
    pub(crate) debouncer: Debouncer,
    pub(crate) malfunction: Placed<Malfunction<T>>,
}

impl<T: Real> FaultLatch<T> {
    pub(crate) fn new() -> Self {
        Self { debouncer: Debouncer::new(), malfunction: Placed::BLANK }
    }

    /// Takes evidence for this malfunction. Once reported, it stays what it was called.
    pub(crate) fn update(
        &mut self,
        [time_s, step_s]: [f64; 2],
        evidence: Evidence,
        patience: DebounceTimes,
        malfunction: impl FnOnce() -> Malfunction<T>,
    ) {
        if !self.debouncer.is_active() && evidence == Evidence::Prefailed {
            self.malfunction.set(Some(malfunction()));
        }
        self.debouncer.update(time_s, step_s, evidence, patience);
    }

    /// Forgets what speaks for it, if that is not enough to say it.
    pub(crate) fn drop_suspicion(&mut self) {
        if !self.debouncer.is_active() {
            self.debouncer = Debouncer::new();
        }
    }

    /// The report, while it lasts.
    pub(crate) fn fault(&self) -> Option<Fault<T>> {
        let malfunction = self.malfunction.get().filter(|_| self.debouncer.is_active())?;
        Some(Fault::from_debouncer(&self.debouncer, malfunction))
    }
}
