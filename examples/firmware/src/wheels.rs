//! The bus that is compiled in.

use itpms_core::wheel_speed::WheelSpeedSample;

include!(concat!(env!("OUT_DIR"), "/wheels.rs"));

/// Bytes of a message: four speeds, yaw rate, accelerations forward and to the left, brake.
const MESSAGE: usize = 16;

/// The message `index`, as an interrupt would hand it on.
#[must_use]
pub fn message(index: usize) -> WheelSpeedSample<f32> {
    let bytes = &WHEELS[MESSAGE * index..MESSAGE * (index + 1)];
    let value = |i: usize| f32::from(i16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]));
    WheelSpeedSample {
        time_s: index as f64 / RATE_HZ,
        wheel_speed_m_s: core::array::from_fn(|i| value(i) / PER_M_S),
        yaw_rate_rad_s: value(4) / PER_RAD_S,
        accel_x_m_s2: value(5) / PER_M_S2,
        accel_y_m_s2: value(6) / PER_M_S2,
        brake: Some(value(7) > 0.0),
    }
}
