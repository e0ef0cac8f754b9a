//! Checkpoints of the belief, to restore when front and rear turn out to have been compared at the wrong place: it shows only after
//! seconds, and for so long it was learned from.

use super::gaussian::Hypothesis;
use super::{Belief, LONGEST_PAUSE_S};
use crate::memory::{Placed, blank};
use crate::real::Real;

/// Seconds between two checkpoints: the one that is restored is once to twice as old.
const INTERVAL_S: f64 = 6.0;
/// The belief at a time, as one Gaussian.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Checkpoint<T: Real> {
    time_s: f64,
    belief: Hypothesis<T>,
    learned_s: f64,
}

blank!(Checkpoint<T> { time_s, belief, learned_s });

impl<T: Real> Belief<T> {
    /// Saves what is believed now, if that was not done within [`INTERVAL_S`]; gives the time of a new checkpoint.
    pub(crate) fn checkpoint(&mut self) -> Option<f64> {
        let [newest, _] = &self.checkpoints;
        let newest_s = newest.as_ref().map_or(f64::NEG_INFINITY, |saved| saved.time_s);
        if self.time_s - newest_s < INTERVAL_S {
            return None;
        }
        // The older one's place is the new one's.
        self.checkpoints.swap(0, 1);
        let [newest, _] = &mut self.checkpoints;
        newest.place(|now| {
            (now.time_s, now.learned_s) = (self.time_s, self.learned_s);
            self.bank.as_one(&mut now.belief);
        });
        Some(self.time_s)
    }

    /// Nothing is to be restored.
    pub(super) fn drop_checkpoints(&mut self) {
        self.checkpoints.iter_mut().for_each(Placed::clear);
    }

    /// The belief that would be restored.
    pub(crate) fn restore_point(&self) -> Option<&Hypothesis<T>> {
        older(&self.checkpoints).map(|saved| &saved.belief)
    }

    /// Restores the older checkpoint, as old as it is by now; gives its time.
    pub(crate) fn restore(&mut self) -> Option<f64> {
        let saved = older(&self.checkpoints)?;
        self.bank.set(&saved.belief);
        let seconds = (self.time_s - saved.time_s).clamp(0.0, LONGEST_PAUSE_S);
        self.bank.predict_gap(T::lit(seconds), false);
        self.learned_s = saved.learned_s;
        let (saved_s, learned_s) = (saved.time_s, saved.learned_s);
        if self.losses.since_s().is_some_and(|since_s| since_s > saved_s) {
            self.losses.end(learned_s);
        }
        Some(saved_s)
    }

    /// Drops the checkpoints and saves what is believed now: nothing is restored twice. Gives the time of the new one.
    pub(crate) fn checkpoint_anew(&mut self) -> Option<f64> {
        self.drop_checkpoints();
        self.checkpoint()
    }
}

/// The one to restore, of the newest and the one before it.
fn older<T: Real>([newest, before]: &[Placed<Checkpoint<T>>; 2]) -> Option<&Checkpoint<T>> {
    before.as_ref().or(newest.as_ref())
}
