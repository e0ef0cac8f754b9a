//! The belief of the seconds in which a sensor read wrong is rolled back, and nothing else for long.

use itpms_core::car::CarEstimator;
use itpms_core::model::{CarEstimate, CarSample, Corner, CornerSample};

use crate::common::car_ride::{CarRide, PLACARD_KPA, RATE_HZ, car, config, drive};

/// The rear right wheel's sensor reads twice its value for four seconds, and is then kept away: the front right tire,
/// which was taken for the one that had changed, is read as before, to 12 kPa on three roads. (Else it stays too low for many seconds more.)
#[test]
fn what_a_sensor_taught_that_lied_is_unlearned() {
    for seed in [1, 5, 9] {
        let rows = CarRide { seconds: 34.0, ..CarRide::new(seed) }.rows();
        let front_right = |car: &mut CarEstimator<f64>, from_s: f64, to_s: f64| {
            let range = (from_s * RATE_HZ) as usize..(to_s * RATE_HZ) as usize;
            let rows: Vec<_> = rows[range].iter().map(|row| lying(row, 24.0, 28.0)).collect();
            drive(car, &rows).last().unwrap().corners[1].unwrap().pressure_kpa
        };
        let mut car = car(&config());
        let before = front_right(&mut car, 0.0, 24.0);
        let misled = front_right(&mut car, 24.0, 28.0);
        assert!(misled < before - 40.0, "{seed}: {misled} kPa, {before} before");
        let mut rolled_back = car.clone();
        rolled_back.rollback([false, false, false, true]);
        let [misled, rolled_back] = [&mut car, &mut rolled_back].map(|car| front_right(car, 28.0, 34.0));
        assert!(
            misled < before - 20.0 && (rolled_back - before).abs() < 12.0,
            "{seed}: {misled} {rolled_back} {before} kPa"
        );
    }
}

/// The rear right wheel's sensor reads twice its value, and then nothing.
fn lying(row: &CarSample<f64>, since_s: f64, until_s: f64) -> CarSample<f64> {
    let mut row = *row;
    if let Some(rear_right) = &mut row.corners[3] {
        if row.time_s >= until_s {
            *rear_right = CornerSample { body_accel_m_s2: f64::NAN, wheel_accel_m_s2: f64::NAN };
        } else if row.time_s >= since_s {
            rear_right.wheel_accel_m_s2 *= 2.0;
        }
    }
    row
}

/// Nothing contradicts what was known at the start, and a driver's word is no contradiction: the tire that has 200 kPa has its
/// placard pressure from then on.
#[test]
fn only_what_contradicts_is_unlearned() {
    let rows = CarRide::new(5).rows();
    // Between two frames: one that is under way is dropped.
    let (before, after) = rows.split_at((3.03 * RATE_HZ) as usize);
    let mut car = car(&config::<f64>());
    drive(&mut car, &before[..before.len() - 5]);
    for reset_s in [None, Some(10.0)] {
        let mut car = car.clone();
        if let Some(seconds) = reset_s {
            car.begin_calibration(seconds).unwrap();
        }
        drive(&mut car, &before[before.len() - 5..]);
        let mut rolled_back = car.clone();
        rolled_back.rollback([false; 4]);
        let [kept, rolled_back] = [&mut car, &mut rolled_back].map(|car| {
            let corners = drive(car, &after[..5])[4].corners;
            corners.map(|corner| [corner.unwrap().pressure_kpa, corner.unwrap().pressure_sd_kpa])
        });
        assert_eq!(kept, rolled_back);
        let off_kpa = rolled_back[0][0] - PLACARD_KPA;
        assert!((off_kpa.abs() < 1.0) == reset_s.is_some(), "{reset_s:?}: {off_kpa} kPa");
    }
}

/// A car whose front right tire lost a fifth two seconds ago, which it knows, and the rest of its drive.
fn with_a_loss() -> (Box<CarEstimator<f64>>, Vec<CarSample<f64>>) {
    let ride = CarRide {
        seconds: 30.0,
        pressure_kpa: |t| [235.0, 240.0 - 24.0 * (t - 20.0).clamp(0.0, 2.0), 238.0, 243.0],
        ..CarRide::new(21)
    };
    let mut rows = ride.rows();
    let after = rows.split_off((24.0 * RATE_HZ) as usize);
    let mut car = Box::new(car(&config()));
    assert!(drive(&mut car, &rows).last().unwrap().corners[1].unwrap().pressure_kpa < 205.0);
    (car, after)
}

