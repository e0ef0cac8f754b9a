use itpms_core::model::Corner;
use proptest::prelude::*;

use super::*;
use crate::log::Field;

const BODY: Slot = Slot::Corner(Corner::FrontLeft, Field::BodyAccel);
const WHEEL: Slot = Slot::Corner(Corner::FrontLeft, Field::WheelAccel);
const OTHER_BODY: Slot = Slot::Corner(Corner::RearRight, Field::BodyAccel);
const OTHER_WHEEL: Slot = Slot::Corner(Corner::RearRight, Field::WheelAccel);
const TRUTH: Slot = Slot::Corner(Corner::FrontLeft, Field::Pressure);
const ALL: [Slot; 6] = [Slot::Speed, BODY, WHEEL, TRUTH, OTHER_BODY, OTHER_WHEEL];

/// Rows of all readings, put into the order of their times first, as a bus has them.
fn rows(slots: &[Slot], mut readings: Vec<Reading>) -> (Vec<[f64; SLOTS]>, AlignmentReport) {
    readings.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    in_order(slots, readings)
}

fn in_order(slots: &[Slot], readings: Vec<Reading>) -> (Vec<[f64; SLOTS]>, AlignmentReport) {
    let mut aligner = Aligner::new(slots);
    let mut out = Vec::new();
    for reading in readings {
        aligner.push(reading);
        out.extend(std::iter::from_fn(|| aligner.pop_values()));
    }
    aligner.finish();
    out.extend(std::iter::from_fn(|| aligner.pop_values()));
    let report = aligner.report().unwrap();
    (out, report)
}

/// A signal of `rate_hz` for `length_s`, `late_s` behind.
fn signal(
    slot: Slot,
    rate_hz: f64,
    length_s: f64,
    late_s: f64,
    value: impl Fn(f64) -> f64,
) -> impl Iterator<Item = Reading> {
    (0..(rate_hz * length_s) as u32).map(move |i| {
        let time_s = f64::from(i) / rate_hz;
        Reading { time_s: time_s + late_s, slot, value: value(time_s) }
    })
}

/// Different for every signal and time.
fn mark(slot: Slot) -> impl Fn(f64) -> f64 {
    move |time_s| time_s + 1000.0 * slot.index() as f64
}

fn at(row: &[f64; SLOTS], slot: Slot) -> f64 {
    row[slot.index()]
}

#[test]
fn equal_times_pass_unchanged() {
    let readings = ALL.iter().flat_map(|slot| signal(*slot, 500.0, 5.0, 0.0, mark(*slot))).collect();
    let (rows, report) = rows(&ALL, readings);
    assert_eq!(rows.len(), 2500);
    for (i, row) in rows.iter().enumerate() {
        let time_s = i as f64 / 500.0;
        assert_eq!(at(row, Slot::Time), time_s);
        for slot in ALL {
            assert_eq!(at(row, slot), mark(slot)(time_s), "{slot:?} {time_s}");
        }
    }
    assert_eq!(report.remarks(), Vec::<String>::new());
}

#[test]
fn messages_of_one_cycle_are_one_row_whatever_their_order() {
    // The clock is the front left body; the others come before and after it, one by more than half a period.
    let late = [(BODY, 0.0), (WHEEL, 0.0), (OTHER_BODY, 0.0006), (OTHER_WHEEL, -0.0004)];
    let readings =
        late.iter().flat_map(|(slot, late_s)| signal(*slot, 500.0, 4.0, 0.1 + late_s, mark(*slot)));
    let (rows, report) = rows(&ALL, readings.collect());
    assert_eq!(rows.len(), 2000);
    for (i, row) in rows.iter().enumerate() {
        let time_s = i as f64 / 500.0;
        assert!((at(row, Slot::Time) - time_s - 0.1).abs() < 1e-12);
        for (slot, _) in late {
            assert_eq!(at(row, slot), mark(slot)(time_s), "{slot:?} {time_s}");
        }
        assert!(at(row, Slot::Speed).is_nan());
    }
    let offset = |slot| report.signals.iter().find(|signal| signal.slot == slot).map(|signal| signal.method);
    let Some(SlotMethod::AsItIs { offset_s }) = offset(OTHER_BODY) else { panic!("{report:?}") };
    assert!((offset_s - 0.0006).abs() < 1e-9);
    let remarked = |what| report.remarks().iter().any(|remark| remark.contains(what));
    assert!(remarked("0.60 ms after") && remarked("0.40 ms before"), "{:?}", report.remarks());
}

