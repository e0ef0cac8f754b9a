//! What comes in.

use itpms_core::model::{CarSample, CornerSample};
use itpms_core::wheel_speed::WheelSpeedSample;

use crate::itpms_real;
use crate::status::itpms_status;

/// One sample of the accelerometers. NaN: the value is missing.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_sample {
    /// Time in s, increasing, of any origin.
    pub time_s: f64,
    /// Speed of the car in m/s; NaN: not known.
    pub speed_m_s: itpms_real,
    /// Vertical accelerations of the body over the wheels in m/s^2, positive upward, with or without gravity: front left, front right,
    /// rear left, rear right.
    pub body_accel_m_s2: [itpms_real; 4],
    /// The same of the wheels.
    pub wheel_accel_m_s2: [itpms_real; 4],
}

impl itpms_sample {
    pub(crate) fn read(&self) -> Result<CarSample<itpms_real>, itpms_status> {
        if !self.time_s.is_finite() {
            return Err(itpms_status::BadTime);
        }
        let accels = self.body_accel_m_s2.into_iter().zip(self.wheel_accel_m_s2);
        let mut corners = [None; 4];
        for (corner, (body_accel_m_s2, wheel_accel_m_s2)) in corners.iter_mut().zip(accels) {
            *corner = Some(CornerSample { body_accel_m_s2, wheel_accel_m_s2 });
        }
        Ok(CarSample { time_s: self.time_s, speed_m_s: self.speed_m_s, corners, wheel_speeds: None })
    }
}

/// Whether the driver brakes.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_brake {
    /// The bus does not say.
    Unknown = 0,
    /// The brakes are not applied.
    Off = 1,
    /// The brakes are applied.
    On = 2,
}

/// Four wheel speeds and how the car moves, at 10 Hz or more. NaN: not known.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_wheel_speed_sample {
    /// Time in s, increasing, by the same clock as the accelerometers' samples.
    pub time_s: f64,
    /// Speeds of the wheels in m/s, each by the same assumed radius: front left, front right, rear left, rear right.
    pub wheel_speed_m_s: [itpms_real; 4],
    /// Yaw rate in rad/s, positive to the left.
    pub yaw_rate_rad_s: itpms_real,
    /// Acceleration forward in m/s^2.
    pub accel_x_m_s2: itpms_real,
    /// Acceleration to the left in m/s^2.
    pub accel_y_m_s2: itpms_real,
    /// An `itpms_brake`.
    pub brake: u32,
}

impl itpms_wheel_speed_sample {
    pub(crate) fn read(&self) -> Result<WheelSpeedSample<itpms_real>, itpms_status> {
        if !self.time_s.is_finite() {
            return Err(itpms_status::BadTime);
        }
        let brake = match self.brake {
            n if n == itpms_brake::Unknown as u32 => None,
            n if n == itpms_brake::Off as u32 => Some(false),
            n if n == itpms_brake::On as u32 => Some(true),
            _ => return Err(itpms_status::BadChoice),
        };
        Ok(WheelSpeedSample {
            time_s: self.time_s,
            wheel_speed_m_s: self.wheel_speed_m_s,
            yaw_rate_rad_s: self.yaw_rate_rad_s,
            accel_x_m_s2: self.accel_x_m_s2,
            accel_y_m_s2: self.accel_y_m_s2,
            brake,
        })
    }
}
