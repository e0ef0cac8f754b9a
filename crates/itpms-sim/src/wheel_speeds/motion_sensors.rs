//! Sensors of the car's motion: yaw rate, accelerations along and across, each with its errors.
//!
//! Called by the run, message by message.

use rand_pcg::Pcg64;

use super::chassis::{GRAVITY_M_S2, Moving};
use super::conditions::YawFault;
use super::disturbance::{Wander, normal};
use super::drawn::Drawn;
use super::spec::WheelSpeedSpec;

/// Time in s in which the yaw rate's offset drifts.
const YAW_DRIFT_S: f64 = 600.0;
/// Noise and steps of the yaw rate in rad/s, of accelerations in m/s²; how much more one along the car reads as the car squats.
const YAW_NOISE_RAD_S: f64 = 2e-3;
const YAW_DRIFT_RAD_S: f64 = 1e-3;
const YAW_STEP_RAD_S: f64 = 1.745e-3;
const ACCEL_NOISE_M_S2: f64 = 0.05;
const ACCEL_STEP_M_S2: f64 = 0.01;
const SQUAT: f64 = 0.05;
/// Noise in rad/s of a yaw rate that is too noisy.
const FAULTY_NOISE_RAD_S: f64 = 0.2;

#[derive(Debug, Clone)]
pub(crate) struct MotionSensors {
    spec: WheelSpeedSpec,
    yaw_offset_rad_s: f64,
    accel_offset_m_s2: [f64; 2],
    yaw_drift: Wander,
}

impl MotionSensors {
    pub(crate) fn new(spec: &WheelSpeedSpec, drawn: &Drawn, random: &mut Pcg64) -> Self {
        let drift_rad_s = YAW_DRIFT_RAD_S.hypot(spec.conditions.yaw_drift_rad_s);
        Self {
            spec: *spec,
            yaw_offset_rad_s: drawn.yaw_offset_rad_s,
            accel_offset_m_s2: drawn.accel_offset_m_s2,
            yaw_drift: Wander::new(drift_rad_s, YAW_DRIFT_S, random),
        }
    }

    /// Yaw rate and accelerations along and across of a car that moves so and turns so fast; NaN: not on the bus.
    pub(crate) fn read(
        &mut self,
        moving: &Moving,
        yaw_rad_s: f64,
        step_s: f64,
        random: &mut Pcg64,
    ) -> [f64; 3] {
        let [along, across] = moving.accel_m_s2;
        let error = self.yaw_offset_rad_s + self.yaw_drift.step(step_s, random);
        let noise = YAW_NOISE_RAD_S * normal(random);
        let yaw = self.faulty(yaw_rad_s, error, noise);
        let felt = along + GRAVITY_M_S2 * moving.grade;
        let x = (1.0 + SQUAT) * felt + self.accel_offset_m_s2[0] + ACCEL_NOISE_M_S2 * normal(random);
        let y = across
            + GRAVITY_M_S2 * moving.cross_slope
            + self.accel_offset_m_s2[1]
            + ACCEL_NOISE_M_S2 * normal(random);
        let transmitted =
            |known: bool, value: f64, step: f64| if known { in_steps(value, step) } else { f64::NAN };
        [
            transmitted(self.spec.yaw_rate, yaw, YAW_STEP_RAD_S),
            transmitted(self.spec.accel_x, x, ACCEL_STEP_M_S2),
            transmitted(self.spec.accel_y, y, ACCEL_STEP_M_S2),
        ]
    }

    fn faulty(&self, yaw_rad_s: f64, error_rad_s: f64, noise_rad_s: f64) -> f64 {
        let conditions = &self.spec.conditions;
        let sound = (1.0 + conditions.yaw_scale) * yaw_rad_s + error_rad_s + noise_rad_s;
        match conditions.yaw_fault {
            YawFault::None => sound,
            YawFault::Dead => self.yaw_offset_rad_s,
            YawFault::Reversed => -sound,
            YawFault::HalfGain => 0.5 * sound,
            YawFault::Degrees => sound.to_degrees(),
            YawFault::Noisy => sound + FAULTY_NOISE_RAD_S / YAW_NOISE_RAD_S * noise_rad_s,
        }
    }
}

/// A value as it is sent: in whole steps, if it has any.
pub(super) fn in_steps(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::super::conditions::ConditionsSpec;
    use super::*;
    use crate::streams::{Purpose, generator};

    #[test]
    fn a_yaw_rate_has_the_fault_that_it_is_given() {
        let mut random = generator(1, Purpose::WheelSpeeds, [0, 0]);
        let mut of = |yaw_fault| {
            let conditions = ConditionsSpec { yaw_scale: 0.02, yaw_fault, ..ConditionsSpec::OFF };
            let sensors = MotionSensors {
                spec: WheelSpeedSpec { conditions, ..WheelSpeedSpec::default() },
                yaw_offset_rad_s: 0.004,
                accel_offset_m_s2: [0.0; 2],
                yaw_drift: Wander::new(0.0, 1.0, &mut random),
            };
            sensors.faulty(0.3, 0.005, 1e-3)
        };
        let sound = 1.02 * 0.3 + 0.006;
        for (fault, expected) in [
            (YawFault::None, sound),
            (YawFault::Dead, 0.004),
            (YawFault::Reversed, -sound),
            (YawFault::HalfGain, 0.5 * sound),
            (YawFault::Degrees, sound * 180.0 / std::f64::consts::PI),
            (YawFault::Noisy, sound + 0.1),
        ] {
            assert!((of(fault) - expected).abs() < 1e-12, "{fault:?}");
        }
    }

    #[test]
    fn a_fall_is_felt_across_without_a_yaw_rate() {
        let mut random = generator(2, Purpose::WheelSpeeds, [0, 0]);
        let spec = WheelSpeedSpec::default();
        let mut sensors = MotionSensors {
            spec,
            yaw_offset_rad_s: 0.0,
            accel_offset_m_s2: [0.0; 2],
            yaw_drift: Wander::new(0.0, 1.0, &mut random),
        };
        let moving = Moving { cross_slope: 0.05, ..Moving::still(20.0) };
        let sums = (0..1000).fold([0.0; 3], |sums: [f64; 3], _| {
            let read = sensors.read(&moving, 0.0, 0.02, &mut random);
            [0, 1, 2].map(|i| sums[i] + read[i] / 1000.0)
        });
        // Means of 1000: noise of .05 m/s² and .002 rad/s leaves 1.6e-3 and 6e-5.
        assert!(
            sums[0].abs() < 3e-4 && sums[1].abs() < 6e-3 && (sums[2] - 0.05 * 9.81).abs() < 6e-3,
            "{sums:?}"
        );
    }
}
