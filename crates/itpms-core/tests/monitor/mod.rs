//! The monitor through its public face: what it concludes from estimates made up for it.

mod reported;
mod reset;
mod tuning;

use itpms_core::conditioning::SampleClock;
use itpms_core::model::{CarSample, Corner, CornerSample, Level, Validity, Warning};
use itpms_core::monitor::{Monitor, MonitorConfig};
use itpms_core::warning::{Basis, Cause, Change, Doubt, MonitorReport, Regulation, WheelState};

use reported::{Drive, FINE, RATE_HZ, Reported, car, estimate, lost, low, state};

#[test]
fn a_low_tire_is_named_with_its_numbers_and_taken_back_when_it_is_over() {
    let mut drive = Drive::new();
    assert!(drive.on(30.0, &FINE).is_all_fine());
    // A quarter less with an sd of 3.3 %: so surely low that a second counts twice.
    let at_s = drive.until(5.0, &low(185.0), |report| report.alerts().next().is_some()).unwrap();
    assert!((30.9..31.21).contains(&at_s), "{at_s}");
    let report = *drive.monitor.report();
    let alert = *report.alerts().next().unwrap();
    assert!(alert.wheels.iter().eq([Corner::RearLeft]));
    let Cause::UnderInflated(reading) = alert.cause else { panic!("{alert}") };
    assert_eq!((reading.pressure_kpa, reading.sd_kpa, reading.reference_kpa), (185.0, 8.0, 241.3));
    assert!((reading.limit_kpa - 212.344).abs() < 1e-9);
    // Decided ten times a second.
    assert!((29.8..30.21).contains(&alert.since_s) && (alert.reported_s - at_s).abs() < 1e-9, "{alert:?}");
    assert_eq!(
        report.wheels.map(|wheel| wheel.unwrap().warning == Warning::Low),
        [false, false, true, false]
    );
    assert!(alert.to_string().starts_with(
        "rl under-inflated: 185 kPa (sd 8), limit 212 (88 % of 241), against the calibration; since "
    ));
    // In doubt it stays; pumped up it goes after ten seconds.
    drive.on(60.0, &low(205.0));
    assert_eq!(state(drive.monitor.report(), Corner::RearLeft), WheelState::Low);
    let before = *drive.monitor.report();
    let pumped_s = drive.time_s();
    let over_s = drive.until(15.0, &FINE, |report| report.alerts().next().is_none()).unwrap();
    assert!((9.9..10.21).contains(&(over_s - pumped_s)), "{over_s}");
    let changes: Vec<_> = drive.monitor.report().changes_since(&before).collect();
    assert!(matches!(changes[..], [Change::Ended(ended)] if ended.wheels == alert.wheels));
}

#[test]
fn what_is_short_uncertain_or_learned_standing_still_is_not_warned_of() {
    let mut drive = Drive::new();
    drive.on(10.0, &FINE);
    for _ in 0..20 {
        drive.on(0.8, &low(170.0));
        drive.on(3.0, &FINE);
    }
    assert!(drive.monitor.report().alerts().next().is_none());
    // 195 + 1.64 * 12 = 214.7 kPa are above the limit: not reported, but not fine either.
    let report = drive.on(120.0, &Reported { sd: 12.0, ..low(195.0) });
    assert!(report.alerts().next().is_none() && !report.is_all_fine());
    assert_eq!(state(report, Corner::RearLeft), WheelState::Unknown(Doubt::Uncertain));
    // Nothing is learned while the gate is shut.
    let report = drive.on(120.0, &Reported { gate: 0.0, speed_m_s: 0.0, ..low(150.0) });
    assert!(report.alerts().next().is_none());
}

