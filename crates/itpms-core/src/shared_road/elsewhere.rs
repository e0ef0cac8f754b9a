//! A speed signal whose scale changes on the way, as when a bus changes from one source to another: the rear axle meets the
//! front's road elsewhere than it was believed to, farther off than the constraint is linear, and no frame would find it back for a
//! minute. Both sides then look for it, and if they find it at the same place, what was believed before is believed again, with the new
//! scale (docs/math/shared-road.md, section 4).

use super::acquire::Found;
use super::mode::Mode;
use super::parameters::{SKEW, SKEW_UNIT_S, WHEELBASE};
use super::track::Track;
use super::{FOUND_SD_S, SharedRoad};
use crate::car::Learned;
use crate::real::Real;

/// Change of wheelbase over speed that counts, and by how much both sides may differ in it: in a bend the way of the inner side is
/// shorter and that of the outer one is longer.
const FAR: f64 = 0.015;
const ALIKE: f64 = 0.01;
/// Seconds between what both sides find.
const FRESH_S: f64 = 7.0;

/// Where a side found the other axle's road, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Elsewhere<T> {
    time_s: f64,
    found: Found<T>,
}

impl<T: Real> Elsewhere<T> {
    /// By how much wheelbase over speed is more than it was `before`, if the side's skew is what it was then.
    fn change(&self, side: usize, before: &Mode<T>) -> T {
        let Found { later_s, delay_s, used: [wheelbase, skew] } = self.found;
        let later_s = later_s - T::lit(SKEW_UNIT_S) * (before.mean[SKEW + side] - skew);
        wheelbase + later_s / delay_s - before.mean[WHEELBASE]
    }
}

impl<T: Real> SharedRoad<T> {
    /// Takes note of where a side has found the other axle's road.
    pub(super) fn look_elsewhere(&mut self, side: usize, found: Found<T>, time_s: f64) {
        self.elsewhere[side] = Some(Elsewhere { time_s, found });
        let ([Some(left), Some(right)], Some(before)) = (&self.elsewhere, self.before()) else { return };
        let changes = [left.change(0, before), right.change(1, before)];
        let Some(change) = agreed(changes, (left.time_s - right.time_s).abs()) else { return };
        let value = before.mean[WHEELBASE] + change;
        let sd = T::lit(FOUND_SD_S) / left.found.delay_s.min(right.found.delay_s);
        self.go_back();
        self.modes.begin_with(WHEELBASE, &Learned { value, sd }, T::zero(), T::one());
        self.keep_anew();
        self.elsewhere = [None; 2];
        self.tracks.iter_mut().for_each(Track::begin_elsewhere);
    }
}

/// The change that both sides agree on, if it is one; they found it so many seconds apart.
fn agreed<T: Real>([left, right]: [T; 2], apart_s: f64) -> Option<T> {
    let change = T::lit(0.5) * (left + right);
    let agree = apart_s < FRESH_S && (left - right).abs() < T::lit(ALIKE);
    (agree && change.abs() > T::lit(FAR)).then_some(change)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_agree_on_a_scale_and_not_on_a_bend() {
        assert_eq!(agreed([0.052, 0.048], 3.0), Some(0.05));
        assert_eq!(agreed([-0.04, -0.04], 0.0), Some(-0.04));
        // A radius of 20 m: one side's way is 4 % shorter and the other's 4 % longer.
        assert_eq!(agreed([-0.04, 0.04], 0.0), None);
        // One side alone beside the track, what frames find by themselves, long ago, and nothing at all.
        assert_eq!(agreed([0.05, 0.0], 0.0), None);
        assert_eq!(agreed([0.01, 0.011], 0.0), None);
        assert_eq!(agreed([0.05, 0.05], 20.0), None);
        for changes in [[f64::NAN, 0.05], [0.05, f64::NAN], [f64::INFINITY; 2]] {
            assert_eq!(agreed(changes, 0.0), None);
        }
        assert_eq!(agreed([0.05, 0.05], f64::NAN), None);
    }
}
