//! Checkpoints of the belief, to restore when a sensor turns out not to be trusted: that its gain has changed, or that it carries
//! another one's name, shows only after seconds, and for so long it was learned from.

use super::gaussian::Hypothesis;
use super::state::{LEVEL, TIRE};
use super::{Belief, LONGEST_PAUSE_S};
use crate::conditioning::pauses::PAUSE_S;
use crate::memory::{Blank, Placed};
use crate::model::{Corner, Learned, SURELY_SD};
use crate::real::Real;

/// Seconds between two checkpoints: the one that is restored is once to twice as old. A gain that changes at once is noticed
/// within three seconds, sensors that change places within six.
const INTERVAL_S: f64 = 6.0;

/// The belief at a time, as one Gaussian.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Checkpoint<T: Real> {
    time_s: f64,
    belief: Hypothesis<T>,
    learned_s: f64,
}

/// A tire's compliance before its own sensors were suspected.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PreFaultEstimate<T> {
    pub(super) compliance: Learned<T>,
    since_s: f64,
}

impl<T: Real> PreFaultEstimate<T> {
    /// Whether frames of this time tell what the tire is: those under way when its sensors were taken away do not.
    pub(super) fn is_settled(&self, time_s: f64) -> bool {
        // Frames may still come for a while after a sensor was taken away.
        !(time_s - self.since_s < PAUSE_S)
    }
}

impl<T: Real> Checkpoint<T> {
    /// By how much a quantity has changed, if learning alone could not have made it do so.
    fn contradicted(&self, now: &Hypothesis<T>, i: usize) -> Option<T> {
        let change = now.mean[i] - self.belief.mean[i];
        let far = change * change > T::lit(SURELY_SD * SURELY_SD) * self.belief.covariance[(i, i)];
        far.then_some(change.abs())
    }

    /// A tire's compliance and its variance.
    fn tire(&self, corner: Corner) -> (T, T) {
        let at = TIRE + corner.index();
        (self.belief.mean[at], self.belief.covariance[(at, at)])
    }

    /// Whether anything has changed but the `suspected` corners' own tires: one that has lost its air is easily taken for a
    /// faulty sensor, and a faulty sensor makes the other tire of its side look so.
    fn is_contradicted_by(&self, now: &Hypothesis<T>, suspected: [bool; 4]) -> bool {
        let own = |i: usize| (TIRE..TIRE + 4).contains(&i) && suspected[i - TIRE];
        (0..LEVEL).filter(|&i| !own(i)).any(|i| self.contradicted(now, i).is_some())
    }
}

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

    pub(super) fn drop_checkpoints(&mut self) {
        self.checkpoints.iter_mut().for_each(Placed::clear);
    }

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

    /// For some seconds a sensor of a `suspected` corner may have been wrong: restores the older checkpoint, if what is
    /// believed now contradicts it. Gives its time if it did.
    #[inline(never)]
    pub(crate) fn rollback(&mut self, suspected: [bool; 4]) -> Option<f64> {
        let saved = older(&self.checkpoints)?;
        let mut now = Hypothesis::BLANK;
        self.bank.as_one(&mut now);
        if !saved.is_contradicted_by(&now, suspected) {
            // A suspected corner's own tire may be what it was or what it seems to be now. If its sensors turn out to be
            // faulty, what it was counts, however little of the error had been learned by now.
            for corner in Corner::ALL.into_iter().filter(|&corner| suspected[corner]) {
                let (value, variance) = saved.tire(corner);
                let compliance = Learned { value, sd: variance.max(T::zero()).sqrt() };
                self.pre_fault[corner] = Some(PreFaultEstimate { compliance, since_s: self.time_s });
                if let Some(change) = saved.contradicted(&now, TIRE + corner.index()) {
                    self.bank.inflate_tire(corner, change);
                }
            }
            return None;
        }
        let side_trusted = |corner: Corner| !suspected[corner] && !suspected[corner.same_side()];
        let changes = Corner::ALL.map(|corner| saved.contradicted(&now, TIRE + corner.index()));
        let restored_s = self.restore();
        // Another tire that has changed may really have lost its air, with a sensor that is faulty or only seems to be: it may
        // be what it was or what it is now. On a side whose sensors are all trusted the latter is likelier, and frames go on.
        for corner in Corner::ALL.into_iter().filter(|&corner| !suspected[corner]) {
            let Some(change) = changes[corner] else { continue };
            if side_trusted(corner) {
                let at = TIRE + corner.index();
                let (value, sd) = (now.mean[at], T::zero());
                self.bank.set_quantity(at, &Learned { value, sd }, change, T::one());
            } else {
                self.bank.inflate_tire(corner, change);
            }
        }
        restored_s
    }
}

/// The one to restore, of the newest and the one before it.
fn older<T: Real>([newest, before]: &[Placed<Checkpoint<T>>; 2]) -> Option<&Checkpoint<T>> {
    before.as_ref().or(newest.as_ref())
}
