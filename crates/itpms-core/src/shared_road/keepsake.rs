//! What was believed a while ago, to go back to when a sensor turns out not to be trusted: that its gain has changed, or that
//! it carries another one's name, shows only after seconds, and for so long it was learned from.

use super::answer::Answer;
use super::coherence::Coherence;
use super::modes::Mode;
use super::{LONGEST_PAUSE_S, SharedRoad};
use crate::real::Real;

/// Seconds between two keepsakes: what is gone back to is once to twice as old. A gain that changes at once is noticed within
/// three seconds, sensors that change places within five.
const EVERY_S: f64 = 6.0;

/// The belief at a time, as one Gaussian, and what had been learned of both sides' roads.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
struct Keepsake<T: Real> {
    time_s: f64,
    belief: Mode<T>,
    learned_s: T,
    sides: [(Answer<T>, Coherence<T>); 2],
}

/// The last two.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(super) struct Keepsakes<T: Real> {
    newest: Option<Keepsake<T>>,
    before: Option<Keepsake<T>>,
}

impl<T: Real> Keepsakes<T> {
    pub(super) fn none() -> Self {
        Self { newest: None, before: None }
    }
}

impl<T: Real> SharedRoad<T> {
    /// Keeps what is believed now, if that was not done of late.
    pub(super) fn keep(&mut self) {
        let newest_s = self.kept.newest.as_ref().map_or(f64::NEG_INFINITY, |kept| kept.time_s);
        if self.believed_s - newest_s < EVERY_S {
            return;
        }
        let now = Keepsake {
            time_s: self.believed_s,
            belief: self.modes.as_one(),
            learned_s: self.learned_s,
            sides: self.tracks.each_ref().map(|track| track.learned()),
        };
        self.kept.before = self.kept.newest.replace(now);
    }

    /// Some seconds' worth of what was learned came from a sensor that is not to be trusted: believes what it did before.
    pub(crate) fn go_back(&mut self) {
        let Some(kept) = self.kept.before.take().or(self.kept.newest.take()) else {
            return self.begin_again();
        };
        self.modes.set(&kept.belief);
        self.learned_s = kept.learned_s;
        for (track, learned) in self.tracks.iter_mut().zip(&kept.sides) {
            track.recall(learned);
        }
        let seconds = (self.believed_s - kept.time_s).clamp(0.0, LONGEST_PAUSE_S);
        self.modes.wake(T::lit(seconds), !self.held);
        self.kept = Keepsakes { newest: Some(kept), before: None };
    }
}
