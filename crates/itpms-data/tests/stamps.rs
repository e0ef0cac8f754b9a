//! The order of the stamps is the order of the data: tables, bus logs and MDF4 files whose order, clocks or stamps are odd give the rows of
//! their plain twins, or one sentence.
#![cfg(all(feature = "can", feature = "mdf4"))]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use itpms_core::model::Corner;
use itpms_data::LogRow;
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::mdf4::{ChannelSpec, Compression, GroupSpec, Mdf4Writer, SampleFormat};

use crate::common::{Bench, Found, found};

const CORNERS: [Corner; 2] = [Corner::FrontLeft, Corner::RearLeft];
const RATE_HZ: f64 = 500.0;
const ROWS: u32 = 20_000;

/// Speed, and body and wheel of front left and rear left at row `k`, in whole thousandths.
fn values(k: u32) -> [f64; 5] {
    let t = f64::from(k) / RATE_HZ;
    let of = |amplitude: f64, hz: f64, phase: f64| {
        (1000.0 * amplitude * (std::f64::consts::TAU * hz * t + phase).sin()).round() / 1000.0
    };
    [20.0, of(2.0, 1.3, 0.0), of(9.0, 11.7, 0.3), of(2.0, 1.4, 1.0), of(9.0, 12.1, 2.0)]
}

const DBC: &str = r#"VERSION ""
BU_: A
BO_ 288 Car: 8 A
 SG_ speed_m_s : 0|16@1+ (0.01,0) [0|0] "m/s" A
BO_ 528 Front: 8 A
 SG_ fl_body_accel_m_s2 : 0|16@1- (0.001,0) [0|0] "m/s^2" A
 SG_ fl_wheel_accel_m_s2 : 16|16@1- (0.001,0) [0|0] "m/s^2" A
BO_ 529 Rear: 8 A
 SG_ rl_body_accel_m_s2 : 0|16@1- (0.001,0) [0|0] "m/s^2" A
 SG_ rl_wheel_accel_m_s2 : 16|16@1- (0.001,0) [0|0] "m/s^2" A
"#;

/// A frame: place in the file, stamp in s, the rest of its line.
type Frame = (f64, f64, String);

/// The frames of the drive, stamps and places as the row's time is.
fn frames() -> Vec<Frame> {
    let hex = |value: f64| {
        let raw = ((value * 1000.0).round() as i16).to_le_bytes();
        format!("{:02X}{:02X}", raw[0], raw[1])
    };
    let mut frames = Vec::new();
    for k in 0..ROWS {
        let time_s = f64::from(k) / RATE_HZ;
        let [_, fb, fw, rb, rw] = values(k);
        frames.push((time_s, time_s, "can0 120#D007000000000000".to_owned()));
        frames.push((time_s, time_s, format!("can0 210#{}{}", hex(fb), hex(fw))));
        frames.push((time_s, time_s, format!("can0 211#{}{}", hex(rb), hex(rw))));
    }
    frames
}

fn read(path: &Path, dbc: Option<PathBuf>) -> Result<Found, String> {
    found(path, &LogOptions { units: UnitCheck::Trusting, dbc, signals: None, rows: vec![] })
}

/// Writes the frames by their places and reads them.
fn bus(mut frames: Vec<Frame>) -> Result<Found, String> {
    let bench = Bench::new();
    frames.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut text = String::new();
    for (_, stamp_s, rest) in frames {
        writeln!(text, "({:.6}) {rest}", 1_772_352_000.0 + stamp_s).unwrap();
    }
    read(&bench.write("bus.log", text), Some(bench.write("car.dbc", DBC)))
}

