//! Estimators that are configured where they lie: the same as those that are handed on by value, whatever was there before.

use std::sync::{LazyLock, Mutex};

use itpms_core::car::CarEstimator;
use itpms_core::estimator::Estimator;
use itpms_core::model::{CarConfig, CarSample, Validity};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};

use crate::common::car_ride::{CarRide, RATE_HZ, cast, config};

static ROWS: LazyLock<Vec<CarSample<f64>>> =
    LazyLock::new(|| CarRide { seconds: 20.0, ..CarRide::new(9) }.rows());

/// A car of which the left side alone is measured, and no wheelbase is given: nothing is fused.
fn half() -> CarConfig<f32> {
    let [front_left, _, rear_left, _] = config().corners;
    CarConfig { corners: [front_left, None, rear_left, None], wheelbase_m: None }
}

/// What a car says of every fiftieth sample, and all it holds in the end, as text: NaN and minus zero show.
fn driven(car: &mut MonitoredCar<f32>) -> Vec<String> {
    let mut reported = Vec::new();
    for (i, row) in ROWS.iter().enumerate() {
        let estimate = car.update(&cast(row));
        if i % 50 == 0 {
            reported.push(format!("{estimate:?} {:?}", car.report()));
        }
    }
    reported.push(format!("{car:?}"));
    reported
}

#[test]
fn a_car_in_a_static_is_the_one_that_is_handed_on() {
    static CAR: Mutex<MonitoredCar<f32>> = Mutex::new(MonitoredCar::unconfigured());
    let car = &mut *CAR.lock().unwrap();
    let config = MonitorConfig::new(&config());
    for rate_hz in [RATE_HZ, f64::NAN] {
        // Before it is configured, and after that has failed: four corners are sampled, of which it knows none.
        if rate_hz.is_nan() {
            assert_eq!(car.configure(&config, rate_hz).unwrap_err().name, "sample_rate_hz");
        }
        for row in &ROWS[..2000] {
            assert!(car.update(&cast(row)).corners.iter().all(Option::is_none));
        }
        assert!(car.report().wheels.iter().all(Option::is_none) && !car.report().is_all_fine());
        car.configure(&config, RATE_HZ).unwrap();
        car.begin_calibration(8.0).unwrap();
        let mut handed_on = Box::new(MonitoredCar::new(&config, RATE_HZ).unwrap());
        handed_on.begin_calibration(8.0).unwrap();
        let reported = driven(car);
        assert!(reported.iter().any(|text| text.contains("validity: Valid")));
        assert_eq!(reported, driven(&mut handed_on));
        // Another car in its place, at another rate: nothing is left of the first.
        let config = MonitorConfig::new(&half());
        car.configure(&config, 200.0).unwrap();
        assert_eq!(format!("{car:?}"), format!("{:?}", MonitoredCar::new(&config, 200.0).unwrap()));
    }
}

#[test]
fn a_car_whose_monitor_or_corner_is_refused_is_not_configured() {
    let mut car = Box::new(MonitoredCar::<f32>::unconfigured());
    let fine = MonitorConfig::new(&config());
    let mut refused = fine;
    refused.reference_kpa[2] = Some(-1.0);
    car.configure(&fine, RATE_HZ).unwrap();
    assert_eq!(car.configure(&refused, RATE_HZ).unwrap_err().name, "reference_kpa");
    assert!(car.update(&cast(&ROWS[0])).corners.iter().all(Option::is_none));

    // The third corner's sensors are stated to have no noise.
    let mut estimator = Box::new(CarEstimator::<f32>::unconfigured());
    let mut refused = config();
    refused.corners[2].as_mut().unwrap().accel_noise_m_s2 = Some(0.0);
    assert!(estimator.configure(&refused, RATE_HZ).is_err());
    assert!(ROWS[..100].iter().all(|row| estimator.update(&cast(row)).corners.iter().all(Option::is_none)));
    estimator.configure(&config(), RATE_HZ).unwrap();
    assert!(estimator.update(&cast(&ROWS[0])).corners.iter().all(Option::is_some));
}

#[test]
fn an_estimator_may_be_configured_in_the_place_of_another() {
    let corner = config::<f64>().corners[0].unwrap();
    let mut estimator = Box::new(Estimator::unconfigured());
    let feed = |estimator: &mut Estimator<f64>| {
        for row in &ROWS[..3000] {
            let accelerations = row.corners[0].unwrap();
            let (body, wheel) = (accelerations.body_accel_m_s2, accelerations.wheel_accel_m_s2);
            estimator.update(row.time_s, row.speed_m_s, body, wheel);
        }
    };
    feed(&mut estimator);
    assert_eq!(estimator.counts().accepted, 0, "not configured, every sample is refused");
    assert_eq!(estimator.update(10.0, 20.0, 0.1, 0.2).validity, Validity::Starting);
    for _ in 0..2 {
        estimator.configure(&corner, RATE_HZ).unwrap();
        let mut handed_on = Estimator::new(&corner, RATE_HZ).unwrap();
        assert_eq!(format!("{estimator:?}"), format!("{handed_on:?}"));
        feed(&mut estimator);
        feed(&mut handed_on);
        assert!(estimator.counts().accepted > 2000);
        assert_eq!(format!("{estimator:?}"), format!("{handed_on:?}"));
    }
}
