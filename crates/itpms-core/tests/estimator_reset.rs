//! A reset: the first seconds of a drive are known to be at placard pressure.

use itpms_core::model::{CalibrationError, Corner, CornerCalibration, Learned, VehicleCalibration};

use crate::common::car_ride::{CarRide, RATE_HZ, car, config, drive};
use crate::common::ride::{Ride, estimator, feed};

const PLACARD_KPA: f64 = 241.3;
const RESET_S: f64 = 10.0;

#[test]
fn a_reset_drive_stays_at_placard_and_lets_go_afterwards() {
    let ride = Ride::new(7);
    let mut tire = estimator::<f64>(ride.rate_hz);
    tire.begin_calibration(RESET_S).unwrap();
    let start_s = ride.rows()[0].time_s;
    let mut free_sd: f64 = 0.0;
    for row in ride.rows() {
        let e = feed(&mut tire, &row);
        let driven_s = row.time_s - start_s;
        if (1.0..RESET_S).contains(&driven_s) {
            // A reset is good to 3 kPa, and one grid cell spans 8.
            assert!((e.pressure_kpa - PLACARD_KPA).abs() < 8.0, "{}", e.pressure_kpa);
            assert!(e.pressure_sd_kpa < 8.0, "{}", e.pressure_sd_kpa);
        } else if driven_s > RESET_S + 5.0 {
            free_sd = free_sd.max(e.pressure_sd_kpa);
        }
    }
    // The pressure is not vouched for any more: the sd is the estimator's own again.
    assert!(free_sd > 3.0, "{free_sd}");
}

/// Of a car like this one, whose corners should have these pressures.
fn calibration(placard_kpa: [f64; 4]) -> VehicleCalibration<f64> {
    let learned = Learned { value: 0.01, sd: 0.02 };
    let corner = |placard_kpa| CornerCalibration {
        placard_kpa,
        unsprung_mass: learned,
        damping: learned,
        spring: learned,
        spectrum_bias_kpa: learned,
        shared_road_bias: learned,
    };
    VehicleCalibration {
        corners: placard_kpa.map(|kpa| Some(corner(kpa))),
        bar: [learned; 2],
        rear_axle_coupling: learned,
        gain: [learned; 2],
        wheelbase: learned,
        skew_s: [Learned { value: 0.0, sd: 1e-3 }; 2],
        learned_s: 600.0,
    }
}

#[test]
fn what_was_learned_of_another_car_is_refused_and_changes_nothing() {
    let mut car = car(&config::<f64>());
    // Unknown values are NaN, which equals nothing.
    let before = format!("{car:?}");
    // The last corner is the one that differs.
    let other = calibration([PLACARD_KPA, PLACARD_KPA, PLACARD_KPA, 260.0]);
    assert_eq!(car.load_calibration(&other), Err(CalibrationError::OtherCar));
    assert!(format!("{car:?}") == before);
    assert_eq!(car.load_calibration(&calibration([PLACARD_KPA; 4])), Ok(()));
    assert!(format!("{car:?}") != before);
}

#[test]
fn a_reset_of_no_length_is_refused() {
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut tire = estimator::<f64>(500.0);
        assert_eq!(tire.begin_calibration(seconds).unwrap_err().name, "calibrate_s");
    }
}

/// Sensors that were out of order and come back early in a reset do not end it: what was set is still what it was.
#[test]
fn a_reset_goes_on_over_sensors_that_come_back() {
    let rows = CarRide { seconds: 20.0, pressure_kpa: |_| [PLACARD_KPA; 4], ..CarRide::new(5) }.rows();
    let mut car = car(&config::<f64>());
    car.begin_calibration(20.0).unwrap();
    let (before, after) = rows.split_at((5.0 * RATE_HZ) as usize);
    drive(&mut car, before);
    car.restart_corner(Corner::RearRight);
    // The second until frames of it are complete again is not looked at.
    for estimate in &drive(&mut car, after)[RATE_HZ as usize..] {
        for corner in estimate.corners.map(Option::unwrap) {
            assert!((corner.pressure_kpa - PLACARD_KPA).abs() < 4.0, "{} s: {corner:?}", estimate.time_s);
            // 1.57 % of the stiffness are 5.1 kPa, beside what a calibration sets to 1.5.
            assert!(corner.pressure_sd_kpa < 5.5, "{} s: {corner:?}", estimate.time_s);
        }
    }
}
