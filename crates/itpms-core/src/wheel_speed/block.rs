//! Half a second of wheel speeds as three log ratios with their spread, and whether the car drove so that they can be used.

use super::config::{DrivenAxle, WheelSpeedConfig};
use super::state::{AXLE, FRONT, REAR, SCALE};
pub(super) use crate::diagnosis::BLOCK_S;
use crate::memory::Blank;
use crate::model::WheelSpeedSample;
use crate::real::Real;

/// Samples below which a block says nothing.
const LEAST_SAMPLES: u32 = 5;
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Block<T> {
    /// Front left over right, rear left over right, front over rear: `ln` of the speeds, in thousandths.
    pub ratio: [T; 3],
    /// Their standard deviations within the block.
    pub spread: [T; 3],
    /// Which of them may be used.
    pub used: [bool; 3],
    /// Whether torque hides what the wheels of front and rear roll on.
    pub hidden: [bool; 2],
    /// Mean speed in m/s.
    pub speed_m_s: T,
    /// Mean yaw rate in rad/s, if known.
    pub yaw_rate_rad_s: Option<T>,
    /// Force of the driven wheels per mass, in m/s².
    pub force_m_s2: T,
    /// By how much the speed rises, in m/s².
    pub slope_m_s2: T,
    /// Whether the force is an accelerometer's, which sees a grade.
    pub grade_seen: bool,
    /// Lateral acceleration in m/s², without sign.
    pub lateral_m_s2: T,
    /// Whether the brakes are on, which wheels of an axle follow unequally.
    pub braking: bool,
    /// Whether it may be used at all.
    pub good: bool,
}

/// Sums of the block that is being driven.
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BlockSums<T> {
    begun_s: f64,
    samples: u32,
    first: [T; 3],
    ratio: [T; 3],
    square: [T; 3],
    speed: T,
    time: T,
    time_square: T,
    time_speed: T,
    slowest: T,
    yaw: [T; 2],
    accel_x: [T; 2],
    accel_y: [T; 2],
    braked: bool,
}

impl<T: Real> Block<T> {
    /// Leaves out the ratios that a slippery road hides under this force, and those of coupled axles, whatever the torque.
    pub(super) fn hide(&mut self, coupled: [bool; 2], slip_1e3: [T; 2], sides: f64) {
        for (i, (hidden, used)) in self.hidden.iter_mut().zip(&mut self.used).enumerate() {
            *hidden |= coupled[i];
            *used &= !*hidden && slip_1e3[i] < T::lit(sides);
        }
        // Without a yaw rate only the other axle tells a bend from a tire.
        if self.yaw_rate_rad_s.is_none() && self.hidden != [false; 2] {
            self.used = [false; 3];
        }
    }
}

impl<T: Real> BlockSums<T> {
    pub(super) fn begin(&mut self, time_s: f64) {
        *self = Self { begun_s: time_s, ..Self::BLANK };
    }

    pub(super) fn is_over(&self, time_s: f64) -> bool {
        !(time_s - self.begun_s < BLOCK_S)
    }

    /// Takes in a sample with four speeds.
    pub(super) fn add(&mut self, sample: &WheelSpeedSample<T>) {
        let [fl, fr, rl, rr] = sample.wheel_speed_m_s;
        let slowest = fl.at_most(fr).at_most(rl.at_most(rr));
        let standing = !(slowest >= T::one());
        let ln = |v: T| if standing { T::zero() } else { v.ln_fast() * T::lit(SCALE) };
        let (fl_ln, fr_ln, rl_ln, rr_ln) = (ln(fl), ln(fr), ln(rl), ln(rr));
        let half = T::lit(0.5);
        let ratio = [fl_ln - fr_ln, rl_ln - rr_ln, half * ((fl_ln - rl_ln) + (fr_ln - rr_ln))];
        if self.samples == 0 {
            self.first = ratio;
            self.slowest = slowest;
        }
        for (((sum, square), first), now) in
            self.ratio.iter_mut().zip(&mut self.square).zip(&self.first).zip(ratio)
        {
            // From the first one on, so that squares do not cancel.
            let beyond = now - *first;
            *sum += beyond;
            *square += beyond * beyond;
        }
        let (speed, time) =
            (T::lit(0.25) * (fl + fr + rl + rr), T::lit(sample.time_s - self.begun_s - BLOCK_S / 2.0));
        self.samples = self.samples.saturating_add(1);
        self.speed += speed;
        self.time += time;
        self.time_square += time * time;
        self.time_speed += time * speed;
        self.slowest = self.slowest.at_most(slowest);
        count(&mut self.yaw, sample.yaw_rate());
        count(&mut self.accel_x, sample.accel_x());
        count(&mut self.accel_y, sample.accel_y());
        self.braked |= sample.brake == Some(true);
    }

