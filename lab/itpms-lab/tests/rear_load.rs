//! A rear axle that carries two fifths more than at the calibration, of which a car with wheel speeds alone knows nothing: it rolls on
//! smaller radii, as tires do that have lost air, and must not be taken for that.

use itpms_core::monitor::MonitoredWheels;
use itpms_core::warning::Alert;
use itpms_core::wheel_speed::{DrivenAxle, RadiusCalibration, WheelSpeedConfig, WheelSpeedSample};
use itpms_sim::car::PayloadSpec;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use itpms_sim::wheel_speeds::WheelSpeedSpec;

const DRIVES: u64 = 50;
const LEARNING_S: f64 = 900.0;
const DRIVE_S: f64 = 1800.0;
/// Two fifths of the load of a rear axle of 216 and 50 kg a wheel.
const MORE_KG: f64 = 0.4 * 2.0 * 266.0;

/// An everyday drive of a car, with warm-up, grades and bends, and so much more over its rear axle.
fn drive(car_seed: u64, drive_s: f64, more_kg: f64) -> Scenario {
    let mut scenario = Scenario::builtin("drive-normal").unwrap();
    scenario.duration_s = drive_s;
    scenario.rate_hz = 50.0;
    scenario.wheel_speeds = Some(WheelSpeedSpec {
        alone: true,
        car_seed: Some(car_seed),
        accel_x: car_seed.is_multiple_of(2),
        ..WheelSpeedSpec::default()
    });
    let journey = scenario.journey.as_mut().unwrap();
    (journey.warms_by_k, journey.load_kg, journey.tolerances) = (20.0, 0.0, None);
    let mut scenario = scenario.composed(car_seed + if more_kg > 0.0 { 1000 } else { 0 }).unwrap();
    let points_s_kg = vec![[0.0, more_kg]];
    scenario.car.as_mut().unwrap().payload =
        vec![PayloadSpec { behind_front_m: scenario.wheelbase_m, left_m: 0.0, points_s_kg }];
    scenario
}

fn monitor() -> Box<MonitoredWheels<f64>> {
    Box::new(MonitoredWheels::new(&WheelSpeedConfig::new(2.7, 1.55, 1.55, DrivenAxle::Front)).unwrap())
}

fn reported(wheels: &mut MonitoredWheels<f64>, scenario: &Scenario, seed: u64) -> Option<Alert<f64>> {
    let mut first = None;
    for row in Simulation::new(scenario, seed).unwrap() {
        let bus = row.wheel_speeds.unwrap();
        wheels.update(&WheelSpeedSample {
            time_s: row.time_s,
            wheel_speed_m_s: bus.wheel_speed_m_s,
            yaw_rate_rad_s: bus.yaw_rate_rad_s,
            accel_x_m_s2: bus.accel_x_m_s2,
            accel_y_m_s2: bus.accel_y_m_s2,
            brake: Some(bus.brake > 0.5),
        });
        first = first.or(wheels.alert());
    }
    first
}

fn calibration(seed: u64) -> RadiusCalibration<f64> {
    let mut wheels = monitor();
    wheels.begin_calibration(LEARNING_S - 1.0).unwrap();
    assert_eq!(reported(&mut wheels, &drive(seed, LEARNING_S, 0.0), seed), None);
    let learned = wheels.calibration();
    assert!(learned.is_some(), "nothing learned with seed {seed}");
    *learned.unwrap()
}

#[test]
fn a_heavier_rear_axle_is_not_taken_for_a_loss() {
    for seed in 1..=DRIVES {
        let mut wheels = monitor();
        assert!(wheels.load_calibration(&calibration(seed)));
        let alert = reported(&mut wheels, &drive(seed, DRIVE_S, MORE_KG), seed + 1000);
        assert!(alert.is_none(), "seed {seed}: {}", alert.unwrap());
    }
}
