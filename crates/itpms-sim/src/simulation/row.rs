//! Output of a simulation: rows of a log with the truth.

use itpms_core::model::{CarSample, CornerSample};

use crate::wheel_speeds::WheelSpeedRow;

/// One row of a log with its truth. Signals are late by the anti-alias filter's group delay, the truth is not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimRow {
    /// Time of the sample in s; the first one is at 0 or, with a jittered clock, a little later.
    pub time_s: f64,
    pub speed_m_s: f64,
    /// Distance in m since 0 s, of the front axle.
    pub distance_m: f64,
    /// By [`Corner::index`](itpms_core::model::Corner::index); `None` where the scenario has no such corner.
    pub corners: [Option<CornerRow>; 4],
    /// Latest wheel speeds on the bus; `None` where the scenario has no wheel speeds.
    pub wheel_speeds: Option<WheelSpeedRow>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerRow {
    /// Logged sprung mass acceleration in m/s²; NaN when lost.
    pub body_accel_m_s2: f64,
    /// Logged unsprung mass acceleration in m/s²; NaN when lost.
    pub wheel_accel_m_s2: f64,
    /// True gauge pressure in kPa.
    pub pressure_kpa: f64,
    /// What a log holds as the pressure in kPa: the reading of the scenario's pressure sensor, or the true pressure where it has none.
    pub pressure_reading_kpa: f64,
    pub stiffness_n_per_m: f64,
    /// True road height in m under this wheel's axle: a point of the profile.
    pub road_m: f64,
    /// The same as the tire feels it, averaged over its contact length; equal to `road_m` for a point follower.
    pub contact_road_m: f64,
}

impl SimRow {
    /// The input of the car's estimator.
    pub fn car_sample(&self) -> CarSample<f64> {
        CarSample {
            time_s: self.time_s,
            speed_m_s: self.speed_m_s,
            corners: self.corners.map(|row| row.map(|r| r.sample())),
            wheel_speeds: self.wheel_speeds.map(|row| row.sample(self.time_s)),
        }
    }
}

impl CornerRow {
    pub fn sample(&self) -> CornerSample<f64> {
        CornerSample { body_accel_m_s2: self.body_accel_m_s2, wheel_accel_m_s2: self.wheel_accel_m_s2 }
    }
}