/// A tire has just lost a fifth when sensors of the other corners are suspected for nothing: the loss is rolled back, and found
/// again. Where its own are, it stays lost: lying they would have made another tire look so.
#[test]
fn a_loss_that_was_unlearned_is_found_again() {
    let (mut car, after) = with_a_loss();
    let front_right = |estimate: &CarEstimate<f64>| estimate.corners[1].unwrap().pressure_kpa;
    let mut own = car.clone();
    own.rollback([false, true, false, false]);
    assert!(front_right(&drive(&mut own, &after[..1])[0]) < 205.0);
    car.rollback([true, false, true, true]);
    let estimates = drive(&mut car, &after);
    assert!(front_right(&estimates[0]) > 230.0);
    let again = front_right(&estimates[RATE_HZ as usize]);
    assert!((again - 192.0).abs() < 8.0, "{again} kPa after a second");
}

/// A tire has just lost a fifth, and sensors of one other corner are suspected: the loss may be real and may be what they have
/// taught. On a side of which nothing is suspected it is what it seems, beside a suspected corner what it was; either way it is
/// doubted, so that frames soon tell.
#[test]
fn what_has_moved_beside_a_suspected_corner_is_doubted() {
    let (car, after) = with_a_loss();
    for (suspected, is_lost) in [([true, false, false, false], true), ([false, false, false, true], false)] {
        let mut car = car.clone();
        car.rollback(suspected);
        let read = drive(&mut car, &after);
        let [first, then] = [0, RATE_HZ as usize].map(|k| read[k].corners[1].unwrap());
        assert_eq!(first.pressure_kpa < 205.0, is_lost, "{suspected:?}: {first:?}");
        assert!(is_lost || first.pressure_kpa > 225.0, "{suspected:?}: {first:?}");
        // By so much it has moved.
        assert!(first.pressure_sd_kpa > 25.0, "{suspected:?}: {first:?}");
        assert!((then.pressure_kpa - 192.0).abs() < 8.0, "{suspected:?}: {then:?}");
    }
}

/// A tire's own sensor lies for three seconds, and after two it is suspected. Once it is reported that it lied, the tire is what it
/// was before it did, whether it was misread by far (a wheel's sensor) or too little to be doubted (a
/// body's). As long as it is not reported, it is what it seems to be.
#[test]
fn what_a_tire_was_before_its_sensors_lied_counts_once_that_is_reported() {
    let rows = CarRide { seconds: 28.0, ..CarRide::new(5) }.rows();
    let at = |time_s: f64| (time_s * RATE_HZ) as usize;
    let rear_right = |car: &mut CarEstimator<f64>, rows: &[CarSample<f64>]| {
        drive(car, rows).last().unwrap().corners[3].unwrap()
    };
    let mut honest = car(&config::<f64>());
    let before = rear_right(&mut honest, &rows[..at(24.0)]);
    for ([body, wheel], misread_kpa) in [([1.0, 0.5], -150.0..-50.0), ([2.0, 1.0], 1.0..8.0)] {
        let lying = |row: &CarSample<f64>| {
            let corner = row.corners[3].unwrap();
            let gain = if row.time_s < 27.0 { [body, wheel] } else { [f64::NAN; 2] };
            let mut row = *row;
            row.corners[3] = Some(CornerSample {
                body_accel_m_s2: gain[0] * corner.body_accel_m_s2,
                wheel_accel_m_s2: gain[1] * corner.wheel_accel_m_s2,
            });
            row
        };
        let rows: Vec<_> = rows.iter().map(lying).collect();
        let mut car = honest.clone();
        drive(&mut car, &rows[at(24.0)..at(26.0)]);
        car.rollback([false, false, false, true]);
        let misled = rear_right(&mut car, &rows[at(26.0)..at(27.0)]);
        assert!(misread_kpa.contains(&(misled.pressure_kpa - before.pressure_kpa)), "{misled:?}");
        let mut unreported = car.clone();
        car.restart_corner(Corner::RearRight);
        let [reported, unreported] =
            [&mut car, &mut unreported].map(|car| rear_right(car, &rows[at(27.0)..at(27.1)]));
        let off_kpa = [reported, unreported].map(|corner| (corner.pressure_kpa - before.pressure_kpa).abs());
        assert!(off_kpa[0] < 4.0 && off_kpa[0] < 0.5 * off_kpa[1], "{off_kpa:?}");
        // For as long as nothing was read of it, it may have changed.
        assert!(reported.pressure_sd_kpa > 1.5 * before.pressure_sd_kpa, "{reported:?} {before:?}");
    }
}