#[test]
fn a_tire_surely_lower_than_the_others_is_low_however_little_is_known_of_their_level() {
    let unsure = |said: Reported, correlation| Reported { sd: 20.0, correlation, ..said };
    // 193 kPa are a fifth less than 241.3. The sd of a difference from the mean of three is 20 sqrt((1 - 0.95) 4/3) = 5.2 kPa.
    let mut drive = Drive::new();
    drive.on(10.0, &unsure(FINE, 0.95));
    drive.on(3.0, &unsure(low(193.0), 0.95));
    assert_eq!(state(drive.monitor.report(), Corner::RearLeft), WheelState::Low);
    assert_eq!(drive.monitor.report().alerts().count(), 1);
    // Errors of their own say nothing sure, and nor does a level that all have in common.
    for said in [unsure(low(193.0), 0.0), unsure(Reported { kpa: [193.0; 4], ..FINE }, 0.95)] {
        let mut drive = Drive::new();
        let report = drive.on(60.0, &said);
        assert!(report.alerts().next().is_none() && !report.is_all_fine());
    }
    // What all are wrong by alike hides none that is a fifth lower than they are; a tenth is no loss to be warned of.
    let beside = |rear_kpa: f64| unsure(Reported { kpa: [280.0, 280.0, rear_kpa, 280.0], ..FINE }, 0.95);
    assert!(Drive::new().on(10.0, &beside(220.0)).alerts().next().is_some());
    assert!(Drive::new().on(60.0, &beside(257.0)).alerts().next().is_none());
}

/// Axles of which little is known, each by itself: from the mean of the others the tire's difference has an sd of 20 kPa, from its
/// axle's other one of 30 sqrt(2 (1 - 0.97)) = 7.
#[test]
fn a_tire_surely_lower_than_its_axles_other_one_is_low() {
    let said = |axle_correlation| Reported { sd: 30.0, correlation: 0.5, axle_correlation, ..low(180.0) };
    assert!(Drive::new().on(60.0, &said(0.5)).alerts().next().is_none());
    assert!(Drive::new().on(10.0, &said(0.97)).alerts().next().is_some());
}

#[test]
fn no_information_is_never_all_good_and_is_reported_after_ten_minutes_of_driving() {
    let mut drive = Drive::new();
    assert!(!drive.monitor.report().is_all_fine());
    let nothing = Reported { validity: Validity::NoInformation, gate: 0.0, ..FINE };
    let report = drive.on(300.0, &nothing);
    assert_eq!(state(report, Corner::FrontLeft), WheelState::Unknown(Doubt::NoInformation));
    // Standing does not count.
    let report = drive.on(1000.0, &Reported { speed_m_s: 0.0, ..nothing });
    assert!(report.alerts().next().is_none());
    let before_s = drive.time_s();
    let reported_s = drive.until(400.0, &nothing, |report| report.alerts().count() == 4).unwrap();
    assert!((reported_s - before_s - 300.0).abs() < 1.0, "{reported_s}");
    let report = drive.monitor.report();
    assert!(report.alerts().all(|alert| matches!(alert.cause, Cause::NoInformation { .. })));
    assert!(report.wheels.iter().all(|wheel| wheel.unwrap().warning == Warning::Malfunction));
    let report = drive.on(2.0, &FINE);
    assert!(report.alerts().next().is_none() && report.is_all_fine());
    // Learned long ago is not known now.
    let report = drive.on(700.0, &Reported { gate: 0.0, speed_m_s: 0.0, ..FINE });
    assert_eq!(state(report, Corner::FrontLeft), WheelState::Unknown(Doubt::Standing));
    // Nor with the first frame afterwards: two seconds of learning make it so.
    let report = drive.on(1.5, &FINE);
    assert_eq!(state(report, Corner::FrontLeft), WheelState::Unknown(Doubt::NoInformation));
    assert!(drive.on(1.0, &FINE).is_all_fine());
}

