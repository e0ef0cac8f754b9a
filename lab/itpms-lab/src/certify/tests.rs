//! Tests of whole runs, shortened: the regulations' own times are driven by `itpms lab certify`.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

use itpms_core::model::Corner;
use itpms_sim::fault::{FaultPlace, FaultSpec};

use super::course::Course;
use super::drive::drive;
use super::*;
use crate::runner::{StudyError, UNWATCHED};

fn unplugged() -> Procedure {
    Procedure {
        rule: Rule::UnR141,
        test: Test::Malfunction(Failure::Unplugged(Corner::RearLeft, FaultPlace::Wheel)),
    }
}

fn request(only: &str) -> Request {
    Request {
        extent: Extent::Full,
        only: Some(only.to_owned()),
        seed: 1,
        sensors: Sensors::Accelerations,
        loads: StatedLoads::Unknown,
        repeats: 1,
    }
}

/// Little learning and a minute of detection; what is reported of a dead sensor needs neither.
fn short(procedure: &Procedure) -> Course {
    Course::with_times(procedure, 20.0, 60.0).unwrap()
}

fn driven(procedure: &Procedure, course: &Course) -> Outcome {
    let odometer = Odometer::new(course.longest_s() as u64, UNWATCHED);
    let car = (Sensors::Accelerations, StatedLoads::Unknown);
    let outcome = drive(procedure, course, 7, car, &odometer).unwrap();
    let done_s = odometer.done.load(Ordering::Relaxed);
    // All of the way is reported, up to a report's length.
    assert!((done_s as f64 - course.longest_s()).abs() <= 10.0, "{done_s}");
    outcome
}

/// A second sensor for ten seconds, of which the test knows nothing.
fn also_unplugged(from_s: f64) -> FaultSpec {
    let for_good = Failure::Unplugged(Corner::FrontRight, FaultPlace::Wheel).spec(from_s);
    FaultSpec { to_s: Some(from_s + 10.0), ..for_good }
}

#[test]
fn what_is_reported_of_another_wheel_beside_the_lamp_or_after_it_fails_a_test() {
    let procedure = unplugged();
    let seen = |course: &Course| {
        let outcome = driven(&procedure, course);
        let reported = outcome
            .false_alerts
            .iter()
            .map(|reported| (reported.phase, reported.cause, reported.wheels.clone()));
        (outcome.verdict, reported.collect::<Vec<_>>())
    };
    assert_eq!(seen(&short(&procedure)), (Verdict::Pass, vec![]));

    let mut course = short(&procedure);
    course.scenario.fault.push(also_unplugged(course.wrong_at_s + 30.0));
    let reported = (Phase::Detection, "malfunction", "fr".to_owned());
    assert_eq!(seen(&course), (Verdict::WrongWheel, vec![reported]));

    // The tell-tale is out within seconds; half a minute later it comes on for another wheel.
    let mut course = short(&procedure);
    course.recovery.fault.push(also_unplugged(30.0));
    let reported = (Phase::Recovery, "malfunction", "fr".to_owned());
    assert_eq!(seen(&course), (Verdict::WrongWheel, vec![reported]));
}

#[test]
fn an_unplugged_sensor_is_reported_and_the_run_repeats_to_the_bit() {
    let procedure = unplugged();
    let course = short(&procedure);
    let outcome = driven(&procedure, &course);
    assert!(outcome.warned_after_s.is_some_and(|after_s| after_s < 60.0), "{outcome:?}");
    assert!(outcome.named.contains("rl") && outcome.false_alarm_s.is_none(), "{outcome:?}");
    assert_eq!(outcome.relit, Some(true));
    let again = driven(&procedure, &course);
    assert_eq!(outcome.csv(), again.csv());
    assert_eq!(outcome.figure().svg(), again.figure().svg());
}

#[test]
fn a_stop_ends_it_and_a_name_that_is_none_is_reported() {
    let stop = |_: u64, _: u64| ControlFlow::Break(());
    assert!(matches!(certify(&request("unplugged-rl-wheel"), &stop), Err(StudyError::Stopped)));
    let error = certify(&request("brakes"), &stop).unwrap_err().to_string();
    assert!(
        error.starts_with("no test's name contains \"brakes\", expected a part of one of: un-r141-"),
        "{error}"
    );
}

#[test]
fn tables_have_a_line_per_test() {
    let all = procedures(&Request { only: None, ..request("") }).unwrap();
    let text = list(&all);
    assert_eq!(text.lines().count(), all.len());
    assert!(text.contains("un-r141-diffusion") && text.contains("within 60:00"));
    assert_eq!(procedures(&request("fmvss-138-low")).unwrap().len(), 15);
}

#[test]
fn on_wheel_speeds_one_tire_is_found_and_runs_of_a_kind_are_put_together() {
    let on_wheel_speeds = |only: &str| Request {
        sensors: Sensors::WheelSpeeds,
        loads: StatedLoads::Constant,
        repeats: 2,
        ..request(only)
    };
    let three = certify(&on_wheel_speeds("fmvss-138-low-fl-fr-rl"), UNWATCHED).unwrap();
    assert_eq!((three.outcomes.len(), three.patterns.len()), (2, 1));
    assert_eq!((three.patterns[0].tires, three.patterns[0].wrong), ("three", 0));
    let with_rear_right = certify(&on_wheel_speeds("fmvss-138-low-rr"), UNWATCHED).unwrap();
    let [rear] = with_rear_right.patterns.as_slice() else { panic!("{}", with_rear_right.table()) };
    assert_eq!((rear.tires, rear.runs, rear.in_time, rear.wrong), ("rear wheel", 2, 2, 0), "{rear:?}");
    assert!(with_rear_right.table().contains("rear wheel"));
    assert!(rear.worst_s >= rear.median_s && rear.worst_s <= Some(1200.0));
    // It has no accelerometer to unplug.
    let refused = procedures(&on_wheel_speeds("unplugged")).unwrap_err().to_string();
    assert!(refused.starts_with("no test's name contains \"unplugged\""), "{refused}");
}

#[test]
fn by_tooth_pulses_all_four_are_found_and_nothing_else_is_reported() {
    let request = Request { sensors: Sensors::Pulses, ..request("fmvss-138-low-all") };
    let certificate = certify(&request, UNWATCHED).unwrap();
    let [all] = certificate.outcomes.as_slice() else { panic!("{}", certificate.table()) };
    assert_eq!((all.named.as_str(), all.false_alerts.len()), ("fl fr rl rr", 0), "{}", certificate.table());
    assert!(all.warned_after_s.is_some_and(|s| s <= 1200.0) && all.false_alarm_s.is_none());
}
