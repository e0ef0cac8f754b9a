//! The roads under a car that is being estimated.

use itpms_core::conditioning::SampleClock;
use itpms_core::model::{CarSample, Corner};
use itpms_road::{RoadConfig, RoadFilter, RoadUnderCar};

use crate::common::car_ride::{CarRide, RATE_HZ, car, config};

/// Under a car whose stiffnesses are fed into single filters by hand, the roads are the same to the last digit.
#[test]
fn each_wheel_has_the_road_of_a_filter_of_its_own() {
    let rows = CarRide { seconds: 12.0, ..CarRide::new(5) }.rows();
    let config = config::<f64>();
    let (mut car, mut roads) = (car(&config), RoadUnderCar::new(&config, RATE_HZ).unwrap());
    let corner = config.corners[2].unwrap();
    let road = RoadConfig::new(corner.quarter_car, corner.initial_stiffness_n_per_m(), 0.05).unwrap();
    let (mut alone, mut reported_s, mut known) = (RoadFilter::new(&road), f64::NEG_INFINITY, 0);
    // Times count from the first stamp on, as the car's do: a tenth of a second ends with the same sample.
    let mut clock = SampleClock::<f64>::new(RATE_HZ).unwrap();
    for row in &rows {
        let now_s = clock.take(row.time_s, row.speed_m_s).now_s;
        let mut estimate = car.update(row);
        let cars = car.quarter_cars();
        assert!(estimate.corners.iter().flatten().all(|corner| corner.road_m.is_nan()));
        roads.update(row, &cars, &mut estimate);
        let rear_left = estimate.corners[2].unwrap();
        if !(now_s - reported_s < 0.1) {
            reported_s = now_s;
            alone.set_stiffness(rear_left.stiffness_n_per_m, rear_left.stiffness_sd_n_per_m).unwrap();
            alone.set_quarter_car(cars[2].unwrap());
        }
        let expected = alone.update(now_s, row.corners[2].as_ref().unwrap());
        if expected.validity.is_valid() {
            known += 1;
            assert_eq!((rear_left.road_m, rear_left.road_sd_m), (expected.road_m, expected.road_sd_m));
        } else {
            assert!(rear_left.road_m.is_nan() && rear_left.road_sd_m.is_nan());
        }
    }
    assert!(known > rows.len() / 3, "{known} of {}", rows.len());
}

/// A wheel sensor that falls silent leaves its road unknown, and the others as they are.
#[test]
fn a_silent_sensor_tells_nothing_of_its_road() {
    let rows = CarRide { seconds: 14.0, ..CarRide::new(6) }.rows();
    let config = config::<f64>();
    let (mut car, mut roads) = (car(&config), RoadUnderCar::new(&config, RATE_HZ).unwrap());
    let mut last = None;
    for row in &rows {
        let mut row: CarSample<f64> = *row;
        if row.time_s > rows[0].time_s + 12.0 {
            row.corners[Corner::FrontRight.index()].as_mut().unwrap().wheel_accel_m_s2 = f64::NAN;
        }
        let mut estimate = car.update(&row);
        roads.update(&row, &car.quarter_cars(), &mut estimate);
        last = Some(estimate);
    }
    let known = last.unwrap().corners.map(|corner| corner.unwrap().road_m.is_finite());
    assert_eq!(known, [true, false, true, true]);
}