/// A tire of a car that stands may go flat: half a minute after it stopped nothing is fine any more, nor may a pressure be shown.
#[test]
fn what_was_fine_when_the_car_stopped_is_soon_unknown() {
    let mut drive = Drive::new();
    assert!(drive.on(60.0, &FINE).is_all_fine());
    let standing = Reported { gate: 0.0, speed_m_s: 0.0, ..FINE };
    assert!(drive.on(29.0, &standing).is_all_fine());
    let report = drive.on(2.0, &standing);
    for corner in Corner::ALL {
        assert_eq!(state(report, corner), WheelState::Unknown(Doubt::Standing));
        assert!(!report.wheels[corner.index()].unwrap().validity.is_valid());
    }
    drive.on(1.0, &FINE);
    assert!(drive.on(1.5, &FINE).is_all_fine(), "driven on");
}

/// All tires read 16 % less than a calibration of another day expects, with 6 % of sd in common: that may be the car, and no tire is low. It is
/// reported as what it is, and no tire is fine meanwhile.
#[test]
fn a_shift_of_all_since_another_day_is_no_loss() {
    let stored = |kpa: f64| Reported {
        kpa: [kpa; 4],
        sd: 15.0,
        correlation: 0.9,
        level: Level::StoredCalibration,
        ..FINE
    };
    let mut drive = Drive::new();
    let report = drive.on(200.0, &stored(0.84 * 241.3));
    let causes: Vec<_> = report.alerts().map(|alert| alert.cause.label()).collect();
    assert_eq!(causes, ["common-shift"]);
    assert!(Corner::ALL.iter().all(|corner| state(report, *corner) == WheelState::Unknown(Doubt::Uncertain)));
    // An axle by itself: new tires in front, or both front tires low; the rear ones are fine.
    let mut drive = Drive::new();
    let front = Reported { kpa: [0.8 * 241.3, 0.8 * 241.3, 241.3, 241.3], sd: 10.0, ..stored(241.3) };
    let report = drive.on(200.0, &front);
    let shifted: Vec<_> =
        report.alerts().map(|alert| (alert.cause.label(), alert.wheels.to_string())).collect();
    assert_eq!(shifted, [("common-shift", "fl fr".to_owned())]);
    assert_eq!(state(report, Corner::FrontLeft), WheelState::Unknown(Doubt::Uncertain));
    assert_eq!(state(report, Corner::RearLeft), WheelState::Fine);
    // One tire of it is that tire.
    let mut drive = Drive::new();
    let single = Reported { kpa: [0.7 * 241.3, 241.3, 241.3, 241.3], sd: 10.0, ..stored(241.3) };
    let report = drive.on(200.0, &single);
    assert_eq!(state(report, Corner::FrontLeft), WheelState::Low);
    assert!(
        report.alerts().all(|alert| alert.cause.label() != "common-shift"),
        "the other tire of its axle is as it was"
    );
    // By 3 % is nothing.
    let mut drive = Drive::new();
    assert!(drive.on(200.0, &stored(0.97 * 241.3)).alerts().next().is_none());
}

/// Where the rear is now within the limits and now not, it is one report, which names all wheels from then on.
#[test]
fn a_shift_at_a_limit_is_reported_once() {
    let axles = |front: f64, rear: f64| Reported {
        kpa: [front * 241.3, front * 241.3, rear * 241.3, rear * 241.3],
        sd: 10.0,
        correlation: 0.9,
        level: Level::StoredCalibration,
        ..FINE
    };
    let mut drive = Drive::new();
    let mut before = *drive.on(100.0, &axles(0.8, 0.97));
    let mut begun = Vec::new();
    for i in 0..60 {
        let report = *drive.on(1.0, &axles(0.8, if i % 2 == 0 { 0.85 } else { 0.97 }));
        begun.extend(report.changes_since(&before).filter_map(|change| match change {
            Change::Begun(alert) => Some(alert.wheels.to_string()),
            Change::Ended(_) => None,
        }));
        before = report;
    }
    assert_eq!(begun, ["fl fr rl rr"]);
    let ended = *drive.on(30.0, &axles(1.0, 1.0));
    assert!(ended.alerts().next().is_none());
}

