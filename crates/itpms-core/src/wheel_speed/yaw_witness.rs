//! Whether a yaw rate goes with the wheels, and the wheels of each axle with the bends (docs/math/wheel-speed.md, eq. 7b): a bend shows in the wheels of both axles, a tire in those of
//! one. A sensor that is dead, turned round or another signal would make every bend a loss of the tires on its outer side. Wheels that a differential
//! couples turn alike in all but sharp bends, whatever their tires.

use super::block::{BLOCK_S, Block};
use super::config::{DrivenAxle, WheelSpeedConfig};
use super::state::{FRONT, REAR, SCALE};
use crate::memory::Blank;
use crate::real::Real;
use crate::wheel_speed::Tuning;

/// By how much the offset that is taken off a sensor may be another one than is known, in rad/s.
const BIAS_STEP: f64 = 1e-3;
/// Each time that it is doubted four times as much has to prove it right, up to the fifth.
const MOST_DOUBTS: u8 = 5;

#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct YawWitness<T> {
    /// What the sensor usually leaves of the ratio of the front wheels and of the rear ones, as tires of unequal size do at any speed, and
    /// the usual ratios.
    usual: [T; 4],
    /// The usual inverse of the speed, in s/m.
    usual_slowness: T,
    /// The sensor's offset that was taken off, in rad/s.
    bias_rad_s: T,
    begun: bool,
    /// Sum of the axles' product that the sensor leaves unexplained beyond its share, from [`yaw_left`](Tuning::yaw_left) to as much evidence for the sensor.
    left: T,
    doubted: bool,
    doubts: u8,
    /// Sums of each axle's response to wide bends, and of the bends.
    usual_wide: [[T; 2]; 2],
    followed: [T; 2],
    bends: [T; 2],
    free: [bool; 2],
    coupled: [bool; 2],
}

impl<T: Real> YawWitness<T> {
    /// Whether the sensor was found to go against the wheels.
    pub(super) fn is_doubted(&self) -> bool {
        self.doubted
    }

    /// The sensor was found to go against the wheels on an earlier drive: bends have to prove it right.
    pub(super) fn doubt(&mut self) {
        (self.doubted, self.doubts) = (true, self.doubts.max(1));
    }

    /// The axles whose wheels were found to turn freely.
    pub(super) fn free(&self) -> [bool; 2] {
        self.free
    }

    /// The axles whose wheels were found to turn alike in wide bends.
    pub(super) fn coupled(&self) -> [bool; 2] {
        self.coupled
    }

