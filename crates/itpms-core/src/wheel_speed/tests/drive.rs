//! A car on simulated roads: quantised speeds, curves, grades, brakes, noise as measured on a real car.

// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use crate::random::Random;
use crate::real::Real;
use crate::wheel_speed::WheelSpeedSample;

/// A drive that goes on: speeds from 6 to 33 m/s, bends, grades, brakes every two minutes.
pub(crate) struct Drive {
    pub(super) random: Random,
    pub(super) rate_hz: f64,
    /// Step of the wheel speeds in m/s.
    pub(super) step_m_s: f64,
    pub(super) time_s: f64,
    pub(super) speed: f64,
    pub(super) aim: f64,
    pub(super) curvature: f64,
    pub(super) grade: f64,
    pub(super) front_force: f64,
    pub(super) wander: [f64; 2],
    /// The last random number of each wheel.
    pub(super) hop: [f64; 4],
    /// `ln` of the wheels' radii.
    pub(crate) radius: [f64; 4],
    pub(super) yaw_rate: bool,
    /// The sensor's reading of a yaw rate.
    pub(super) yaw_gain: f64,
    pub(super) accel_x: bool,
    /// Excess slip of the left front wheel over the right one, as a share of their slip.
    pub(super) split: f64,
}

pub(super) const OFFSETS: [f64; 4] = [1.3e-3, -0.4e-3, -0.9e-3, 0.6e-3];
pub(super) const TRACK: f64 = 1.57;
pub(super) const WHEELBASE: f64 = 2.66;

impl Drive {
    pub(crate) fn new(seed: u64, rate_hz: f64, step_km_h: f64) -> Self {
        Self {
            random: Random(seed),
            rate_hz,
            step_m_s: step_km_h / 3.6,
            time_s: 0.0,
            speed: 15.0,
            aim: 15.0,
            curvature: 0.0,
            grade: 0.0,
            front_force: 0.0,
            wander: [0.0; 2],
            hop: [0.0; 4],
            radius: OFFSETS,
            yaw_rate: true,
            yaw_gain: 1.0,
            accel_x: true,
            split: 0.0,
        }
    }

    /// A disturbance that forgets itself after `time_s`.
    fn wander(&mut self, value: f64, sd: f64, time_s: f64) -> f64 {
        let share = (-1.0 / (self.rate_hz * time_s)).exp();
        share * value + sd * (1.0 - share * share).sqrt() * self.random.normal()
    }

    pub(crate) fn next<T: Real>(&mut self) -> WheelSpeedSample<T> {
        self.time_s += 1.0 / self.rate_hz;
        if self.random.uniform() < 1.0 / (30.0 * self.rate_hz) {
            self.aim = 6.0 + 27.0 * self.random.uniform();
        }
        let accel = (0.2 * (self.aim - self.speed)).clamp(-1.8, 1.2);
        self.speed += accel / self.rate_hz;
        self.curvature = self.wander(self.curvature, 1.5e-3, 5.0);
        self.grade = self.wander(self.grade, 0.02, 40.0);
        let v = self.speed;
        let force = accel + 9.81 * self.grade + 0.12 + 4e-4 * v * v;
        let braking = force < -0.25;
        // 3.7e-3 per m/s² of slip on the front axle; brakes share it and pull by 1e-3 to the left.
        let aim = if braking { 0.1 * force } else { force };
        self.front_force = aim;
        self.wander = [self.wander(self.wander[0], 1.6e-4, 58.0), self.wander(self.wander[1], 2.0e-4, 58.0)];
        // Wheels hop and twist by 1.6e-3 from sample to sample and come back: a tenth of it remains in a block's mean.
        let noise: [f64; 4] = core::array::from_fn(|i| {
            let before = core::mem::replace(&mut self.hop[i], self.random.normal());
            1.06e-3 * (self.hop[i] - before) + 5e-4 * self.random.normal()
        });
        let yaw = v * self.curvature;
        let turn = 0.5 * TRACK * self.curvature;
        // The front wheels run on a larger circle.
        let outer = 0.5 * (WHEELBASE * self.curvature).powi(2);
        let pull = if braking { 1e-3 } else { 0.0 };
        let slip = 3.7e-3 * self.front_force;
        let ratio = [
            outer + slip * (1.0 + self.split) - turn + 0.5 * self.wander[0] + pull,
            outer + slip + turn - 0.5 * self.wander[0],
            -turn + 0.5 * self.wander[1],
            turn - 0.5 * self.wander[1],
        ];
        let wheel_speed_m_s = core::array::from_fn(|i| {
            let speed = v * (ratio[i] - self.radius[i] + noise[i]).exp();
            T::lit((speed / self.step_m_s).round() * self.step_m_s)
        });
        // A sensor of 0.004 rad/s with an offset.
        let measured = self.yaw_gain * yaw + 0.006 + 1e-3 * self.random.normal();
        let sent = |known: bool, value: f64| T::lit(if known { value } else { f64::NAN });
        WheelSpeedSample {
            time_s: self.time_s,
            wheel_speed_m_s,
            yaw_rate_rad_s: sent(self.yaw_rate, (measured / 4e-3).round() * 4e-3),
            accel_x_m_s2: sent(self.accel_x, accel + 9.81 * self.grade + 0.03),
            accel_y_m_s2: T::lit(f64::NAN),
            brake: None,
        }
    }
}