/// The rows of the drive, `skip` of them left out at the beginning, times within `within_s` of their own after a common offset.
fn check(rows: &[LogRow], skip: u32, within_s: f64) {
    assert_eq!(rows.len(), (ROWS - skip) as usize);
    let at = |k: u32| f64::from(k) / RATE_HZ;
    let offset_s =
        rows.iter().zip(skip..).map(|(row, k)| row.time_s - at(k)).sum::<f64>() / rows.len() as f64;
    for (row, k) in rows.iter().zip(skip..) {
        assert!((row.time_s - offset_s - at(k)).abs() <= within_s, "{k}: {}", row.time_s - offset_s);
        let [_, fb, fw, rb, rw] = values(k);
        let [front, rear] = CORNERS.map(|corner| row.corners[corner.index()].unwrap());
        let found =
            [front.body_accel_m_s2, front.wheel_accel_m_s2, rear.body_accel_m_s2, rear.wheel_accel_m_s2];
        for (found, expected) in found.into_iter().zip([fb, fw, rb, rw]) {
            assert!((found - expected).abs() < 1e-9, "{k}: {found}, not {expected}");
        }
    }
}

#[test]
fn frames_in_another_order_than_their_stamps_give_the_same_rows() {
    let plain = bus(frames()).unwrap();
    check(&plain.rows, 0, 1e-6);
    assert_eq!((plain.warnings, plain.remarks), (vec![], vec![]));
    let is_rear = |frame: &Frame| frame.2.contains(" 211#");
    // Rear 6 ms later in the file; a stall of 50 ms each second; the rear written three seconds at a time.
    let late: [&dyn Fn(&Frame) -> f64; 3] = [
        &|frame| frame.1 + 0.0061,
        &|frame| if frame.1.fract() < 0.05 { frame.1.floor() + 0.0501 } else { frame.1 },
        &|frame| (frame.1 / 3.0).ceil() * 3.0 + 0.1,
    ];
    for place in late {
        let mut frames = frames();
        frames.iter_mut().filter(|frame| is_rear(frame)).for_each(|frame| frame.0 = place(frame));
        let found = bus(frames).unwrap();
        check(&found.rows, 0, 1e-6);
        assert_eq!(found.warnings, Vec::<String>::new());
        assert!(
            found.remarks.iter().any(|remark| remark.contains("put into the order")),
            "{:?}",
            found.remarks
        );
    }
}

#[test]
fn frames_under_a_coarse_clock_are_spread_and_uneven_ones_refused() {
    for step_s in [0.01, 0.015_625] {
        let mut frames = frames();
        frames.iter_mut().for_each(|frame| frame.1 = ((frame.1 + 1e-9) / step_s).floor() * step_s);
        let found = bus(frames).unwrap();
        // A fraction of the sample period; where the clock's step is no multiple of it, half a step over sixteen of them at most.
        check(&found.rows, 0, 5e-4);
        assert!(found.remarks.iter().any(|remark| remark.contains("spread")), "{:?}", found.remarks);
    }
    let mut frames = frames();
    frames.iter_mut().for_each(|frame| frame.1 = frame.1.floor());
    let refusal = bus(frames).err().unwrap();
    assert!(refusal.contains("steps of 1 s under 500 samples a second"), "{refusal}");
}

#[test]
fn a_bus_whose_clock_contradicts_the_others_is_refused_and_a_few_stamps_are_left_out() {
    let mut some = frames();
    some.iter_mut()
        .filter(|frame| frame.2.contains(" 211#"))
        .skip(5000)
        .take(10)
        .for_each(|frame| frame.1 += 4000.0);
    let found = bus(some).unwrap();
    // Rows of which the reader left out a reading are a gap, and no silence of a sensor.
    assert_eq!(found.rows.len(), ROWS as usize - 10);
    assert!(found.rows.iter().all(|row| row.corners[2].unwrap().wheel_accel_m_s2.is_finite()));
    assert!(found.warnings.iter().any(|warning| warning.contains("contradict")), "{:?}", found.warnings);
    let mut many = frames();
    many.iter_mut().skip(30_000).for_each(|frame| frame.1 -= 20.0);
    let refusal = bus(many).err().unwrap();
    assert!(refusal.contains("contradict"), "{refusal}");
}

