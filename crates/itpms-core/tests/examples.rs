//! The examples run, and what they show is so.

#[path = "../examples/one_wheel.rs"]
mod one_wheel;
#[path = "../examples/own_evidence.rs"]
mod own_evidence;
#[path = "../examples/puncture.rs"]
mod puncture;
#[path = "../examples/wheel_speeds.rs"]
mod wheel_speeds;

use itpms_core::wheel_speed::RadiusState;
use itpms_core::{Cause, Corner};

#[test]
fn one_wheel_ends_at_its_pressure() {
    let (estimate, truth_kpa) = *one_wheel::drive().unwrap().last().unwrap();
    assert!(estimate.validity.is_valid());
    // One of 370 drives is further off.
    assert!((estimate.pressure_kpa - truth_kpa).abs() < 3.0 * estimate.pressure_sd_kpa, "{estimate:?}");
    one_wheel::main().unwrap();
}

#[test]
fn own_evidence_counts_where_the_road_shows_nothing() {
    let last = |with_readings| *own_evidence::drive(with_readings).unwrap().last().unwrap();
    let ((alone, _), (estimate, truth_kpa)) = (last(false), last(true));
    // A road that shows nothing leaves the estimator where it started, which it says.
    assert!(!alone.validity.is_valid() && estimate.validity.is_valid(), "{alone:?} {estimate:?}");
    assert!(estimate.pressure_sd_kpa < alone.pressure_sd_kpa / 3.0, "{alone:?} {estimate:?}");
    // One of 370 drives is further off.
    assert!((estimate.pressure_kpa - truth_kpa).abs() < 3.0 * estimate.pressure_sd_kpa, "{estimate:?}");
    own_evidence::main().unwrap();
}

#[test]
fn a_puncture_is_warned_of_at_its_wheel_alone() {
    let alerts = puncture::drive().unwrap();
    assert!(!alerts.is_empty());
    for alert in &alerts {
        assert_eq!(alert.wheels.iter().collect::<Vec<_>>(), [Corner::FrontLeft], "{alert}");
        assert!(alert.reported_s > puncture::BEGIN_S, "{alert}");
        assert!(matches!(alert.cause, Cause::UnderInflated(_) | Cause::FastLeak { .. }), "{alert}");
    }
    puncture::main().unwrap();
}

#[test]
fn a_wheel_on_a_smaller_radius_is_found() {
    let monitor = wheel_speeds::drive().unwrap();
    assert!(monitor.alert().is_some_and(|alert| alert.wheels == Corner::RearRight.into()));
    let report = monitor.radii();
    let RadiusState::Low(wheels) = report.state else { panic!("{report:?}") };
    assert_eq!(wheels.iter().collect::<Vec<_>>(), [Corner::RearRight], "{report:?}");
    let rear_right = report.wheels[Corner::RearRight.index()];
    assert!((rear_right.change + wheel_speeds::SMALLER).abs() < 3.0 * rear_right.change_sd, "{report:?}");
    wheel_speeds::main().unwrap();
}