#[test]
fn a_faster_sensor_loses_what_would_fold_and_nothing_else() {
    use std::f64::consts::TAU;
    // 40 Hz is seen; 460 Hz sampled at 500 Hz would look like 40 Hz.
    let wheel = |time_s: f64| 3.0 * (TAU * 40.0 * time_s).sin() + 5.0 * (TAU * 460.0 * time_s).cos();
    let readings = signal(BODY, 500.0, 4.0, 0.0, mark(BODY)).chain(signal(WHEEL, 2000.0, 4.0, 0.0003, wheel));
    let (rows, report) = rows(&[BODY, WHEEL], readings.collect());
    assert!((1975..2000).contains(&rows.len()), "{}", rows.len());
    for row in &rows {
        let time_s = at(row, Slot::Time);
        // The wheel's stamps are 0.3 ms late and are believed.
        let expected = 3.0 * (TAU * 40.0 * (time_s - 0.0003)).sin();
        assert!((at(row, WHEEL) - expected).abs() < 0.015, "{time_s} {} {expected}", at(row, WHEEL));
        assert_eq!(at(row, BODY), mark(BODY)(time_s));
    }
    assert!(report.remarks()[0].contains("2000 Hz, was brought to the rows' 500 Hz by a low-pass"));
}

#[test]
fn a_slow_speed_lies_on_its_line_and_not_across_a_hole() {
    let speed = |time_s: f64| 20.0 + 1.5 * time_s;
    let there = |reading: &Reading| !(2.0..3.0).contains(&reading.time_s);
    let readings = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 6.0, 0.0, mark(slot)));
    let (rows, _) =
        rows(&ALL, readings.chain(signal(Slot::Speed, 20.0, 6.0, 0.01, speed).filter(there)).collect());
    assert_eq!(rows.len(), 3000);
    for row in &rows {
        let (time_s, found) = (at(row, Slot::Time), at(row, Slot::Speed));
        if (0.011..1.95).contains(&time_s) || (3.02..5.95).contains(&time_s) {
            assert!((found - speed(time_s - 0.01)).abs() < 1e-9, "{time_s} {found}");
        } else if (2.13..3.0).contains(&time_s) {
            assert!(found.is_nan(), "{time_s} {found}");
        }
    }
}

#[test]
fn a_lost_message_is_missing_and_a_dead_clock_stops_nobody() {
    let lost = |reading: &Reading| (reading.time_s - 2.5002).abs() < 1e-4 && reading.slot == OTHER_BODY;
    let dead = |reading: &Reading| reading.time_s > 3.001 && reading.slot == BODY;
    let pairs = [(BODY, 0.0), (WHEEL, 0.0), (OTHER_BODY, 0.0002), (OTHER_WHEEL, 0.0002)];
    let readings = pairs.into_iter().flat_map(|(slot, late_s)| signal(slot, 500.0, 5.0, late_s, mark(slot)));
    let kept = readings.filter(|reading| !dead(reading) && !lost(reading));
    let (rows, _) = rows(&ALL, kept.collect());
    assert_eq!(rows.len(), 2500);
    for (i, row) in rows.iter().enumerate() {
        let time_s = i as f64 / 500.0;
        assert!((at(row, Slot::Time) - time_s).abs() < 1e-5, "{i}");
        assert_eq!(at(row, BODY).is_nan(), i > 1500, "{i}");
        assert_eq!(at(row, OTHER_BODY).is_nan(), i == 1250, "{i}");
        assert_eq!(at(row, OTHER_WHEEL), mark(OTHER_WHEEL)(time_s), "{i}");
    }
}

