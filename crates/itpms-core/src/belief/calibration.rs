//! A reset: all tires have just been set to their placard pressures, and keep them for a while.

use crate::belief::state::{State, TIRE};
use crate::inter_axle::{ENOUGH_S, SharedRoad};
use crate::real::Real;

/// Sd of a tire's compliance, over that at placard pressure, when somebody may have set it anew.
const SET_ANEW_SD: f64 = 0.2;
/// Sd with which a reset sets a tire, as a share of the placard pressure.
const RESET_SD: f64 = 0.004;
/// Seconds of shared road learned from in a reset after which tires may move all the same.
const HELD_ENOUGH_S: f64 = 6.0;

impl<T: Real> SharedRoad<T> {
    /// A reset begins: somebody has just set all tires to their placard pressures. What the one before has taught is what
    /// an earlier reset has taught, from now on.
    pub(crate) fn begin_calibration(&mut self) {
        self.loaded = self.learned().or(self.loaded);
        self.calibration_result = None;
        (self.calibrated, self.calibrating) = (true, true);
        self.set_tires();
    }

    /// The tires have their placard pressures now: what was believed of them before does not matter, nor of what goes with
    /// it.
    pub(crate) fn set_tires(&mut self) {
        self.calibrating_from_s = self.learned_s;
        self.bank.collapse();
        (self.kept, self.pre_fault) = ([None, None], [None; 4]);
        (0..4).for_each(|corner| self.set_tire(corner));
    }

    /// One of them.
    pub(crate) fn set_tire(&mut self, corner: usize) {
        self.bank.forget_tire(corner, T::lit(SET_ANEW_SD));
        let sd = T::lit(RESET_SD) * self.scale.share(corner);
        self.bank.update(sd * sd, |state| {
            let mut slope = State::zeros();
            slope[TIRE + corner] = T::one();
            (slope, -state[TIRE + corner])
        });
    }

    /// Says that a reset goes on, or that it is over or there was none.
    pub(crate) fn hold(&mut self, calibrating: bool) {
        if self.calibrating && !calibrating {
            self.store_calibration();
        }
        self.calibrating = calibrating;
    }

    /// Whether the car is known well enough for a surprise to be a tire that moves; in a reset, for one to be punctured.
    pub(crate) fn is_learned(&self) -> bool {
        self.learned_s >= if self.calibrating { self.calibrating_from_s + HELD_ENOUGH_S } else { ENOUGH_S }
    }
}
