//! Per sample: from the two accelerations to the signals that the road velocity is a linear combination of
//! (docs/math/informed.md, eq. 1-4). Called on every grid step; knows nothing of stiffness or statistics.
//!
//! With `L = s/(s + ω_l)` the leak that keeps integrals from drifting, `L v_r = u_1 + θ u_2`, where `u_1 = L v_w` and `u_2 = m_w L ȧ_w +
//! c_s L (a_w - a_b) + k_s L (v_w - v_b)`: the force through the suspension, so the sprung mass and the body sensor's noise stay out of it.

use crate::conditioning::GridSample;
use crate::memory::Blank;
use crate::real::Real;

/// Leak of the integrators in rad/s: low enough to leave the first bin alone, high enough to keep the slow road,
/// which is far stronger, from leaking into it.
pub const LEAK_RAD_S: f64 = core::f64::consts::TAU * 1.5;
/// Time constant in s of the offset that is taken off each sensor (gravity, bias).
const OFFSET_S: f64 = 10.0;
/// What lies this far out is no offset (gravity is the largest) and must not drag it along.
const LARGEST_OFFSET_M_S2: f64 = 40.0;
/// Samples by which the centred derivative lags.
pub(crate) const LAG: usize = 3;

/// Number of signals, and of the first of them that make up the road velocity.
pub(crate) const SIGNALS: usize = 5;
pub(crate) const ROAD_SIGNALS: usize = 4;
/// `L v_w`: wheel velocity.
pub const WHEEL_VELOCITY: usize = 0;
/// `L ȧ_w`: wheel jerk.
pub const WHEEL_JERK: usize = 1;
/// `L (a_w - a_b)`: relative acceleration.
pub const RELATIVE_ACCELERATION: usize = 2;
/// `L (v_w - v_b)`: relative velocity.
pub const RELATIVE_VELOCITY: usize = 3;
/// `L ȧ_b`: body jerk.
pub(crate) const BODY_JERK: usize = 4;

/// One signal: offset, leaky integral, derivative.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Channel<T> {
    offset: T,
    /// The last seven accelerations, newest first.
    acceleration: [T; 2 * LAG + 1],
    /// The leaky integrals three and two samples ago, older first: it needs one sample of the future.
    integral: [T; 2],
}

impl<T: Real> Channel<T> {
    /// Forgets the signal, keeps the offset.
    pub(crate) fn restart(&mut self) {
        *self = Self { offset: self.offset, ..Self::BLANK };
    }

    /// Takes the value of step number `steps`; gives its leaky integral, itself and its derivative, [`LAG`] steps earlier.
    pub(crate) fn step(&mut self, raw: T, steps: u32, dt: T) -> (T, T, T) {
        // The mean of all samples so far, then of the last ten seconds or so.
        let gain = (dt * T::lit(1.0 / OFFSET_S)).at_least(T::one() / T::whole(steps));
        self.push(raw, gain, dt);
        self.read(dt)
    }

    fn push(&mut self, raw: T, offset_gain: T, dt: T) {
        let limit = T::lit(LARGEST_OFFSET_M_S2);
        self.offset += offset_gain * (raw.clamp(-limit, limit) - self.offset);
        let [a, b, c, d, e, f, _] = self.acceleration;
        self.acceleration = [raw - self.offset, a, b, c, d, e, f];
        // ∫a over a step through the cubic of the four points around it, 1/24 (-1, 13, 13, -1): right to 4 % at a fifth
        // of the sampling rate, where the trapezoidal rule is 14 % off. The leak enters bilinearly.
        let a = &self.acceleration;
        let step = dt / T::lit(24.0) * (T::lit(13.0) * (a[LAG - 1] + a[LAG]) - a[LAG - 2] - a[LAG + 1]);
        let half_leak = T::lit(0.5 * LEAK_RAD_S) * dt;
        let next = ((T::one() - half_leak) * self.integral[1] + step) / (T::one() + half_leak);
        self.integral = [self.integral[1], next];
    }

    /// `(L v, L a, L ȧ)` three samples ago.
    fn read(&self, dt: T) -> (T, T, T) {
        let a = &self.acceleration;
        let leak = T::lit(LEAK_RAD_S);
        let velocity = self.integral[0];
        let acceleration = a[LAG] - leak * velocity;
        // Centred derivative of seven points: right to 2 % at a fifth of the sampling rate.
        let slope =
            (T::lit(45.0) * (a[2] - a[4]) - T::lit(9.0) * (a[1] - a[5]) + a[0] - a[6]) / (T::lit(60.0) * dt);
        (velocity, acceleration, slope - leak * acceleration)
    }
}

/// The running reconstruction: from a grid step's two accelerations the signals that the road's velocity is a linear combination of
/// (docs/math/informed.md, eq. 1-4).
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reconstruction<T> {
    dt: T,
    steps: u32,
    body: Channel<T>,
    wheel: Channel<T>,
}

impl<T: Real> Reconstruction<T> {
    /// For steps of `grid_period_s`.
    pub fn new(grid_period_s: f64) -> Self {
        Self { dt: T::lit(grid_period_s), steps: 0, body: Channel::BLANK, wheel: Channel::BLANK }
    }

    /// The signal was interrupted: start again, keep the sensors' offsets. Apart, as all that is seldom done to what is large: with it in
    /// its midst every step would load all of it and choose.
    #[inline(never)]
    pub fn restart(&mut self) {
        self.body.restart();
        self.wheel.restart();
    }

    /// Takes one grid step, gives all signals three steps earlier.
    pub fn push(&mut self, sample: &GridSample<T>) -> [T; SIGNALS] {
        self.steps = self.steps.saturating_add(1);
        let (steps, dt) = (self.steps, self.dt);
        let (body_velocity, body_acceleration, body_jerk) = self.body.step(sample.body_accel_m_s2, steps, dt);
        let (wheel_velocity, wheel_acceleration, wheel_jerk) =
            self.wheel.step(sample.wheel_accel_m_s2, steps, dt);
        let mut signals = [T::zero(); SIGNALS];
        signals[WHEEL_VELOCITY] = wheel_velocity;
        signals[WHEEL_JERK] = wheel_jerk;
        signals[RELATIVE_ACCELERATION] = wheel_acceleration - body_acceleration;
        signals[RELATIVE_VELOCITY] = wheel_velocity - body_velocity;
        signals[BODY_JERK] = body_jerk;
        signals
    }

    /// The newest acceleration of the wheel less the body's, offsets taken off.
    pub(super) fn relative_accel(&self) -> T {
        self.wheel.acceleration[0] - self.body.acceleration[0]
    }

    /// Steps so far, and how long each is in s.
    pub(super) fn steps(&self) -> (u32, T) {
        (self.steps, self.dt)
    }
}