/// A tire that had 302 kPa since other tires were mounted, and lost a fifth: low by what it has lost, though its level is above every limit.
#[test]
fn a_loss_is_seen_whatever_the_level() {
    let mut drive = Drive::new();
    // A tenth is not warned of, a fifth is.
    let before = Reported { kpa: [300.0; 4], loss: [Some(lost(2.0, 5.0)); 4], ..FINE };
    assert!(drive.on(20.0, &before).alerts().all(|alert| !alert.cause.is_low()));
    for (lost_kpa, low) in [(24.0, false), (46.0, true)] {
        let mut drive = drive.clone();
        let mut now = before;
        (now.loss[0], now.kpa[0]) = (Some(lost(lost_kpa, 5.0)), 302.0 - lost_kpa);
        let report = drive.on(5.0, &now);
        let of_the_tire = report.alerts_of(Corner::FrontLeft).any(|alert| alert.cause.is_low());
        assert_eq!(of_the_tire, low, "{lost_kpa}");
        assert!(report.alerts_of(Corner::RearLeft).all(|alert| !alert.cause.is_low()));
    }
}

#[test]
fn a_broken_clock_does_not_stop_the_monitor() {
    for broken_s in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut drive = Drive::new();
        drive.on(5.0, &FINE);
        let corner = CornerSample { body_accel_m_s2: 0.1, wheel_accel_m_s2: 0.2 };
        let sample =
            CarSample { time_s: broken_s, speed_m_s: 20.0, corners: [Some(corner); 4], wheel_speeds: None };
        drive.monitor.begin_calibration(10.0).unwrap();
        let at = drive.clock.take(broken_s, 20.0);
        drive.monitor.screen(&at, &sample);
        drive.monitor.judge(&at, &mut estimate(broken_s, &low(190.0)));
        assert!(drive.monitor.report().alerts().next().is_none());
        let reported_s = drive.until(20.0, &low(190.0), |report| report.alerts().next().is_some());
        // The calibration ends at 15 s, and nothing is held against it before.
        assert!(
            reported_s.is_some_and(|reported_s| (15.0..17.5).contains(&reported_s)),
            "{broken_s}: {reported_s:?}"
        );
    }
}

#[test]
fn without_a_speed_a_parked_car_is_not_stuck_and_one_sensor_of_a_driven_one_is() {
    let stuck = |changing: usize| {
        let mut monitor = Monitor::new(&MonitorConfig::new(&car()), RATE_HZ).unwrap();
        let mut clock = SampleClock::new(RATE_HZ).unwrap();
        for step in 0..200 {
            let wiggle = 0.1 * f64::from(step % 7);
            let value = |sensor: usize| if sensor < changing { wiggle } else { 0.3 };
            let corner = |i| CornerSample { body_accel_m_s2: value(i), wheel_accel_m_s2: value(4 + i) };
            let corners = [0, 1, 2, 3].map(|i| Some(corner(i)));
            let time_s = f64::from(step) / RATE_HZ;
            let at = clock.take(time_s, f64::NAN);
            monitor.screen(&at, &CarSample { time_s, speed_m_s: f64::NAN, corners, wheel_speeds: None });
            monitor.judge(&at, &mut estimate(time_s, &FINE));
        }
        let report = monitor.report();
        report.alerts().filter(|alert| alert.to_string().contains("stuck")).count()
    };
    // Of eight sensors: none changes, some do, all but one do.
    assert_eq!([stuck(0), stuck(4), stuck(7)], [0, 0, 1]);
}