/// An MDF4 file of front and rear in groups of their own, with these stamps at row `k`.
fn mdf4(path: &Path, front_s: impl Fn(u32) -> f64, rear_s: impl Fn(u32) -> f64) {
    let channels = |names: &[(&str, &str)]| {
        names
            .iter()
            .map(|(name, unit)| ChannelSpec::new(name, unit, SampleFormat::Float64))
            .collect::<Vec<_>>()
    };
    let group = |name: &str, channels| GroupSpec { name: name.to_owned(), comment: String::new(), channels };
    let accelerations =
        |corner: &str| [format!("{corner}_body_accel_m_s2"), format!("{corner}_wheel_accel_m_s2")];
    let ([fb, fw], [rb, rw]) = (accelerations("fl"), accelerations("rl"));
    let specs = [
        group("front", channels(&[("speed_m_s", "m/s"), (&fb, "m/s^2"), (&fw, "m/s^2")])),
        group("rear", channels(&[(&rb, "m/s^2"), (&rw, "m/s^2")])),
    ];
    let mut writer = Mdf4Writer::create(path, &specs, Compression::None).unwrap();
    for k in 0..ROWS {
        let [v, fb, fw, rb, rw] = values(k);
        writer.write(0, front_s(k), &[v, fb, fw]).unwrap();
        writer.write(1, rear_s(k), &[rb, rw]).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
}

#[test]
fn odd_stamps_of_one_group_hold_nothing_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mf4");
    let plain = |k: u32| f64::from(k) / RATE_HZ;
    mdf4(&path, plain, plain);
    check(&read(&path, None).unwrap().rows, 0, 1e-9);
    // Counters that wrapped below zero, as nanoseconds of 64 bits; of one group, and of both.
    let wrapped = |k: u32| if k < 13 { 18_446_744_073.709_55 - plain(13 - k) } else { plain(k) };
    for both in [false, true] {
        mdf4(&path, |k| if both { wrapped(k) } else { plain(k) }, wrapped);
        let found = read(&path, None).unwrap();
        check(&found.rows, 13, 1e-9);
        assert!(found.warnings.iter().any(|warning| warning.contains("left out")), "{:?}", found.warnings);
    }
    // One in the middle.
    mdf4(&path, plain, |k| if k == 9000 { -7e6 } else { plain(k) });
    assert_eq!(read(&path, None).unwrap().rows.len(), ROWS as usize - 1);
}

/// A table whose time at row `k` is written so, and whose rows come in the order of `place`.
fn table(time: impl Fn(u32) -> String, place: impl Fn(u32) -> u32) -> Result<Found, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv");
    let mut order: Vec<u32> = (0..ROWS).collect();
    order.sort_by_key(|k| place(*k));
    let mut text =
        "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,rl_body_accel_m_s2,rl_wheel_accel_m_s2\n"
            .to_owned();
    for k in order {
        let [v, fb, fw, rb, rw] = values(k);
        writeln!(text, "{},{v},{fb},{fw},{rb},{rw}", time(k)).unwrap();
    }
    fs::write(&path, text).unwrap();
    read(&path, None)
}

#[test]
fn tables_in_another_order_or_with_few_digits_give_the_same_rows() {
    let plain = |k: u32| format!("{:.3}", f64::from(k) / RATE_HZ);
    // Blocks of four seconds in another order.
    let swapped = table(plain, |k| ((k / 2000) ^ 1) * 2000 + k % 2000).unwrap();
    check(&swapped.rows, 0, 1e-9);
    assert!(
        swapped.warnings.iter().any(|warning| warning.contains("put into the order")),
        "{:?}",
        swapped.warnings
    );
    // Six significant digits past 1000 s, and 32 bits past 20 000 s at a rate that they cannot hold.
    let digits = |k: u32| {
        let time_s = 995.0 + f64::from(k) / RATE_HZ;
        if time_s < 1000.0 { format!("{time_s:.3}") } else { format!("{time_s:.2}") }
    };
    let found = table(digits, |k| k).unwrap();
    check(&found.rows, 0, 0.002);
    let single = |k: u32| format!("{}", (40_000.0 + f64::from(k) / RATE_HZ) as f32);
    // The first one, before which there is nothing, stays where it was rounded to: half a step of 2^-8 s.
    check(&table(single, |k| k).unwrap().rows, 0, 0.002);
}
