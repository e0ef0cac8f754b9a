//! A car of which a part has fallen silent: its speed is not sent, or sensors of the rear axle are gone. What is still
//! received goes on, and states how well.

use std::sync::LazyLock;

use itpms_core::model::{CarEstimate, CarSample, Corner, CornerSample};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::warning::WheelState;

use crate::common::car_ride::{CarRide, RATE_HZ, car, config, drive};

/// The front left tire loses 90 kPa in two seconds.
fn pressure_kpa(time_s: f64) -> [f64; 4] {
    [240.0 - 45.0 * (time_s - 20.0).clamp(0.0, 2.0), 235.0, 240.0, 238.0]
}

static ROWS: LazyLock<Vec<CarSample<f64>>> =
    LazyLock::new(|| CarRide { seconds: 70.0, pressure_kpa, ..CarRide::new(5) }.rows());

fn changed(change: impl Fn(&mut CarSample<f64>)) -> Vec<CarSample<f64>> {
    let mut rows = ROWS.clone();
    rows.iter_mut().for_each(change);
    rows
}

fn without_speed(from_s: f64, to_s: f64) -> Vec<CarSample<f64>> {
    changed(|row| {
        if (from_s..to_s).contains(&row.time_s) {
            row.speed_m_s = f64::NAN;
        }
    })
}

/// The car whose corners are gone from 10 s on.
fn without_corners(corners: &[Corner]) -> Vec<CarSample<f64>> {
    let gone = Some(CornerSample { body_accel_m_s2: f64::NAN, wheel_accel_m_s2: f64::NAN });
    changed(|row| {
        if row.time_s >= 10.0 {
            corners.iter().for_each(|corner| row.corners[corner.index()] = gone);
        }
    })
}

/// Every valid pressure within four of its sds; the loss read within ten seconds, to 25 kPa.
fn assert_followed(name: &str, estimates: &[CarEstimate<f64>], from_s: f64) {
    let mut worst = 0.0f64;
    for estimate in estimates.iter().filter(|estimate| estimate.time_s >= from_s) {
        for (corner, truth_kpa) in estimate.corners.iter().flatten().zip(pressure_kpa(estimate.time_s)) {
            // What falls is followed with a delay, to which the sd is no limit.
            let falling = (20.0..30.0).contains(&estimate.time_s);
            if corner.validity.is_valid() && !falling {
                worst = worst.max((corner.pressure_kpa - truth_kpa).abs() / corner.pressure_sd_kpa);
            }
        }
        if estimate.time_s >= 30.0 {
            let front_left = estimate.corners[0].unwrap();
            let off_kpa = front_left.pressure_kpa - 150.0;
            assert!(front_left.validity.is_valid() && off_kpa.abs() < 25.0, "{name}: {front_left:?}");
        }
    }
    println!("{name}: {worst:.1} sd");
    assert!(worst < 4.0, "{name}: {worst} sd");
}

#[test]
fn a_car_that_never_tells_its_speed_is_left_to_its_corners() {
    let estimates = drive(&mut car(&config::<f64>()), &without_speed(0.0, f64::INFINITY));
    assert!(estimates.iter().all(|estimate| estimate.tracks.iter().all(|track| !track.shared)));
    assert_followed("never", &estimates, 8.0);
}

#[test]
fn words_go_on_where_the_axles_no_longer_share_a_road() {
    use Corner::{RearLeft, RearRight};
    let unknown = without_speed(10.0, 55.0);
    let (one, both) = (without_corners(&[RearLeft]), without_corners(&[RearLeft, RearRight]));
    for (name, rows) in [("no speed", &unknown), ("no rear left", &one), ("no rear axle", &both)] {
        let estimates = drive(&mut car(&config::<f64>()), rows);
        assert_followed(name, &estimates, 0.0);
        let at = |time_s: f64| estimates[(time_s * RATE_HZ) as usize - 1];
        let sd = |time_s: f64| at(time_s).corners[0].unwrap().pressure_sd_kpa;
        // Before the loss the spectrum knows less than the shared road did, of whose instruments ten seconds have taught four fifths.
        assert!(sd(10.0) < 11.0 && sd(20.0) > 1.05 * sd(10.0), "{name}: {} {}", sd(10.0), sd(20.0));
        // As soon as the speed is back, the roads are shared again.
        let shared = at(70.0).tracks[0].shared;
        assert_eq!(shared, name == "no speed");
        assert!(!shared || sd(70.0) < 6.0, "{}", sd(70.0));
    }
}