#[test]
fn all_four_are_more_certain_together_than_each_alone() {
    // With an sd of 6 % each alone says nothing; their mean's is half of that.
    let all = |share: f64| Reported { kpa: [share * 241.3; 4], sd: 15.0, ..FINE };
    let mut drive = Drive::new();
    assert!(drive.on(200.0, &all(0.85)).alerts().next().is_none());
    let from_s = drive.time_s();
    let is_all = |report: &MonitorReport<f64>| {
        report.alerts().any(|alert| matches!(alert.cause, Cause::AllLow { .. }))
    };
    let reported_s = drive.until(200.0, &all(0.76), is_all).unwrap();
    assert!((0.9..2.3).contains(&(reported_s - from_s)), "{reported_s}");
    let alert =
        drive.monitor.report().alerts().find(|alert| matches!(alert.cause, Cause::AllLow { .. })).unwrap();
    assert_eq!(alert.wheels.iter().count(), 4, "{alert}");
    // None of them is reported any more: it stands while the others are low, and is over when they are not.
    let silent = Some(Corner::FrontRight);
    let stands = |report: &MonitorReport<f64>| {
        report.alerts().any(|alert| matches!(alert.cause, Cause::AllLow { .. }))
    };
    assert!(stands(drive.on(60.0, &Reported { silent, ..all(0.76) })));
    let from_s = drive.time_s();
    let over_s = drive.until(60.0, &Reported { silent, ..FINE }, |report| !stands(report)).unwrap();
    assert!((19.9..20.3).contains(&(over_s - from_s)), "{over_s}");
    // One that is not low is not all of them.
    let mut drive = Drive::new();
    let report = drive.on(200.0, &Reported { kpa: [190.0, 190.0, 190.0, 235.0], sd: 15.0, ..FINE });
    assert!(report.alerts().all(|alert| !matches!(alert.cause, Cause::AllLow { .. })));
}

/// Both tires of a side are as probable as their errors allow, and are reported without a wait.
#[test]
fn a_side_that_falls_alike_is_named() {
    let side = Reported { kpa: [185.0, 241.3, 185.0, 241.3], sd: 8.0, ..FINE };
    let mut drive = Drive::new();
    assert!(drive.on(30.0, &FINE).is_all_fine());
    let reported_s = drive.until(200.0, &side, |report| report.alerts().count() == 2).unwrap();
    assert!((30.9..31.3).contains(&reported_s), "{reported_s}");
    for corner in Corner::ALL {
        let is_left = matches!(corner, Corner::FrontLeft | Corner::RearLeft);
        assert_eq!(state(drive.monitor.report(), corner) == WheelState::Low, is_left, "{corner:?}");
    }
}

#[test]
fn a_tire_that_looks_low_while_the_other_of_its_side_is_silent_is_waited_for() {
    // Its own spectrum is all that tells of it: 150 s.
    let low = Reported { silent: Some(Corner::FrontLeft), ..low(150.0) };
    let begin = || {
        let mut drive = Drive::new();
        drive.on(30.0, &FINE);
        drive
    };
    let is_low =
        |report: &MonitorReport<f64>| report.alerts().any(|a| matches!(a.cause, Cause::UnderInflated(_)));
    let reported_s = begin().until(200.0, &low, is_low).unwrap();
    assert!((179.8..180.3).contains(&reported_s), "{reported_s}");
    // A sure loss in this drive remains a loss.
    let leaks =
        |report: &MonitorReport<f64>| report.alerts().any(|a| matches!(a.cause, Cause::FastLeak { .. }));
    let mut drive = Drive::new();
    drive.on(30.0, &Reported { loss: [Some(lost(0.0, 5.0)); 4], ..FINE });
    let fallen = Reported { loss: [0.0, 0.0, 91.3, 0.0].map(|kpa| Some(lost(kpa, 5.0))), ..low };
    assert!(drive.until(200.0, &fallen, leaks).unwrap() < 40.3);
    // A wheel of the other side tells nothing of it.
    let across = Reported { silent: Some(Corner::FrontRight), ..low };
    assert!(begin().until(200.0, &across, is_low).unwrap() < 32.3);
}