    pub(super) fn stood(&self) -> bool {
        self.samples > 0 && self.speed < T::lit(0.3) * T::whole(self.samples)
    }

    /// Measurement by the block; `docs/math/wheel-speed.md`, eq. 3 and 6. `step_m_s`: the speeds' smallest step.
    pub(super) fn conclude(&self, config: &WheelSpeedConfig<T>, step_m_s: T) -> Block<T> {
        if self.samples < LEAST_SAMPLES || !(self.slowest >= T::one()) {
            return Block::BLANK;
        }
        let tuning = config.tuning();
        let share = T::one() / T::whole(self.samples);
        let mut block = Block::<T>::BLANK;
        let places = block.ratio.iter_mut().zip(&mut block.spread);
        let sums = self.first.iter().zip(&self.ratio).zip(&self.square);
        for ((ratio, spread), ((first, sum), square)) in places.zip(sums) {
            let mean = *sum * share;
            *ratio = *first + mean;
            *spread = (*square * share - mean * mean).at_least(T::zero()).sqrt();
        }
        let v = self.speed * share;
        let drag = T::lit(0.12) + T::lit(4e-4) * v * v;
        let slope = (self.time_speed - self.time * v) / (self.time_square - self.time * self.time * share);
        let accel_x = mean_of(&self.accel_x);
        let accel = accel_x.unwrap_or(slope);
        let yaw = mean_of(&self.yaw);
        let force = accel + drag;
        let [braking, slowing] = tuning.braking_m_s2.map(T::lit);
        let braking = if accel_x.is_some() { force < braking } else { accel < slowing };
        // Of what is known, the larger; a turn shows in the rear wheels, too.
        let turned = block.ratio[REAR] * T::lit(1.0 / SCALE) * v * v / config.track_rear_m;
        let by_yaw = yaw.unwrap_or(T::zero()) * v;
        let lateral = mean_of(&self.accel_y).unwrap_or(if yaw.is_some() { by_yaw } else { turned });
        block.speed_m_s = v;
        block.yaw_rate_rad_s = yaw;
        block.force_m_s2 = force;
        block.slope_m_s2 = slope;
        block.grade_seen = accel_x.is_some();
        block.lateral_m_s2 = lateral.abs().at_least(by_yaw.abs());
        block.braking = braking || self.braked;
        block.good = v > T::lit(tuning.least_speed_m_s)
            && block.lateral_m_s2 < T::lit(tuning.most_lateral_m_s2)
            && force < T::lit(tuning.most_force_m_s2)
            && !block.braking;
        let [coupled, driven] = tuning.coupled_m_s2.map(T::lit);
        let (calm, coasting) = (accel < coupled, force < driven);
        block.hidden = match (config.limited_slip, config.driven) {
            (false, _) => [false, false],
            (true, DrivenAxle::Front) => [!calm, false],
            (true, DrivenAxle::Rear) => [false, !calm],
            (true, DrivenAxle::Both) => [!coasting, !coasting],
        };
        // Nor of spinning wheels, nor of speeds that are sent too coarsely.
        let step_1e3 = T::lit(SCALE) * step_m_s / v;
        let sane = |i: usize| {
            block.ratio[i].abs() < T::lit(tuning.absurd_ratio)
                && rounded(block.spread[i], step_1e3) < T::lit(tuning.block_noise)
        };
        block.used = [sane(FRONT), sane(REAR), sane(AXLE)];
        block
    }
}

/// Variance of a ratio's mean, in 1e-6, by the steps `u` in which its speeds are sent (docs/math/wheel-speed.md, eq. 7c): noise of spread `h`
/// that is larger averages them out.
fn rounded<T: Real>(spread_1e3: T, step_1e3: T) -> T {
    let square = step_1e3 * step_1e3;
    if !(square > T::zero()) {
        return T::zero();
    }
    square * T::lit(1.0 / 6.0) * (-T::two_pi() * T::pi() * spread_1e3 * spread_1e3 / square).exp_fast()
}

fn count<T: Real>([sum, number]: &mut [T; 2], value: Option<T>) {
    if let Some(value) = value {
        *sum += value;
        *number += T::one();
    }
}

fn mean_of<T: Real>([sum, number]: &[T; 2]) -> Option<T> {
    (*number > T::zero()).then(|| *sum / *number)
}
