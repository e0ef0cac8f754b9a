//! A car with wheel speeds, alone and beside accelerations.

extern crate std;

use std::format;

use super::*;
use crate::model::{CarConfig, CornerConfig, PressureMap, QuarterCar};
use crate::warning::Cause;
use crate::wheel_speed::tests::Drive;
use crate::wheel_speed::{DrivenAxle, WheelSpeedConfig};

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
        car.update_wheel_speeds(sample, None);
        warned |= expected.alerts().count() > 0;
        assert_eq!(format!("{:?}", car.report()), format!("{expected:?}"));
    });
    assert!(warned);
}

#[test]
fn beside_accelerations_its_alert_stands_in_the_cars_report_until_the_car_is_calibrated_again() {
    let quarter = QuarterCar::new(400.0, 45.0, 1800.0, 25e3).unwrap();
    let tire = PressureMap::new(0.9e3, 40e3).unwrap();
    let corner = CornerConfig::new(quarter, tire, 240.0).unwrap();
    let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.66) };
    let config = MonitorConfig { wheel_speeds: Some(wheel_speeds()), ..MonitorConfig::new(&config) };
    let mut car = std::boxed::Box::new(MonitoredCar::unconfigured());
    car.configure(&config, 200.0).unwrap();
    car.begin_calibration(300.0).unwrap();
    drive(|sample| {
        // Its accelerometers have nothing to say.
        let silent = CarSample { time_s: sample.time_s, speed_m_s: f64::NAN, corners: [None; 4] };
        car.update(&silent);
        car.update_wheel_speeds(sample, None);
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
