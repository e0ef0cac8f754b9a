//! What comes in with every message of the wheel speeds.

use crate::conditioning::is_a_cars;
use crate::real::Real;

/// A yaw rate that no car has, in rad/s.
const ABSURD_YAW_RAD_S: f64 = 5.0;
/// A horizontal acceleration that no car has, in m/s².
const ABSURD_ACCEL_M_S2: f64 = 30.0;

/// Four wheel speeds and what the car says of its motion besides. NaN: not known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelSpeedSample<T> {
    /// Time in s, strictly increasing.
    pub time_s: f64,
    /// Speeds of the wheels as the car has them, each by the same assumed radius, in the order of [`Corner::ALL`](crate::Corner::ALL).
    pub wheel_speed_m_s: [T; 4],
    /// Yaw rate, positive to the left.
    pub yaw_rate_rad_s: T,
    /// Acceleration forward, gravity along a grade included.
    pub accel_x_m_s2: T,
    /// Acceleration to the left.
    pub accel_y_m_s2: T,
    /// Whether the driver brakes.
    pub brake: Option<bool>,
}

impl<T: Real> WheelSpeedSample<T> {
    /// Whether all four wheels have a speed that a wheel can have.
    pub(super) fn complete(&self) -> bool {
        self.wheel_speed_m_s.into_iter().all(is_speed)
    }

    pub(super) fn yaw_rate(&self) -> Option<T> {
        within(self.yaw_rate_rad_s, ABSURD_YAW_RAD_S)
    }

    pub(super) fn accel_x(&self) -> Option<T> {
        within(self.accel_x_m_s2, ABSURD_ACCEL_M_S2)
    }

    pub(super) fn accel_y(&self) -> Option<T> {
        within(self.accel_y_m_s2, ABSURD_ACCEL_M_S2)
    }
}

/// Whether the wheel of a car that drives forwards can have this speed in m/s.
pub(super) fn is_speed<T: Real>(v: T) -> bool {
    v >= T::zero() && is_a_cars(v)
}

fn within<T: Real>(value: T, absurd: f64) -> Option<T> {
    (value.abs() < T::lit(absurd)).then_some(value)
}
