//! Warnings of wheel speeds, on simulated drives.

extern crate std;

use std::string::ToString as _;

use super::*;
use crate::wheel_speed::DrivenAxle;
use crate::wheel_speed::tests::Drive;

const RATE_HZ: f64 = 60.0;

fn monitored() -> MonitoredWheels<f32> {
    MonitoredWheels::new(&WheelSpeedConfig::new(2.66, 1.57, 1.57, DrivenAxle::Front)).unwrap()
}

/// Drives on; seconds until `until` holds.
fn drive(
    wheels: &mut MonitoredWheels<f32>,
    drive: &mut Drive,
    most_s: f64,
    until: impl Fn(&MonitoredWheels<f32>) -> bool,
) -> Option<f64> {
    let samples = (most_s * RATE_HZ) as u32;
    (0..samples).find_map(|k| {
        wheels.update(&drive.next());
        until(wheels).then(|| f64::from(k) / RATE_HZ)
    })
}

#[test]
fn a_calibration_ends_with_its_time_and_a_loss_is_reported_and_taken_back() {
    let (mut wheels, mut car) = (monitored(), Drive::new(5, RATE_HZ, 0.04));
    wheels.begin_calibration(300.0).unwrap();
    assert_eq!(wheels.state_of(Corner::RearRight), WheelState::Unknown(Doubt::Starting));
    let learned_s = drive(&mut wheels, &mut car, 400.0, |w| w.calibration().is_some()).unwrap();
    // Not after so much usable driving, of which there is less.
    assert!((learned_s - 300.0).abs() < 1.0, "{learned_s}");
    assert_eq!(drive(&mut wheels, &mut car, 600.0, |w| w.alert().is_some()), None);
    assert!(Corner::ALL.iter().all(|corner| wheels.state_of(*corner) == WheelState::Fine));
    // A quarter of its pressure, -.007 ln .75 of its radius.
    let loss = 0.007 * 0.75f64.ln();
    car.radius[3] += loss;
    let found_s = drive(&mut wheels, &mut car, 120.0, |w| w.alert().is_some()).unwrap();
    let alert = wheels.alert().unwrap();
    assert!(alert.wheels == Corner::RearRight.into() && knows(&alert) && alert.cause.is_low(), "{alert}");
    assert!(found_s < 60.0 && alert.since_s < alert.reported_s, "{alert}");
    let mut report = MonitorReport::empty();
    wheels.write_report_into(&mut report);
    let [fl, _, _, rr] = report.wheels.map(|wheel| wheel.unwrap());
    assert_eq!((rr.state, rr.warning), (WheelState::Low, Warning::Low));
    assert_eq!((fl.state, fl.warning), (WheelState::Fine, Warning::None));
    assert!(report.alerts().count() == 1 && !report.is_all_fine() && rr.pressure_kpa.is_nan());
    // Filled up again.
    car.radius[3] -= loss;
    let over_s = drive(&mut wheels, &mut car, 900.0, |w| w.alert().is_none()).unwrap();
    assert!(over_s > LASTING_S, "{over_s}");
}

#[test]
fn a_tire_is_not_fine_for_ever() {
    let (mut wheels, mut car) = (monitored(), Drive::new(5, RATE_HZ, 0.04));
    wheels.begin_calibration(300.0).unwrap();
    drive(&mut wheels, &mut car, 600.0, |_| false);
    assert_eq!(wheels.state_of(Corner::FrontLeft), WheelState::Fine);
    for (seconds, expected) in [(50.0, WheelState::Fine), (40.0, WheelState::Unknown(Doubt::NoInformation))] {
        for _ in 0..(seconds * RATE_HZ) as u32 {
            // One of the speeds is missing.
            let mut sample = car.next();
            sample.wheel_speed_m_s[3] = f32::NAN;
            wheels.update(&sample);
        }
        assert_eq!(wheels.state_of(Corner::FrontLeft), expected);
        assert_eq!(wheels.state_of(Corner::RearRight), WheelState::Malfunction);
        assert!(wheels.alert().unwrap().to_string().contains("rr wheel speed"), "{:?}", wheels.alert());
    }
    // It sends again, and is as the others.
    drive(&mut wheels, &mut car, 2.0, |_| false);
    assert_eq!(wheels.alert(), None);
    drive(&mut wheels, &mut car, 120.0, |_| false);
    assert!(Corner::ALL.iter().all(|corner| wheels.state_of(*corner) == WheelState::Fine));
}

/// Its sensor repeats the last value, or zero, as the car drives on.
#[test]
fn a_sensor_that_does_not_move_is_named_and_no_tire_is_low() {
    for (step_km_h, zero) in [(0.04, false), (0.04, true), (1e-4, false), (0.1, true)] {
        let (mut wheels, mut car) = (monitored(), Drive::new(5, RATE_HZ, step_km_h));
        wheels.begin_calibration(300.0).unwrap();
        drive(&mut wheels, &mut car, 400.0, |_| false);
        assert_eq!((wheels.calibration().is_some(), wheels.alert()), (true, None), "{step_km_h}");
        let mut held = None;
        for k in 0..(600.0 * RATE_HZ) as u32 {
            let mut sample = car.next();
            let last = *held.get_or_insert(if zero { 0.0 } else { sample.wheel_speed_m_s[2] });
            sample.wheel_speed_m_s[2] = last;
            wheels.update(&sample);
            let alert = wheels.alert();
            assert!(!alert.is_some_and(|alert| alert.cause.is_low()), "{step_km_h} {zero}: {alert:?}");
            // The car may be slow or stand when it begins.
            if f64::from(k) > 60.0 * RATE_HZ && sample.wheel_speed_m_s[0] > 6.0 {
                let alert =
                    alert.unwrap_or_else(|| panic!("{step_km_h} {zero}: {:.1} s", f64::from(k) / RATE_HZ));
                assert!(alert.to_string().contains("rl wheel speed sensor is stuck"), "{alert}");
                assert_eq!(wheels.state_of(Corner::RearLeft), WheelState::Malfunction);
                assert!(matches!(wheels.state_of(Corner::FrontLeft), WheelState::Unknown(_)));
            }
        }
        // It moves again.
        assert!(drive(&mut wheels, &mut car, 1.0, |w| w.alert().is_none()).is_some());
        assert_eq!(drive(&mut wheels, &mut car, 900.0, |w| w.alert().is_some()), None, "{step_km_h} {zero}");
        assert!(Corner::ALL.iter().all(|corner| wheels.state_of(*corner) == WheelState::Fine));
    }
}

