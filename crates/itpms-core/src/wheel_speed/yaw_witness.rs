//! Whether a yaw rate goes with the wheels (docs/math/wheel-speed.md, eq. 7a): a bend shows in the wheels of both axles, a tire in those of
//! one. A sensor that is dead, turned round or another signal would make every bend a loss of the tires on its outer side.

use super::block::{BLOCK_S, Block, LEAST_SPEED_M_S};
use super::config::WheelSpeedConfig;
use super::{FRONT, REAR, SCALE};
use crate::memory::Blank;
use crate::real::Real;

/// Time in s after which a yaw rate counts as usual: bends are shorter.
const USUAL_S: f64 = 10.0;
/// Time in s after which what was seen is forgotten.
const MEMORY_S: f64 = 120.0;
/// Share of a yaw rate that a sensor may leave by its own; radius that the load of a bend takes from the outer tires, per m/s², which
/// imitates a yaw rate; and what may be left beyond in rad²/s²: two tires of a side that lose a quarter at once leave 0.008.
const OFF: f64 = 0.2;
const BY_LOAD: f64 = 8e-4;
const LEFT: f64 = 0.01;

/// See the [module](self).
#[derive(Debug, Clone, Copy, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct YawWitness<T> {
    /// The usual ratios of the front wheels and of the rear ones, as tires of unequal size leave them at any speed, and the sensor's usual
    /// yaw rate in rad/s.
    usual: [T; 3],
    begun: bool,
    /// Sum of what the sensor leaves of both axles' product beyond its share.
    left: T,
    doubted: bool,
}

impl<T: Real> YawWitness<T> {
    /// Whether the sensor was found to go against the wheels.
    pub(super) fn is_doubted(&self) -> bool {
        self.doubted
    }

    /// The sensor was found to go against the wheels on an earlier drive.
    pub(super) fn doubt(&mut self) {
        self.doubted = true;
    }

    /// The next block does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.begun = false;
    }

    /// Takes a block; whether it is the one that makes the sensor doubtful.
    pub(super) fn take(&mut self, block: &Block<T>, config: &WheelSpeedConfig<T>) -> bool {
        let v = block.speed_m_s;
        let Some(sensor) = block.yaw_rate_rad_s.filter(|_| v > T::lit(LEAST_SPEED_M_S)) else { return false };
        let now = [block.ratio[FRONT], block.ratio[REAR], sensor];
        if !self.begun {
            (self.usual, self.begun) = (now, true);
            return false;
        }
        let mut beyond = now;
        for (beyond, usual) in beyond.iter_mut().zip(&mut self.usual) {
            *beyond -= *usual;
            *usual += T::lit(BLOCK_S / USUAL_S) * *beyond;
        }
        let by_wheels = |ratio: T, track_m: T| -ratio * v / (T::lit(SCALE) * track_m);
        let [front, rear, sensor] = beyond;
        let (front, rear) = (by_wheels(front, config.track_front_m), by_wheels(rear, config.track_rear_m));
        let kept = T::lit(1.0 - BLOCK_S / MEMORY_S);
        let share = T::lit(OFF) + T::lit(BY_LOAD) * v * v / config.track_rear_m;
        let beyond = (front - sensor) * (rear - sensor) - share * share * (front * rear).at_least(T::zero());
        self.left = kept * self.left + beyond;
        let before = self.doubted;
        self.doubted |= self.left > T::lit(LEFT);
        self.doubted && !before
    }
}
