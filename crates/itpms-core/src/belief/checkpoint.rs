//! What was believed a while ago, to go back to when a sensor turns out not to be trusted: that its gain has changed, or that
//! it carries another one's name, shows only after seconds, and for so long it was learned from.

use crate::belief::gaussian::Hypothesis;
use crate::belief::state::{RATE, SIZE, TIRE};
use crate::inter_axle::residual::correction::FrfCorrection;
use crate::inter_axle::{LONGEST_PAUSE_S, SharedRoad};
use crate::model::Learned;
use crate::real::Real;

/// Seconds between two keepsakes: what is gone back to is once to twice as old. A gain that changes at once is noticed within
/// three seconds, sensors that change places within six.
const EVERY_S: f64 = 6.0;
/// What is learned in twelve seconds moves a belief by less than one of its standard deviations; by so many, either a tire has
/// lost air, which is found again within a second, or a sensor has told wrong.
const CONTRADICTED: f64 = 3.0;
/// Seconds for which frames may still come after a sensor was taken away.
const SETTLING_S: f64 = 1.0;

/// The belief at a time, as one Gaussian, and how both sides' axles answered.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Checkpoint<T: Real> {
    time_s: f64,
    belief: Hypothesis<T>,
    learned_s: f64,
    frf_corrections: [FrfCorrection<T>; 2],
}

/// A tire's compliance before its own sensors were suspected.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PreFaultEstimate<T> {
    pub(crate) before: Learned<T>,
    since_s: f64,
}

impl<T: Real> PreFaultEstimate<T> {
    /// Whether frames that come at this time tell what the tire is: those under way when its sensors were taken away do not.
    pub(crate) fn is_settled(&self, time_s: f64) -> bool {
        !(time_s - self.since_s < SETTLING_S)
    }
}

impl<T: Real> Checkpoint<T> {
    /// By how much a quantity has moved, if learning alone could not have made it do so.
    fn contradicted(&self, now: &Hypothesis<T>, i: usize) -> Option<T> {
        let off = now.mean[i] - self.belief.mean[i];
        let far = off * off > T::lit(CONTRADICTED * CONTRADICTED) * self.belief.covariance[(i, i)];
        far.then_some(off.abs())
    }

    /// A tire's compliance and the variance of that.
    fn tire(&self, corner: usize) -> (T, T) {
        let at = TIRE + corner;
        (self.belief.mean[at], self.belief.covariance[(at, at)])
    }

    /// Whether anything has but the `suspected` corners' own tires: one that has lost its air is easily taken for a sensor that
    /// lies, and one that lies makes the other tire of its side look so.
    fn is_contradicted_by(&self, now: &Hypothesis<T>, onset_rates: [bool; 4]) -> bool {
        let own = |i: usize| (TIRE..TIRE + 4).contains(&i) && onset_rates[i - TIRE];
        (0..SIZE).filter(|&i| i != RATE && !own(i)).any(|i| self.contradicted(now, i).is_some())
    }
}

impl<T: Real> SharedRoad<T> {
    /// Keeps what is believed now, if that was not done of late.
    pub(crate) fn keep(&mut self) {
        let [newest, before] = &mut self.kept;
        let newest_s = newest.as_ref().map_or(f64::NEG_INFINITY, |kept| kept.time_s);
        if self.believed_s - newest_s < EVERY_S {
            return;
        }
        let now = Checkpoint {
            time_s: self.believed_s,
            belief: self.bank.as_one(),
            learned_s: self.learned_s,
            frf_corrections: self.pairs.each_ref().map(|track| track.frf_correction().clone()),
        };
        *before = newest.replace(now);
    }

    /// For some seconds a sensor of a `suspected` corner may have told wrong: believes what it did before, if what it does
    /// now contradicts that.
    pub(crate) fn rollback(&mut self, onset_rates: [bool; 4]) {
        let Some(kept) = older(&self.kept) else { return };
        let now = self.bank.as_one();
        if !kept.is_contradicted_by(&now, onset_rates) {
            // A suspected corner's own tire may be what it was or what it seems to be now: if it turns out that its sensors
            // did lie, what it was counts, however little of the lie had been believed by now: frames are still under way,
            // and what seems to move goes on unheard.
            for corner in (0..4).filter(|&corner| onset_rates[corner]) {
                let (value, variance) = kept.tire(corner);
                let before = Learned { value, sd: variance.max(T::zero()).sqrt() };
                self.pre_fault[corner] = Some(PreFaultEstimate { before, since_s: self.believed_s });
                if let Some(moved) = kept.contradicted(&now, TIRE + corner) {
                    self.bank.forget_tire(corner, moved);
                }
            }
            return;
        }
        let side_tells = |corner: usize| !onset_rates[corner] && !onset_rates[(corner + 2) % 4];
        let moved: [_; 4] = core::array::from_fn(|corner| kept.contradicted(&now, TIRE + corner));
        self.restore();
        // Another tire that has moved may really have lost its air, with a sensor that lies or one that only seems to: it may
        // be what it was or what it is now. On a side whose sensors are all trusted the latter is likelier, and frames go on.
        for corner in (0..4).filter(|&corner| !onset_rates[corner]) {
            let Some(moved) = moved[corner] else { continue };
            if side_tells(corner) {
                let (value, sd) = (now.mean[TIRE + corner], T::zero());
                self.bank.begin_with(TIRE + corner, &Learned { value, sd }, moved, T::one());
            } else {
                self.bank.forget_tire(corner, moved);
            }
        }
        self.save_anew();
    }

    /// The belief to go back to.
    pub(crate) fn before(&self) -> Option<&Hypothesis<T>> {
        older(&self.kept).map(|kept| &kept.belief)
    }

    /// Believes that, as old as it is by now.
    pub(crate) fn restore(&mut self) {
        let Some(kept) = older(&self.kept) else { return };
        self.bank.set(&kept.belief);
        for (track, frf_correction) in self.pairs.iter_mut().zip(&kept.frf_corrections) {
            track.set_frf_correction(frf_correction);
        }
        let seconds = (self.believed_s - kept.time_s).clamp(0.0, LONGEST_PAUSE_S);
        self.bank.predict_gap(T::lit(seconds), false);
        self.learned_s = kept.learned_s;
    }

    /// From here on: nothing is gone back to twice.
    pub(crate) fn save_anew(&mut self) {
        self.kept = [None, None];
        self.keep();
    }
}

/// The one to go back to, of the newest and the one before it.
fn older<T: Real>([newest, before]: &[Option<Checkpoint<T>>; 2]) -> Option<&Checkpoint<T>> {
    before.as_ref().or(newest.as_ref())
}
