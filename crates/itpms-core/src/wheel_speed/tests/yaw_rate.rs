//! A yaw rate that goes with the wheels, and one that does not.

// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use super::drive::{Drive, OFFSETS, TRACK, WHEELBASE};
use super::{calibrated, config, found, monitor};
use crate::wheel_speed::WheelSpeedSample;

/// A sensor that is dead or turned round is left out, one that is off by a tenth is not, nor where two tires of a side become smaller.
#[test]
fn a_yaw_rate_that_goes_against_the_wheels_is_left_out() {
    for seed in 20..24 {
        for (yaw_gain, doubtful) in [(0.0, true), (-1.0, true), (0.9, false), (1.1, false)] {
            let mut drive = Drive { yaw_gain, ..Drive::new(seed, 83.0, 0.04) };
            let mut monitor = calibrated::<f32>(&mut drive, 300.0);
            assert_eq!(monitor.doubts_yaw_rate(), doubtful, "{seed} {yaw_gain}");
            assert_eq!(found(&mut monitor, &mut drive, 1200.0), None, "{seed} {yaw_gain}");
            // So it is on a later drive, from its first bend on.
            let mut later = self::monitor::<f32>(&config()).unwrap();
            assert!(later.load_calibration(monitor.calibration().unwrap()));
            assert_eq!(later.doubts_yaw_rate(), doubtful, "{seed} {yaw_gain}");
            if doubtful {
                assert_eq!(found(&mut later, &mut drive, 1200.0), None, "{seed} {yaw_gain}");
                continue;
            }
            for side in [0, 2] {
                drive.radius[side] -= 2e-3;
            }
            assert!(found(&mut monitor, &mut drive, 600.0).is_some(), "{seed} {yaw_gain}");
            assert!(!monitor.doubts_yaw_rate(), "{seed} {yaw_gain}: a side");
        }
    }
}

/// Right angles at 6 m/s and then a road at 15 m/s, by exact kinematics: what a slow bend leaves of the ratios is no yaw rate at a higher speed.
#[test]
fn a_good_yaw_rate_is_kept_through_junctions() {
    for bias_rad_s in [0.0, 0.01] {
        let mut monitor = monitor::<f32>(&config()).unwrap();
        monitor.begin_calibration_at(300.0, &[1.0; 4]);
        for k in 0..60_000u32 {
            let time_s = f64::from(k) / 50.0;
            let phase_s = time_s % 40.0;
            let turning = (10.0..13.0).contains(&phase_s);
            let v = if (5.0..15.0).contains(&phase_s) { 6.0 } else { 15.0 };
            let yaw = if turning { core::f64::consts::FRAC_PI_6 } else { 0.0 };
            let rear = [v - 0.5 * TRACK * yaw, v + 0.5 * TRACK * yaw];
            let front = rear.map(|side| side.hypot(WHEELBASE * yaw));
            let speed = |i: usize, v: f64| (v * (-OFFSETS[i]).exp()) as f32;
            monitor.update(&WheelSpeedSample {
                time_s,
                wheel_speed_m_s: core::array::from_fn(|i| speed(i, [front, rear].as_flattened()[i])),
                yaw_rate_rad_s: (yaw + bias_rad_s) as f32,
                accel_x_m_s2: 0.0,
                accel_y_m_s2: f32::NAN,
                brake: None,
            });
            assert!(!monitor.doubts_yaw_rate(), "{bias_rad_s}: {time_s} s");
        }
    }
}

/// A sensor that was wrong for a day: bends prove it right on the next.
#[test]
fn a_yaw_rate_that_goes_with_the_wheels_again_is_believed_again() {
    let mut drive = Drive { yaw_gain: 0.0, ..Drive::new(25, 83.0, 0.04) };
    let stored = *calibrated::<f32>(&mut drive, 300.0).calibration().unwrap();
    assert!(stored.leaves_out_yaw_rate);
    let mut later = Drive::new(26, 83.0, 0.04);
    let mut monitor = monitor::<f32>(&config()).unwrap();
    assert!(monitor.load_calibration(&stored) && monitor.doubts_yaw_rate());
    assert_eq!(found(&mut monitor, &mut later, 1800.0), None);
    assert!(!monitor.doubts_yaw_rate());
}

/// Tires of a side that are larger by half a percent part the wheels of both axles as a bend does, at any speed: the sensor is not wrong.
#[test]
fn a_yaw_rate_is_kept_on_a_car_with_larger_tires_on_a_side() {
    for seed in 30..34 {
        for larger in [5e-3, -5e-3] {
            let mut drive = Drive::new(seed, 83.0, 0.04);
            [0, 2].into_iter().for_each(|wheel| drive.radius[wheel] += larger);
            let mut monitor = calibrated::<f32>(&mut drive, 300.0);
            assert_eq!(found(&mut monitor, &mut drive, 1200.0), None, "{seed} {larger}");
            assert!(!monitor.doubts_yaw_rate(), "{seed} {larger}");
        }
    }
}