    /// The next block does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.begun = false;
    }

    /// Takes a block, with the sensor's offset as far as it is known, and by how much left and right of each axle may slip unequally, in
    /// thousandths; whether the sensor is doubtful from here on, or not any more.
    pub(super) fn take(
        &mut self,
        block: &Block<T>,
        config: &WheelSpeedConfig<T>,
        (bias_rad_s, bias_sd_rad_s): (T, T),
        slip_1e3: [T; 2],
    ) -> bool {
        let (tuning, v) = (config.tuning(), block.speed_m_s);
        let (usual_step, [_, memory_s, _]) = (T::lit(BLOCK_S / tuning.usual_s), tuning.memory_s);
        let usable = v > T::lit(tuning.least_speed_m_s) && !block.braking;
        let Some(sensor) = block.yaw_rate_rad_s.filter(|_| usable) else { return false };
        let (track_front, track_rear) = (config.track_front_m, config.track_rear_m);
        if !((bias_rad_s - self.bias_rad_s).abs() < T::lit(BIAS_STEP)) {
            // Better known than before: what was usual with another offset is not comparable.
            (self.bias_rad_s, self.begun) = (bias_rad_s, false);
        }
        let bias_rad_s = self.bias_rad_s;
        let way = |track_m: T| T::lit(SCALE) * track_m * (sensor - bias_rad_s) / v;
        let (front, rear) = (block.ratio[FRONT], block.ratio[REAR]);
        // Ratios, not yaw rates: at another speed a radius is another yaw rate, and the same ratio.
        let now = [front + way(track_front), rear + way(track_rear), front, rear];
        if !self.begun {
            (self.usual, self.usual_slowness, self.begun) = (now, (T::one() / v), true);
            return false;
        }
        let mut beyond = now;
        for (beyond, usual) in beyond.iter_mut().zip(&mut self.usual) {
            *beyond -= *usual;
            *usual += usual_step * *beyond;
        }
        let [left_front, left_rear, front, rear] = beyond;
        let coupled = self.coupled;
        if !self.doubted && (sensor - bias_rad_s).abs() * T::lit(tuning.wide_m) < v {
            let widest = [track_front, track_rear].map(|track_m| T::lit(SCALE / tuning.wide_m) * track_m);
            self.follow([(now[2], now[2] - now[0]), (now[3], now[3] - now[1])], widest, tuning);
        }
        let per_square = v * v / (T::lit(SCALE * SCALE) * track_front * track_rear);
        let [off, by_load] = tuning.yaw_off.map(T::lit);
        let share = off + by_load * v * v / track_rear;
        let seen = (front * rear).at_least(T::zero());
        // Where both axles are coupled, bends show in neither.
        let shown = !(config.limited_slip && config.driven == DrivenAxle::Both);
        let beyond = left_front * left_rear - share * share * seen;
        // A road that differs from left to right, under wheels that slip the more so, says nothing.
        // Nor does an offset that is not known yet, at another speed.
        let slower = (T::one() / v) - self.usual_slowness;
        self.usual_slowness += usual_step * slower;
        let by_bias = T::lit(SCALE) * track_rear * bias_sd_rad_s * slower.abs();
        let [front, rear] = slip_1e3.map(|slip| T::lit(tuning.sides) + slip + by_bias);
        let beyond = beyond - beyond.at_least(-front * rear).at_most(front * rear);
        let beyond = if shown { per_square * beyond } else { T::zero() };
        let most = T::lit(tuning.yaw_left);
        let proof = most * T::whole(1 << (2 * self.doubts.min(MOST_DOUBTS)));
        self.left = (T::lit(1.0 - BLOCK_S / memory_s) * self.left + beyond).at_least(-proof).at_most(most);
        let before = self.doubted;
        if !(self.left < most) {
            self.doubted = true;
        } else if !(self.left > -proof) {
            self.doubted = false;
        }
        if self.doubted && !before {
            self.doubts = self.doubts.saturating_add(1).min(MOST_DOUBTS);
        }
        self.doubted != before || self.coupled != coupled
    }

    /// Each axle's ratio in a wide bend, and what the bend makes of one whose wheels are free; both from what they usually are in wide bends,
    /// which is not what it is on leaving a sharp one. What leaves more than the widest bend could is a tire that bursts: usual from then on.
    fn follow(&mut self, axles: [(T, T); 2], widest: [T; 2], tuning: &Tuning) {
        let ([_, _, memory_s], [least_bends, _]) = (tuning.memory_s, tuning.bends_seen);
        let (usual_step, kept) = (T::lit(BLOCK_S / tuning.usual_s), T::lit(1.0 - BLOCK_S / memory_s));
        let [free, coupled] = tuning.followed.map(T::lit);
        for (i, (ratio, expected)) in axles.into_iter().enumerate() {
            let [usual_ratio, usual_expected] = &mut self.usual_wide[i];
            let (ratio, expected) = (ratio - *usual_ratio, expected - *usual_expected);
            if (ratio - expected).abs() > widest[i] {
                *usual_ratio += ratio - expected;
                continue;
            }
            *usual_ratio += usual_step * ratio;
            *usual_expected += usual_step * expected;
            self.followed[i] = kept * self.followed[i] + ratio * expected;
            self.bends[i] = kept * self.bends[i] + expected * expected;
            if self.bends[i] > T::lit(least_bends) {
                self.free[i] = self.followed[i] > free * self.bends[i];
                self.coupled[i] = self.followed[i] < coupled * self.bends[i];
            }
        }
    }
}