#[test]
fn a_stray_stamp_ends_no_calibration() {
    for stray_s in [1e6, 1e200, -1e6, f64::NAN] {
        let (mut wheels, mut car) = (monitored(), Drive::new(5, RATE_HZ, 0.04));
        wheels.begin_calibration(300.0).unwrap();
        assert_eq!(drive(&mut wheels, &mut car, 100.0, |w| !w.is_calibrating()), None);
        wheels.update(&WheelSpeedSample { time_s: stray_s, ..car.next() });
        let left_s = drive(&mut wheels, &mut car, 300.0, |w| !w.is_calibrating()).unwrap();
        assert!((left_s - 200.0).abs() < 1.0, "{stray_s}: {left_s}");
    }
}

#[test]
fn a_calibration_goes_on_by_a_clock_that_was_set() {
    for set_s in [-50.0, 5000.0] {
        let (mut wheels, mut car) = (monitored(), Drive::new(5, RATE_HZ, 0.04));
        wheels.begin_calibration(300.0).unwrap();
        assert_eq!(drive(&mut wheels, &mut car, 100.0, |w| !w.is_calibrating()), None);
        let left_s = (0..400 * RATE_HZ as u32).find_map(|k| {
            let sample = car.next();
            wheels.update(&WheelSpeedSample { time_s: sample.time_s + set_s, ..sample });
            (!wheels.is_calibrating()).then(|| f64::from(k) / RATE_HZ)
        });
        assert!((left_s.unwrap() - 200.0).abs() < 1.0, "{set_s}: {left_s:?}");
    }
}

#[test]
fn a_calibration_without_driving_teaches_nothing() {
    let (mut wheels, mut car) = (monitored(), Drive::new(6, RATE_HZ, 0.04));
    wheels.begin_calibration(9.0).unwrap();
    assert_eq!(drive(&mut wheels, &mut car, 300.0, |w| w.calibration().is_some()), None);
    assert_eq!(wheels.radii().state, RadiusState::Uncalibrated);
    assert!(wheels.begin_calibration(f64::NAN).is_err());
}

#[test]
fn what_is_only_likely_waits_for_a_minute() {
    let (mut wheels, mut car) = (monitored(), Drive::new(7, RATE_HZ, 0.04));
    wheels.begin_calibration(300.0).unwrap();
    drive(&mut wheels, &mut car, 310.0, |_| false);
    let pending = |w: &MonitoredWheels<f32>| {
        let least = |wheels: Wheels| wheels.iter().map(|c| low_probability(w.radii(), c)).fold(1.0, f32::min);
        matches!(w.radii().state, RadiusState::Low(wheels) if least(wheels) < 0.999)
    };
    // As a fifth is lost slowly, it is likely first and certain later, or says so after a minute.
    for _ in 0..200 {
        car.radius[1] -= 0.007 * 1.25f64.ln() / 200.0;
        drive(&mut wheels, &mut car, 1.0, |_| false);
        if pending(&wheels) {
            let state = wheels.state_of(Corner::FrontRight);
            let early = wheels.radii().lasted_s < 59.0 && wheels.alert().is_none();
            assert!(!early || state == WheelState::Unknown(Doubt::Uncertain), "{state:?}");
        }
    }
    assert!(drive(&mut wheels, &mut car, 900.0, |w| w.alert().is_some()).is_some());
    assert_eq!(wheels.alert().unwrap().wheels, Corner::FrontRight.into());
}

#[test]
fn what_is_reported_names_wheels_or_says_that_it_cannot() {
    let alert = |wheels: Wheels, is_known| Alert {
        wheels,
        since_s: 10.0,
        reported_s: 12.0,
        cause: Cause::Differs { lost_share: 0.25f64, lost_sd_share: 0.13, is_known, probability: 0.995 },
    };
    let all: Wheels = Corner::ALL.into_iter().collect();
    let pair = Wheels::from(Corner::FrontLeft) | Wheels::from(Corner::RearRight);
    for (wheels, is_known, text) in [
        (
            Corner::RearRight.into(),
            true,
            "rr differs from the other tires since the calibration: it turns as with 25 % (sd 13) of its pressure lost, by the wheel speeds; since 10.0 s, reported at 12.0 s",
        ),
        (
            all,
            true,
            "all four tires have lost air since the calibration, up to 25 % (sd 13) of their pressure, by the wheel speeds; since 10.0 s, reported at 12.0 s",
        ),
        (
            pair,
            false,
            "one of fl rr differs from the other tires since the calibration, by the wheel speeds; since 10.0 s, reported at 12.0 s",
        ),
        (
            all,
            false,
            "one of the tires differs from the others since the calibration, by the wheel speeds; since 10.0 s, reported at 12.0 s",
        ),
    ] {
        assert_eq!(alert(wheels, is_known).to_string(), text);
    }
}

#[test]
fn it_fits_into_five_kilobytes() {
    assert!(core::mem::size_of::<MonitoredWheels<f32>>() < 5000);
}
