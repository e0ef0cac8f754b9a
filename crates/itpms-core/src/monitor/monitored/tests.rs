//! A car with wheel speeds, alone and beside accelerations.

extern crate std;

use std::format;

use super::*;
use crate::model::{CarConfig, CornerConfig, CornerSample, PressureMap, QuarterCar};
use crate::torsion::TorsionConfig;
use crate::warning::Cause;
use crate::wheel_speed::tests::Drive;
use crate::wheel_speed::{DrivenAxle, WheelSpeedConfig, WheelSpeedSample};

const RATE_HZ: f64 = 60.0;

fn wheel_speeds() -> WheelSpeedConfig<f64> {
    WheelSpeedConfig::new(2.66, 1.57, 1.57, DrivenAxle::Front)
}

/// A calibration of 300 s, then a quarter of the rear right tire's pressure lost at 360 s.
fn drive(mut take: impl FnMut(&WheelSpeedSample<f64>)) {
    let mut drive = Drive::new(5, RATE_HZ, 0.04);
    for k in 0..(480.0 * RATE_HZ) as u32 {
        if k == (360.0 * RATE_HZ) as u32 {
            drive.radius[3] += 0.007 * 0.75f64.ln();
        }
        take(&drive.next());
    }
}

#[test]
fn without_corners_it_is_the_monitor_of_its_wheel_speeds_at_any_rate() {
    let config = CarConfig { corners: [None; 4], wheelbase_m: None };
    let config = MonitorConfig { wheel_speeds: Some(wheel_speeds()), ..MonitorConfig::new(&config) };
    let mut car = std::boxed::Box::new(MonitoredCar::unconfigured());
    car.configure(&config, RATE_HZ).unwrap();
    let mut wheels = MonitoredWheels::new(&wheel_speeds()).unwrap();
    car.begin_calibration(300.0).unwrap();
    wheels.begin_calibration(300.0).unwrap();
    let (mut expected, mut warned) = (MonitorReport::empty(), false);
    drive(|sample| {
        wheels.update(sample);
        wheels.write_report_into(&mut expected);
        car.update(&CarSample::of_wheel_speeds(*sample));
        warned |= expected.alerts().count() > 0;
        assert_eq!(format!("{:?}", car.report()), format!("{expected:?}"));
    });
    assert!(warned);
}

/// A car of four corners with wheel speeds.
fn with_corners() -> std::boxed::Box<MonitoredCar<f64>> {
    let quarter = QuarterCar::new(400.0, 45.0, 1800.0, 25e3).unwrap();
    let corner = CornerConfig::new(quarter, PressureMap::new(0.9e3, 40e3).unwrap(), 240.0).unwrap();
    let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.66) };
    let config = MonitorConfig { wheel_speeds: Some(wheel_speeds()), ..MonitorConfig::new(&config) };
    let mut car = std::boxed::Box::new(MonitoredCar::unconfigured());
    car.configure(&config, 200.0).unwrap();
    car
}

#[test]
fn a_message_between_two_samples_leaves_the_accelerations_as_they_are() {
    let mut car = with_corners();
    let corners = [Some(CornerSample { body_accel_m_s2: 0.1, wheel_accel_m_s2: 0.5 }); 4];
    car.update(&CarSample { time_s: 0.0, speed_m_s: 20.0, corners, wheel_speeds: None });
    let before = format!("{:?}", car.estimator());
    let estimate = car.update(&CarSample::of_wheel_speeds(Drive::new(5, RATE_HZ, 0.04).next()));
    assert!(estimate.corners.iter().all(Option::is_none));
    assert!(car.wheels().is_some_and(|wheels| wheels.radii().time_s == estimate.time_s));
    assert_eq!(format!("{:?}", car.estimator()), before);
}

#[test]
fn tooth_pulses_of_the_car_begin_and_end_their_calibration_with_its_wheel_speeds() {
    let config = CarConfig { corners: [None; 4], wheelbase_m: None };
    let config = MonitorConfig { wheel_speeds: Some(wheel_speeds()), ..MonitorConfig::new(&config) };
    let mut beside = CarTorsion::unconfigured();
    beside.configure(&[TorsionConfig::new(); 4], &[240.0; 4]).unwrap();
    let mut of_car = beside.clone();
    let mut car = std::boxed::Box::new(MonitoredCar::unconfigured_with(None));
    car.configure(&config, RATE_HZ).unwrap();
    car.read_pulses(&mut of_car);
    let mut wheels = MonitoredWheels::new(&wheel_speeds()).unwrap();
    car.begin_calibration_at(300.0, &[1.1; 4]).unwrap();
    wheels.begin_calibration_at(300.0, &[1.1; 4]).unwrap();
    beside.begin_calibration_at(&[1.1; 4]);
    // Some 500 teeth a second, of a wheel that does not shake.
    let mut edges = 0;
    drive(|sample| {
        while 2e-3 * f64::from(edges) < sample.time_s.min(330.0) {
            beside.push(Corner::FrontLeft, 2e-3 * f64::from(edges));
            car.torsion_mut().unwrap().push(Corner::FrontLeft, 2e-3 * f64::from(edges));
            edges += 1;
        }
        wheels.update_with_pulses(sample, Some(&mut beside));
        car.update(&CarSample::of_wheel_speeds(*sample));
    });
    assert_eq!(format!("{:?}", car.torsion()), format!("{:?}", Some(&beside)));
    assert_eq!(format!("{:?}", car.wheels()), format!("{:?}", Some(&wheels)));
    assert!(!wheels.is_calibrating() && edges > 100_000);
}

#[test]
fn beside_accelerations_its_alert_stands_in_the_cars_report_until_the_car_is_calibrated_again() {
    let mut car = with_corners();
    car.begin_calibration(300.0).unwrap();
    drive(|sample| {
        // Its accelerometers have nothing to say.
        let message = CarSample::of_wheel_speeds(*sample);
        car.update(&CarSample { wheel_speeds: None, ..message });
        car.update(&message);
    });
    let named = |car: &MonitoredCar<f64>| {
        let differs = |alert: &&crate::warning::Alert<f64>| matches!(alert.cause, Cause::Differs { .. });
        car.report().alerts().find(differs).map(|alert| alert.wheels)
    };
    assert_eq!(named(&car), Some(Corner::RearRight.into()));
    assert!(car.report().wheels.iter().flatten().all(|wheel| !wheel.validity.is_valid()));
    car.begin_calibration(300.0).unwrap();
    assert_eq!(named(&car), None);
}
