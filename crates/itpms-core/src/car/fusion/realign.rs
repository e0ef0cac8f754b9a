//! Realignment: a speed signal whose scale changes on the way, as when a bus changes from one source to another, makes the rear axle
//! meet the front's road at another delay than believed, farther off than the residual is linear, and no frame would find it again for a
//! minute. Both sides then search for the delay. If they find the same deviation, the belief is restored from before the change, with
//! the new scale; if it grows with the acceleration, the speed is late (docs/math/shared-road.md, section 2).

use super::{FOUND_SD_S, Fusion};
use crate::belief::Hypothesis;
use crate::belief::state::{SKEW, SKEW_UNIT_S, TIRE, WHEELBASE};
use crate::inter_axle::alignment::axle_pair::AxlePair;
use crate::inter_axle::alignment::delay_search::Found;
use crate::inter_axle::alignment::speed_latency::{Find, Latency, SpeedLatency};
use crate::memory::Blank;
use crate::model::{Learned, Side};
use crate::real::Real;

/// Change of wheelbase over speed that counts, and by how much both sides may differ in it: in a bend the way of the inner side is
/// shorter and that of the outer one is longer.
const FAR: f64 = 0.015;
const ALIKE: f64 = 0.01;
/// Seconds between what both sides find; and within which they found it at the same acceleration.
const FRESH_S: f64 = 7.0;
const TOGETHER_S: f64 = 1.0;
/// Sd by which a tire's compliance may be wrong where the speed was late.
const DOUBTED_SD: f64 = 0.05;

/// Where a side found the other axle's road, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct DelayDetection<T> {
    time_s: f64,
    found: Found<T>,
}

impl<T: Real> DelayDetection<T> {
    /// Wheelbase over speed that goes with it, if the side's skew is what it was `before`.
    fn rho(&self, side: Side, before: &Hypothesis<T>) -> T {
        let [wheelbase, skew] = self.found.used;
        let later_s = self.found.later_s - T::lit(SKEW_UNIT_S) * (before.mean[SKEW + side.index()] - skew);
        wheelbase + later_s / self.found.delay_s
    }
}

impl<T: Real> Fusion<T> {
    /// Takes note of where a side has found the other axle's road.
    #[inline(never)]
    pub(super) fn realign(&mut self, side: Side, found: Found<T>, time_s: f64) {
        self.detections[side] = Some(DelayDetection { time_s, found });
        let ([Some(left), Some(right)], Some(before)) = (self.detections, self.belief.restore_point()) else {
            return;
        };
        let [by_left, by_right] = [left.rho(Side::Left, before), right.rho(Side::Right, before)];
        let apart_s = (left.time_s - right.time_s).abs();
        let Some(rho) = agreed([by_left, by_right], apart_s) else { return };
        let changed = (rho - before.mean[WHEELBASE]).abs() > T::lit(FAR);
        let together = apart_s < TOGETHER_S;
        if changed || together {
            self.detections = [None; 2];
        }
        // Of the same moment, so at one acceleration.
        let lag = if together { self.speed_latency.take(&both(&left.found, &right.found)) } else { None };
        if let Some(lag) = lag {
            self.correct(&lag);
        } else if changed {
            self.queue.clear();
            let sd = T::lit(FOUND_SD_S) / left.found.delay_s.min(right.found.delay_s);
            self.restore();
            self.belief.set_quantity(WHEELBASE, &Learned { value: rho, sd }, T::one());
            self.checkpoint_anew();
            self.inter_axle.pairs.iter_mut().for_each(AxlePair::restart_alignment);
        }
    }

    /// The speed comes late, and did so all the time: what was learned of the car meanwhile is worth little, and of the tires less than it
    /// seemed.
    fn correct(&mut self, lag: &Latency<T>) {
        self.queue.clear();
        self.inter_axle.add_speed_latency(lag.seconds);
        self.speed_latency = SpeedLatency::BLANK;
        let tires = self.belief.restore_point().map(|before| {
            let variance =
                |i: usize| before.covariance[(TIRE + i, TIRE + i)] + T::lit(DOUBTED_SD * DOUBTED_SD);
            core::array::from_fn::<_, 4, _>(|i| Learned {
                value: before.mean[TIRE + i],
                sd: variance(i).sqrt(),
            })
        });
        self.belief.restart();
        // During a calibration they are what they were set to.
        let calibrating = self.belief.is_calibrating();
        for (i, tire) in tires.iter().flatten().enumerate().filter(|_| !calibrating) {
            self.belief.set_quantity(TIRE + i, tire, T::one());
        }
        let learned = |[value, sd]: [T; 2]| Learned { value, sd };
        self.belief.set_quantity(WHEELBASE, &learned(lag.rho), T::one());
        for side in 0..2 {
            self.belief.set_quantity(SKEW + side, &learned(lag.skew_s), T::lit(SKEW_UNIT_S));
        }
        self.inter_axle.pairs.iter_mut().for_each(AxlePair::forget_ways);
    }
}

/// Findings of both sides at the same moment.
fn both<T: Real>(left: &Found<T>, right: &Found<T>) -> Find<T> {
    let mean = |of: &dyn Fn(&Found<T>) -> T| T::lit(0.5) * (of(left) + of(right));
    Find {
        later: mean(&|found| {
            found.used[0] + (found.later_s + T::lit(SKEW_UNIT_S) * found.used[1]) / found.delay_s
        }),
        delay_s: mean(&|found| found.delay_s),
        growth_per_s: mean(&|found| found.stretch / found.delay_s),
    }
}

/// The common finding of both sides, made so many seconds apart.
fn agreed<T: Real>([left, right]: [T; 2], apart_s: f64) -> Option<T> {
    let agree = apart_s < FRESH_S && (left - right).abs() < T::lit(ALIKE);
    agree.then(|| T::lit(0.5) * (left + right))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_agree_on_a_scale_and_not_on_a_bend() {
        assert_eq!(agreed([0.0625, 0.0605], 3.0), Some(0.0615));
        assert_eq!(agreed([-0.04, -0.04], 0.0), Some(-0.04));
        // A radius of 20 m: one side's way is 4 % shorter and the other's 4 % longer.
        assert_eq!(agreed([-0.04, 0.04], 0.0), None);
        // One side alone beside the track, long ago, and nothing at all.
        assert_eq!(agreed([0.05, 0.0], 0.0), None);
        assert_eq!(agreed([0.05, 0.05], 20.0), None);
        for [left, right] in [[f64::NAN, 0.05], [0.05, f64::NAN], [f64::INFINITY; 2]] {
            assert_eq!(agreed([left, right], 0.0), None);
        }
        assert_eq!(agreed([0.05, 0.05], f64::NAN), None);
    }
}
