//! Which values of a message of the wheel speeds a car can have.

use crate::conditioning::is_a_cars;
use crate::model::WheelSpeedSample;
use crate::real::Real;

/// A yaw rate that no car has, in rad/s.
const ABSURD_YAW_RAD_S: f64 = 5.0;
/// A horizontal acceleration that no car has, in m/s².
const ABSURD_ACCEL_M_S2: f64 = 30.0;

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
