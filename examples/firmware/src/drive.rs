//! The drive that is compiled in.

use itpms_core::model::{CarSample, CornerSample};

include!(concat!(env!("OUT_DIR"), "/drive.rs"));

/// Bytes of a sample: speed, and body and wheel of four corners.
const SAMPLE: usize = 18;

/// The sample `index` of the drive, as an interrupt would hand it on.
#[must_use]
pub fn sample(index: usize) -> CarSample<f32> {
    let bytes = &DRIVE[SAMPLE * index..SAMPLE * (index + 1)];
    let value = |i: usize, per_unit: f32| match i16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]) {
        MISSING => f32::NAN,
        value => f32::from(value) / per_unit,
    };
    let corners = core::array::from_fn(|i| {
        Some(CornerSample {
            body_accel_m_s2: value(1 + 2 * i, PER_M_S2),
            wheel_accel_m_s2: value(2 + 2 * i, PER_M_S2),
        })
    });
    CarSample { time_s: index as f64 / RATE_HZ, speed_m_s: value(0, PER_M_S), corners, wheel_speeds: None }
}