#[test]
fn jitter_below_half_a_period_loses_nothing() {
    // A fixed pattern of -30 to +30 % of a period, another for each message.
    let jitter = |i: usize, salt: usize| 0.0006 * (((i * 7919 + salt * 104_729) % 1000) as f64 / 500.0 - 1.0);
    let mut readings = Vec::new();
    for (salt, slots) in [[BODY, WHEEL], [OTHER_BODY, OTHER_WHEEL]].into_iter().enumerate() {
        for i in 0..2500 {
            for slot in slots {
                let time_s = 1.0 + i as f64 * 0.002 + if i == 0 { 0.0 } else { 0.5 * jitter(i, salt) };
                readings.push(Reading { time_s, slot, value: i as f64 });
            }
        }
    }
    let (rows, report) = rows(&ALL, readings);
    assert_eq!(rows.len(), 2500);
    for (i, row) in rows.iter().enumerate() {
        assert_eq!((at(row, BODY), at(row, OTHER_WHEEL)), (i as f64, i as f64));
    }
    assert!(report.signals.iter().all(|signal| signal.left_over == 0));
}

#[test]
fn drifting_clocks_slip_once_per_period_of_drift() {
    // 100 ppm for 100 s: 10 ms, five periods.
    let ours = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 100.0, 0.0, mark(slot)));
    let theirs =
        [OTHER_BODY, OTHER_WHEEL].into_iter().flat_map(|slot| signal(slot, 500.05, 99.99, 0.0, mark(slot)));
    let (rows, report) = rows(&ALL, ours.chain(theirs).collect());
    let there = rows.iter().filter(|row| at(row, OTHER_BODY).is_finite()).count();
    assert!((49_980..=50_000).contains(&there), "{there}");
    let left_over: u64 = report.signals.iter().map(|signal| signal.left_over).sum();
    assert!((6..=14).contains(&left_over), "{left_over}");
    for row in rows.iter().filter(|row| at(row, OTHER_BODY).is_finite()) {
        let measured_s = at(row, OTHER_BODY) - 1000.0 * OTHER_BODY.index() as f64;
        // Three quarters of a period, and what the offset lags: 256 readings of 0.2 us drift.
        let apart = (measured_s - at(row, Slot::Time)).abs() / 0.002;
        assert!(apart < 0.75 + 0.03, "{measured_s} {apart}");
    }
}

#[test]
fn a_clock_that_is_set_back_is_believed_after_a_while() {
    let first = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 4.0, 1000.0, mark(slot)));
    let then = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 4.0, 10.0, mark(slot)));
    let by_time = |mut readings: Vec<Reading>| {
        readings.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        readings
    };
    let (first, then) = (by_time(first.collect()), by_time(then.collect()));
    let (rows, report) = in_order(&ALL, [first, then].concat());
    assert_eq!(report.restarts, 1);
    assert!((3980..=4000).contains(&rows.len()), "{}", rows.len());
    assert!(rows.last().is_some_and(|row| (at(row, Slot::Time) - 13.998).abs() < 1e-9));
}

#[test]
fn a_silence_lets_go_what_waits_and_nothing_else() {
    // Speed comes no more: every row waits for it, 2.5 periods of 20 ms.
    let mut aligner = Aligner::new(&[Slot::Speed, BODY, WHEEL]);
    let both = |i: u32, slot| Reading { time_s: f64::from(i) / 500.0, slot, value: f64::from(i) };
    let mut count = 0;
    for i in 0..2000 {
        if i % 10 == 0 && i < 1500 {
            aligner.push(both(i, Slot::Speed));
        }
        aligner.push(both(i, BODY));
        aligner.push(both(i, WHEEL));
        count += std::iter::from_fn(|| aligner.pop()).count();
    }
    assert_eq!(count, 2000 - 25);
    aligner.flush();
    assert_eq!(std::iter::from_fn(|| aligner.pop()).count(), 25);
    aligner.push(both(2000, BODY));
    aligner.push(both(2000, WHEEL));
    assert!(aligner.pop().is_none());
}

