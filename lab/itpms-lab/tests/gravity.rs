//! Sensors that show gravity: a car on a road so rough that its wheels leave it is read as if they did not.

use itpms_core::model::CarEstimate;
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_sim::road::{RoadClass, RoadSpec};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

/// What is shown every second of `drive-puncture` on class D with gravity in all sensors as they count it; the front left
/// tire goes down after 20 s.
fn shown(gravity_m_s2: f64) -> Vec<CarEstimate<f64>> {
    let mut scenario = Scenario::builtin("drive-puncture").unwrap();
    scenario.road = RoadSpec { contact_length_m: 0.1, ..RoadSpec::iso8608(RoadClass::D, 2.0) };
    (scenario.rate_hz, scenario.duration_s) = (200.0, 30.0);
    let config = scenario.car_config().unwrap();
    let mut car = Box::new(MonitoredCar::new(&MonitorConfig::new(&config), scenario.rate_hz).unwrap());
    let mut seconds = vec![];
    for (i, row) in Simulation::new(&scenario, 1).unwrap().enumerate() {
        let mut sample = row.car_sample();
        for corner in sample.corners.iter_mut().flatten() {
            corner.body_accel_m_s2 += gravity_m_s2;
            corner.wheel_accel_m_s2 += gravity_m_s2;
        }
        let estimate = car.update(&sample);
        if (i + 1) % 200 == 0 {
            seconds.push(estimate);
        }
    }
    seconds
}

#[test]
fn gravity_in_the_sensors_changes_no_pressure_where_wheels_leave_the_road() {
    let plain = shown(0.0);
    for gravity_m_s2 in [9.81, -9.81] {
        let with = shown(gravity_m_s2);
        let mut worst = 0.0_f64;
        // After the first seconds: it takes one to find the offset, and what was learned in it differs. (5 sd if it is never found.)
        for (a, b) in plain.iter().zip(&with).skip(10) {
            for (a, b) in a.corners.iter().zip(&b.corners) {
                let (a, b) = (a.unwrap(), b.unwrap());
                assert_eq!(a.validity, b.validity);
                worst = worst.max((a.pressure_kpa - b.pressure_kpa).abs() / a.pressure_sd_kpa);
            }
        }
        println!("{gravity_m_s2} m/s²: {worst:.2} sd");
        assert!(worst < 1.0, "{gravity_m_s2}: {worst} sd");
    }
}