#[test]
fn a_tire_that_looks_low_while_the_tracks_part_is_waited_for() {
    let low = |incoherence| Reported { incoherence, ..low(150.0) };
    let begin = |incoherence| {
        let mut drive = Drive::new();
        drive.on(60.0, &Reported { incoherence, ..FINE });
        drive
    };
    let is_low =
        |report: &MonitorReport<f64>| report.alerts().any(|a| matches!(a.cause, Cause::UnderInflated(_)));
    // On a road that stays shared two seconds are enough; so they are where it was never shared so well.
    assert!(is_low(begin(0.004).on(2.5, &low(0.01))));
    assert!(is_low(begin(0.3).on(2.5, &low(1.0))));
    // Where the tracks part the same seconds may be the road's, for some five seconds and not for ever.
    let mut parted = begin(0.004);
    assert!(!is_low(parted.on(4.0, &low(1.0))));
    assert!(is_low(parted.on(4.0, &low(1.0))));
}

#[test]
fn limits_are_those_of_the_rule_and_overfull_is_reported() {
    let us = MonitorConfig { limits: Regulation::Fmvss138.into(), ..MonitorConfig::new(&car()) };
    // 0.86 of the placard's pressure: low for the one rule, not for the other.
    let said = Reported { sd: 2.0, ..low(0.86 * 241.3) };
    assert!(Drive::with(us).on(60.0, &said).alerts().next().is_none());
    assert!(Drive::new().on(60.0, &said).alerts().next().is_some());
    let report = *Drive::new().on(90.0, &Reported { sd: 3.0, ..low(315.0) });
    assert_eq!(state(&report, Corner::RearLeft), WheelState::Over);
    assert!(matches!(report.alerts().next().unwrap().cause, Cause::OverInflated(_)));
    // A warm reference instead of the placard's.
    let reference_kpa = [None, None, Some(270.0), None];
    let warm = MonitorConfig { reference_kpa, ..MonitorConfig::new(&car()) };
    assert!(Drive::with(warm).on(30.0, &Reported { sd: 3.0, ..low(225.0) }).alerts().next().is_some());
}

#[test]
fn a_tire_as_hard_as_a_rim_is_flat() {
    let hard = |kpa: f64| Reported { sd: 15.0, ..low(kpa) };
    let flat = |report: &MonitorReport<f64>| report.alerts().any(|a| matches!(a.cause, Cause::Flat(_)));
    let mut drive = Drive::new();
    assert!(!flat(drive.on(1.5, &hard(400.0))));
    let report = *drive.on(4.0, &hard(400.0));
    assert!(flat(&report));
    assert_eq!(state(&report, Corner::RearLeft), WheelState::Low);
    // It is one thing that is reported of it, and a rim has no pressure.
    let report = *drive.on(80.0, &hard(400.0));
    assert_eq!(report.alerts().count(), 1);
    assert_eq!(report.wheels[Corner::RearLeft.index()].unwrap().validity, Validity::Misfit);
    // Overfull on both sides, or less than a rim: inflated.
    let both = Reported { sd: 15.0, kpa: [241.3, 241.3, 400.0, 400.0], ..FINE };
    assert!(!flat(Drive::new().on(90.0, &both)));
    assert!(!flat(Drive::new().on(90.0, &hard(315.0))));
    // A soft tire makes the other of its axle no rim.
    assert!(!flat(Drive::new().on(90.0, &hard(120.0))));
}

#[test]
fn a_tire_that_seems_to_leak_beside_a_rim_is_waited_for() {
    let leaks =
        |report: &MonitorReport<f64>| report.alerts().any(|a| matches!(a.cause, Cause::FastLeak { .. }));
    let begin = || {
        let mut drive = Drive::new();
        drive.on(60.0, &Reported { sd: 2.0, loss: [Some(lost(0.0, 2.0)); 4], ..FINE });
        drive
    };
    // A tenth less at the rear left, not low, the front right whole or on its rim.
    let fallen = |right: f64| Reported {
        sd: 2.0,
        kpa: [241.3, right, 217.0, 241.3],
        loss: [0.0, 241.3 - right, 24.3, 0.0].map(|kpa| Some(lost(kpa, 2.0))),
        ..FINE
    };
    assert!(leaks(begin().on(30.0, &fallen(241.3))));
    assert!(!leaks(begin().on(30.0, &fallen(420.0))));
}