#[test]
fn a_stamp_from_the_future_holds_nobody_up() {
    let readings = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 6.0, 0.0, mark(slot)));
    let mut readings: Vec<Reading> = readings.collect();
    readings.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let at_4_s = readings.iter().position(|reading| reading.time_s >= 4.0).unwrap();
    // Both of one message.
    for slot in [WHEEL, BODY] {
        readings.insert(at_4_s, Reading { time_s: 9e9, slot, value: 1.0 });
    }
    let (rows, report) = in_order(&ALL, readings);
    assert_eq!((rows.len(), report.strays), (3000, 2));
    assert!(rows.iter().all(|row| at(row, BODY).is_finite() && at(row, WHEEL).is_finite()));
}

#[test]
fn a_slow_signal_goes_on_after_a_stamp_from_the_future() {
    let slots = [Slot::Speed, BODY, WHEEL];
    let readings = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 6.0, 0.0, mark(slot)));
    let mut readings: Vec<Reading> = readings.collect();
    readings.extend(signal(Slot::Speed, 20.0, 6.0, 0.0, |_| 20.0));
    readings.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    for reading in readings.iter_mut().filter(|reading| reading.slot == Slot::Speed).skip(60).take(1) {
        reading.time_s += 1000.0;
    }
    let (rows, report) = in_order(&slots, readings);
    assert_eq!(report.strays, 1);
    let without = rows.iter().filter(|row| !at(row, Slot::Speed).is_finite()).count();
    assert!(without <= 25 && rows.len() == 3000, "{without} of {}", rows.len());
}

#[test]
fn after_a_pause_nothing_is_lost_and_a_stamp_that_stands_still_is_not_kept() {
    let both = |time_s: f64| [BODY, WHEEL].map(|slot| Reading { time_s, slot, value: 1.0 });
    let times = (0..2000).map(|i| f64::from(i) / 500.0 + if i < 1000 { 0.0 } else { 30.0 });
    let (rows, report) = in_order(&ALL, times.flat_map(both).collect());
    assert_eq!((rows.len(), report.strays), (2000, 0));
    let times = (0..2000).map(|i| if i < 1500 { f64::from(i) / 500.0 } else { 77.0 });
    let (rows, report) = in_order(&ALL, times.flat_map(both).collect());
    assert_eq!((rows.len(), report.strays), (1500, 1000));
}

#[test]
fn a_sensor_that_comes_late_is_taken_in() {
    let early = [BODY, WHEEL].into_iter().flat_map(|slot| signal(slot, 500.0, 8.0, 0.0, mark(slot)));
    let late = [OTHER_BODY, OTHER_WHEEL]
        .into_iter()
        .flat_map(|slot| signal(slot, 500.0, 8.0, 0.0004, mark(slot)).filter(|r| r.time_s > 5.0));
    let (rows, _) = rows(&ALL, early.chain(late).collect());
    assert_eq!(rows.len(), 4000);
    for row in &rows[2600..] {
        let time_s = at(row, Slot::Time);
        assert!((at(row, OTHER_BODY) - mark(OTHER_BODY)(time_s)).abs() < 1e-9, "{time_s}");
    }
}

proptest! {
    /// Whatever comes: no panic, bounded memory, rows in the order of time unless the clock was set back.
    #[test]
    fn anything_may_come(
        readings in prop::collection::vec((prop::num::f64::ANY, 0usize..SLOTS, prop::num::f64::ANY, 0u32..3000), 0..600)
    ) {
        let slots: Vec<Slot> = Slot::all().collect();
        let mut aligner = Aligner::new(&slots);
        let mut last_s = f64::NEG_INFINITY;
        for (wild_s, slot, value, tick) in readings {
            let time_s = if tick % 50 == 0 { wild_s } else { f64::from(tick) * 0.002 };
            aligner.push(Reading { time_s, slot: slots[slot], value });
            let restarts = |aligner: &Aligner| aligner.report().map_or(0, |report| report.restarts);
            while let Some(row) = aligner.pop_values() {
                prop_assert!(row[0] > last_s || restarts(&aligner) > 0);
                last_s = row[0];
            }
        }
        aligner.finish();
        while aligner.pop_values().is_some() {}
    }
}
