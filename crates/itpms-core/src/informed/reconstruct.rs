//! Per sample: from the two accelerations to the signals that the road velocity is a linear combination of
//! (docs/math/informed.md, eq. 1-4). Called on every grid step; knows nothing of stiffness or statistics.
//!
//! With `L = s/(s + ω_l)` the leak that keeps integrals from drifting, `L v_r = u_1 + θ u_2`, where
//! `u_1 = L v_w` and `u_2 = m_w L ȧ_w + c_s L (a_w - a_b) + k_s L (v_w - v_b)`: the force through the suspension, so the
//! sprung mass and the body sensor's noise stay out of it.

use crate::real::Real;

/// Leak of the integrators in rad/s: 0.5 Hz, far below the first bin.
pub(super) const LEAK_RAD_S: f64 = core::f64::consts::TAU * 0.5;
/// Time constant in s of the offset that is taken off each sensor (gravity, bias).
const OFFSET_S: f64 = 10.0;
/// Samples by which the centred derivative lags.
const LAG: usize = 2;

/// Number of signals.
pub(super) const SIGNALS: usize = 5;
/// `L v_w`: wheel velocity.
pub(super) const WHEEL_VELOCITY: usize = 0;
/// `L ȧ_w`: wheel jerk.
pub(super) const WHEEL_JERK: usize = 1;
/// `L (a_w - a_b)`: relative acceleration.
pub(super) const RELATIVE_ACCELERATION: usize = 2;
/// `L (v_w - v_b)`: relative velocity.
pub(super) const RELATIVE_VELOCITY: usize = 3;
/// `L ȧ_b`: body jerk.
pub(super) const BODY_JERK: usize = 4;

/// One sensor: offset, leaky integral, derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Channel<T> {
    offset: T,
    /// The last five accelerations, newest first.
    acceleration: [T; 2 * LAG + 1],
    /// The last three leaky integrals, newest first.
    integral: [T; LAG + 1],
}

impl<T: Real> Channel<T> {
    fn new() -> Self {
        Self { offset: T::zero(), acceleration: [T::zero(); 2 * LAG + 1], integral: [T::zero(); LAG + 1] }
    }

    /// Forgets the signal, keeps the offset.
    fn restart(&mut self) {
        *self = Self { offset: self.offset, ..Self::new() };
    }

    fn push(&mut self, raw: T, offset_gain: T, dt: T) {
        self.offset += offset_gain * (raw - self.offset);
        self.acceleration.rotate_right(1);
        self.acceleration[0] = raw - self.offset;
        // Bilinear discretisation of 1/(s + ω_l).
        let (rate, leak) = (T::lit(2.0) / dt, T::lit(LEAK_RAD_S));
        let next =
            ((rate - leak) * self.integral[0] + self.acceleration[0] + self.acceleration[1]) / (rate + leak);
        self.integral.rotate_right(1);
        self.integral[0] = next;
    }

    /// `(L v, L a, L ȧ)` two samples ago.
    fn read(&self, dt: T) -> (T, T, T) {
        let a = &self.acceleration;
        let leak = T::lit(LEAK_RAD_S);
        let velocity = self.integral[LAG];
        let acceleration = a[LAG] - leak * velocity;
        let slope = (a[4] - T::lit(8.0) * a[3] + T::lit(8.0) * a[1] - a[0]) / (T::lit(12.0) * dt);
        (velocity, acceleration, slope - leak * acceleration)
    }
}

/// The running reconstruction. See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reconstruction<T> {
    dt: T,
    steps: u32,
    body: Channel<T>,
    wheel: Channel<T>,
}

impl<T: Real> Reconstruction<T> {
    pub(super) fn new(grid_period_s: f64) -> Self {
        Self { dt: T::lit(grid_period_s), steps: 0, body: Channel::new(), wheel: Channel::new() }
    }

    /// The signal was interrupted: start again, keep the sensors' offsets.
    pub(super) fn restart(&mut self) {
        self.body.restart();
        self.wheel.restart();
    }

    /// Takes one grid step, gives all signals two steps earlier.
    pub(super) fn push(&mut self, body_accel_m_s2: T, wheel_accel_m_s2: T) -> [T; SIGNALS] {
        // The mean of all samples so far, then of the last ten seconds or so.
        self.steps = self.steps.saturating_add(1);
        let gain = (self.dt / T::lit(OFFSET_S)).max(T::one() / T::lit(f64::from(self.steps)));
        self.body.push(body_accel_m_s2, gain, self.dt);
        self.wheel.push(wheel_accel_m_s2, gain, self.dt);
        let (body_velocity, body_acceleration, body_jerk) = self.body.read(self.dt);
        let (wheel_velocity, wheel_acceleration, wheel_jerk) = self.wheel.read(self.dt);
        let mut signals = [T::zero(); SIGNALS];
        signals[WHEEL_VELOCITY] = wheel_velocity;
        signals[WHEEL_JERK] = wheel_jerk;
        signals[RELATIVE_ACCELERATION] = wheel_acceleration - body_acceleration;
        signals[RELATIVE_VELOCITY] = wheel_velocity - body_velocity;
        signals[BODY_JERK] = body_jerk;
        signals
    }
}