#[test]
fn two_of_a_side_that_read_as_rims_are_a_level_that_is_off() {
    let side = Reported { sd: 15.0, kpa: [400.0, 241.3, 420.0, 241.3], ..FINE };
    let report = *Drive::new().on(50.0, &side);
    assert!(report.alerts().next().is_none());
    for corner in [Corner::FrontLeft, Corner::RearLeft] {
        assert_eq!(report.wheels[corner.index()].unwrap().validity, Validity::Misfit);
        assert_eq!(state(&report, corner), WheelState::Unknown(Doubt::Misfit));
    }
    // Coming back from there is no leak.
    let mut drive = Drive::new();
    drive.on(50.0, &side);
    assert!(drive.on(60.0, &Reported { sd: 3.0, ..FINE }).alerts().next().is_none());
}

/// Errors of 30 kPa that go together, so that a difference of two is known to 10: both tires of a side are surely lower than the others.
#[test]
fn a_side_that_is_surely_lower_than_the_other_one_is_named() {
    let said = |front_kpa: f64| Reported {
        sd: 30.0,
        correlation: 0.94,
        kpa: [front_kpa, 275.0, 198.0, 280.0],
        ..FINE
    };
    let report = *Drive::new().on(30.0, &said(210.0));
    assert_eq!([0, 2].map(|i| report.wheels[i].unwrap().state), [WheelState::Low; 2]);
    let report = *Drive::new().on(30.0, &said(270.0));
    assert!(
        state(&report, Corner::RearLeft) == WheelState::Low
            && state(&report, Corner::FrontLeft) != WheelState::Low
    );
}

/// A car that is known to 17 kPa: 182 is surely past the limit of 212, and what one healthy tire of three thousand reads.
#[test]
fn what_a_healthy_tire_may_read_is_not_said() {
    let said = |rear_kpa: f64, sd: f64, level: Level| Reported { sd, level, ..low(rear_kpa) };
    assert!(Drive::new().on(600.0, &said(182.0, 17.0, Level::VehicleFile)).alerts().next().is_none());
    assert!(Drive::new().on(10.0, &said(155.0, 17.0, Level::VehicleFile)).alerts().next().is_some());
    assert!(Drive::new().on(10.0, &said(182.0, 12.0, Level::VehicleFile)).alerts().next().is_some());
    assert!(Drive::new().on(10.0, &said(182.0, 12.0, Level::Calibration)).alerts().next().is_some());
    // Where the others say it, they are the reason, and not a level that may be that of a healthy tire.
    let alike = Reported { correlation: 0.94, ..said(182.0, 17.0, Level::VehicleFile) };
    let report = *Drive::new().on(10.0, &alike);
    let alert = report.alerts().next().unwrap();
    assert!(matches!(alert.cause, Cause::UnderInflated(reading) if reading.basis == Basis::OtherTires));
}

#[cfg(feature = "serde")]
#[test]
fn a_saved_monitor_goes_on_as_if_nothing_had_been() {
    let mut drive = Drive::new();
    drive.on(20.0, &low(205.0));
    drive.on(0.6, &low(185.0));
    let bytes = postcard::to_allocvec(&drive.monitor).unwrap();
    let monitor = postcard::from_bytes(&bytes).unwrap();
    let mut again = Drive { monitor, clock: drive.clock, step: drive.step };
    again.on(5.0, &low(185.0));
    drive.on(5.0, &low(185.0));
    // By their bytes: what is not known yet is NaN, and that is not equal to itself.
    let saved = |drive: &Drive| postcard::to_allocvec(&drive.monitor).unwrap();
    assert_eq!(saved(&again), saved(&drive));
    assert_eq!(again.monitor.report().alerts().count(), 1);
}