fn monitored() -> MonitoredCar<f64> {
    MonitoredCar::new(&MonitorConfig::new(&config()), RATE_HZ).unwrap()
}

/// What a car that was fine for 15 s says while `rows` follow.
fn after_fifteen_seconds(rows: impl Iterator<Item = CarSample<f64>>) -> Vec<[WheelState; 4]> {
    let mut car = monitored();
    for row in ROWS.iter().take_while(|row| row.time_s < 15.0) {
        car.update(row);
    }
    assert!(car.report().is_all_fine(), "{:?}", car.report());
    rows.map(|row| {
        let estimate = car.update(&row);
        let wheels = car.report().wheels.map(|wheel| wheel.unwrap());
        for (wheel, corner) in wheels.iter().zip(estimate.corners) {
            assert!(corner.unwrap().validity.is_valid() || wheel.state != WheelState::Fine);
        }
        wheels.map(|wheel| wheel.state)
    })
    .collect()
}

/// What eight hours in a car park have done to a tire is unknown.
#[test]
fn after_a_night_nothing_is_fine_before_it_is_learned_anew() {
    const NIGHT_S: f64 = 28_800.0;
    let mut noise = 0.02;
    let parked = ROWS.iter().take(2500).map(|row| {
        noise = -1.01 * noise % 0.1;
        let still = Some(CornerSample { body_accel_m_s2: noise, wheel_accel_m_s2: 1.5 * noise });
        CarSample { time_s: row.time_s + NIGHT_S, speed_m_s: 0.0, corners: [still; 4], wheel_speeds: None }
    });
    let (rows, on) = (ROWS.iter(), NIGHT_S + 20.0);
    let driven = rows.take(2500).map(|row| CarSample { time_s: row.time_s + on, ..*row });
    let states = after_fifteen_seconds(parked.chain(driven));
    assert!(states[..2500].iter().flatten().all(|state| matches!(state, WheelState::Unknown(_))));
    assert_eq!(states.last().unwrap(), &[WheelState::Fine; 4]);
}

/// What was known a minute ago is known now, from the first sample on: a program that starts again reports what it reported.
#[test]
fn after_a_short_pause_what_was_known_is_known() {
    for pause_s in [2.0, 60.0] {
        let rows = ROWS.iter().filter(|row| (15.0..17.0).contains(&row.time_s));
        let states =
            after_fifteen_seconds(rows.map(|row| CarSample { time_s: row.time_s + pause_s, ..*row }));
        assert!(states.iter().all(|states| *states == [WheelState::Fine; 4]), "{pause_s}: {states:?}");
    }
}

/// A corner that the samples leave out is one that tells nothing.
#[test]
fn a_corner_that_is_left_out_is_not_fine() {
    let rows = ROWS.iter().filter(|row| (15.0..19.0).contains(&row.time_s));
    let states = after_fifteen_seconds(rows.map(|row| {
        let [front_left, front_right, rear_left, _] = row.corners;
        CarSample { corners: [front_left, front_right, rear_left, None], ..*row }
    }));
    let [.., rear_right] = states.last().unwrap();
    assert_eq!(*rear_right, WheelState::Malfunction);
}

/// A loss that only words tell is warned of, and no other wheel is.
#[test]
fn a_loss_is_warned_of_without_a_speed() {
    let mut car = monitored();
    let mut warned_s = None;
    for row in &without_speed(10.0, f64::INFINITY) {
        car.update(row);
        let report = car.report();
        let low = |corner: Corner| report.wheels[corner.index()].unwrap().state == WheelState::Low;
        assert!(Corner::ALL[1..].iter().all(|corner| !low(*corner)), "{report:?}");
        if warned_s.is_none() && low(Corner::FrontLeft) {
            warned_s = Some(row.time_s);
        }
    }
    assert!(warned_s.is_some_and(|at_s| (22.0..40.0).contains(&at_s)), "{warned_s:?}");
}
