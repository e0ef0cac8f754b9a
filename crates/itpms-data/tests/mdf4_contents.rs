//! What of an MDF4 file is a signal: formulas, clocks in other units, stretches of one recording; and that what cannot be read is named with
//! its reason, by the list and by the refusal. Files of ours, changed at the block that the case is about.
#![cfg(feature = "mdf4")]

use std::fs;
use std::path::{Path, PathBuf};

use itpms_data::log::{CornerColumns, LogColumns, LogCorner, LogOptions, UnitCheck};
use itpms_data::mdf4::{ChannelSpec, Compression, GroupSpec, Mdf4Writer, SampleFormat};
use itpms_data::out::{LogWriter, Packing};
use itpms_data::signals::{Listing, resolve_knowing};
use itpms_data::{LogReader, LogRow};

use crate::common::{Bench, found, listed};

const NAMES: [&str; 3] = ["speed_m_s", "fl_body_accel_m_s2", "fl_wheel_accel_m_s2"];

/// The values of row `k`: whole numbers, so that a stored one and its hundredth are exact.
fn values(k: u32) -> [f64; 3] {
    [20.0, f64::from(k % 41) - 20.0, f64::from(k * 7 % 301) - 150.0]
}

fn group(name: &str, channels: &[&str]) -> GroupSpec {
    let units = ["m/s", "m/s^2", "m/s^2"];
    let channels = channels.iter().zip(units);
    GroupSpec {
        name: name.to_owned(),
        comment: String::new(),
        channels: channels.map(|(name, unit)| ChannelSpec::new(name, unit, SampleFormat::Float64)).collect(),
    }
}

/// A file of groups; row `k` of 4000 goes to that of `place`, at the time that is given.
fn write(path: &Path, groups: &[GroupSpec], place: impl Fn(u32) -> usize, time: impl Fn(u32) -> f64) {
    let mut writer = Mdf4Writer::create(path, groups, Compression::None).unwrap();
    for k in 0..4000 {
        writer.write(place(k), time(k), &values(k)).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
}

fn map(bench: &Bench, text: &str) -> PathBuf {
    bench.write("map.toml", format!("[signals]\n{text}\n"))
}

fn read(bench: &Bench, map: Option<PathBuf>) -> Result<Vec<LogRow>, String> {
    let options = LogOptions { units: UnitCheck::Trusting, dbc: None, signals: map, rows: vec![] };
    found(&bench.path("drive.mf4"), &options).map(|found| found.rows)
}

fn list(bench: &Bench) -> Listing {
    listed(&bench.path("drive.mf4"))
}

fn blocks(bytes: &[u8], id: &[u8; 4]) -> Vec<usize> {
    (0..bytes.len() - 4).step_by(8).filter(|at| &bytes[*at..at + 4] == id).collect()
}

fn word(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

fn text(bytes: &[u8], at: usize) -> String {
    let end = at + word(bytes, at + 8) as usize;
    String::from_utf8(bytes[at + 24..end].iter().copied().take_while(|byte| *byte != 0).collect()).unwrap()
}

fn channel(bytes: &[u8], name: &str) -> usize {
    let named = |at: &usize| text(bytes, word(bytes, at + 24 + 2 * 8) as usize) == name;
    blocks(bytes, b"##CN").into_iter().find(named).unwrap()
}

/// Appends a block; gives its place.
fn append(bytes: &mut Vec<u8>, id: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    let at = bytes.len() as u64;
    bytes.extend(id);
    bytes.extend([0; 4]);
    bytes.extend((24 + 8 * links.len() as u64 + data.len() as u64).to_le_bytes());
    bytes.extend((links.len() as u64).to_le_bytes());
    links.iter().for_each(|link| bytes.extend(link.to_le_bytes()));
    bytes.extend(data);
    at
}

/// Gives a channel an algebraic conversion (`cc_type` 3).
fn convert(bytes: &mut Vec<u8>, name: &str, formula: &str) {
    let formula = append(bytes, b"##TX", &[], format!("{formula}\0").as_bytes());
    let mut data = vec![3, 0, 0, 0, 1, 0, 0, 0];
    data.extend([0; 16]);
    let conversion = append(bytes, b"##CC", &[0, 0, 0, 0, formula], &data);
    let at = channel(bytes, name) + 24 + 4 * 8;
    bytes[at..at + 8].copy_from_slice(&conversion.to_le_bytes());
}

fn is_drive(rows: &[LogRow], scale: f64) {
    assert_eq!(rows.len(), 4000);
    for (k, row) in (0..).zip(rows) {
        let [speed, body, wheel] = values(k);
        let corner = row.corners[0].unwrap();
        assert!((row.time_s - f64::from(k) * 0.002).abs() < 1e-9, "{k}");
        assert_eq!((row.speed_m_s, corner.wheel_accel_m_s2), (speed, wheel), "{k}");
        assert!((corner.body_accel_m_s2 - scale * body).abs() < 1e-12, "{k}");
    }
}

#[test]
fn a_formula_is_computed_and_one_that_cannot_be_is_named() {
    let bench = Bench::new();
    write(&bench.path("drive.mf4"), &[group("car", &NAMES)], |_| 0, |k| f64::from(k) * 0.002);
    let plain = fs::read(bench.path("drive.mf4")).unwrap();
    let mut bytes = plain.clone();
    convert(&mut bytes, "fl_body_accel_m_s2", "X1/100");
    bench.write("drive.mf4", &bytes);
    is_drive(&read(&bench, None).unwrap(), 0.01);

    bytes = plain;
    convert(&mut bytes, "fl_body_accel_m_s2", "X1 > 3 ? 1 : 2");
    bench.write("drive.mf4", &bytes);
    let expected = "the formula \"X1 > 3 ? 1 : 2\", of which \"> 3 ? 1 : 2\" is not understood";
    let listing = list(&bench);
    assert_eq!(listing.unread[0].candidate.full_name(), "car.fl_body_accel_m_s2");
    assert!(listing.unread[0].why.contains(expected), "{:?}", listing.unread);
    // With a map and without one.
    for map in [None, Some(map(&bench, "fl_body_accel_m_s2 = \"fl_body_accel_m_s2\""))] {
        let refusal = read(&bench, map).unwrap_err();
        assert!(
            refusal.contains("car.fl_body_accel_m_s2") && refusal.contains("is not understood"),
            "{refusal}"
        );
        assert!(refusal.chars().count() <= 400, "{refusal}");
    }
}

#[test]
fn clocks_in_other_units_are_read() {
    for (unit, per_second) in [("ms", 1e3), ("us", 1e6), ("ns", 1e9)] {
        let bench = Bench::new();
        write(
            &bench.path("drive.mf4"),
            &[group("car", &NAMES)],
            |_| 0,
            |k| (f64::from(k) * 0.002 * per_second).round(),
        );
        let mut bytes = fs::read(bench.path("drive.mf4")).unwrap();
        let at = blocks(&bytes, b"##TX").into_iter().find(|at| text(&bytes, *at) == "s").unwrap();
        bytes[at + 8..at + 16].copy_from_slice(&27u64.to_le_bytes());
        bytes[at + 24..at + 27].copy_from_slice(format!("{unit}\0").as_bytes());
        bench.write("drive.mf4", &bytes);
        is_drive(&read(&bench, None).unwrap(), 1.0);
        let listing = list(&bench);
        assert_eq!(listing.groups[0].rate_hz, Some(500.0), "{unit}");
        assert!(listing.notes.iter().any(|note| note.contains(&format!("in {unit}"))), "{:?}", listing.notes);
    }
}

#[test]
fn stretches_of_one_recording_are_joined_and_others_of_one_name_are_not() {
    let bench = Bench::new();
    let full = NAMES.map(|name| format!("{name} = \"Suspension.{name}\"")).join("\n");
    let two = [group("Suspension", &NAMES), group("Suspension", &NAMES)];
    for first in [0, 1] {
        write(&bench.path("drive.mf4"), &two, |k| usize::from(k >= 1600) ^ first, |k| f64::from(k) * 0.002);
        is_drive(&read(&bench, None).unwrap(), 1.0);
        is_drive(&read(&bench, Some(map(&bench, &full))).unwrap(), 1.0);
        let listing = list(&bench);
        assert_eq!(listing.candidates().len(), 3);
        assert_eq!(listing.first_candidates(), [0, 0]);
    }
    // At the same times nothing tells which is which.
    write(&bench.path("drive.mf4"), &two, |k| (k % 2) as usize, |k| f64::from(k) * 0.002);
    let refusal = read(&bench, Some(map(&bench, &full))).unwrap_err();
    assert!(refusal.contains("\"Suspension.speed_m_s\", of which there are 2"), "{refusal}");
    assert_eq!(list(&bench).candidates().len(), 6);
}

#[test]
fn frames_of_a_bus_and_groups_without_a_clock_are_named_as_such() {
    let bench = Bench::new();
    let frames = ["CAN_DataFrame", "CAN_DataFrame.ID", "CAN_DataFrame.DLC"];
    write(&bench.path("drive.mf4"), &[group("CAN", &frames)], |_| 0, |k| f64::from(k) * 0.002);
    let refusal = read(&bench, None).unwrap_err();
    assert!(refusal.contains("is a CAN log") && refusal.contains("--dbc"), "{refusal}");
    assert_eq!(list(&bench).kind, "message");
    let frames = ["LIN_Frame", "LIN_Frame.ID", "LIN_Frame.DataLength"];
    write(&bench.path("drive.mf4"), &[group("LIN", &frames)], |_| 0, |k| f64::from(k) * 0.002);
    let refusal = read(&bench, None).unwrap_err();
    assert!(refusal.contains("LIN.LIN_Frame is frames of another bus than CAN"), "{refusal}");
    assert!(list(&bench).unread[0].why.contains("frames of another bus"));

    write(&bench.path("drive.mf4"), &[group("car", &NAMES)], |_| 0, |k| f64::from(k) * 0.002);
    let mut bytes = fs::read(bench.path("drive.mf4")).unwrap();
    // The master becomes a channel like the others.
    let data = channel(&bytes, "time") + 24 + 8 * 8;
    bytes[data..data + 2].copy_from_slice(&[0, 0]);
    bench.write("drive.mf4", &bytes);
    let refusal = read(&bench, None).unwrap_err();
    assert!(refusal.contains("whose clock is missing"), "{refusal}");
    let listing = list(&bench);
    assert!(
        listing.unread.iter().all(|unread| unread.why.contains("clock is missing")),
        "{:?}",
        listing.unread
    );
    let resolved = resolve_knowing(&listing.candidates(), &listing.unread, None).unwrap();
    assert!(resolved.remarks().len() == 3 && resolved.unusable().is_some());
}

/// Without its only packed block there are no rows, and the reader of logs says why.
#[test]
fn a_log_that_is_cut_off_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("log.mf4");
    let corner = CornerColumns { pressure: false, road: false };
    let columns =
        LogColumns { speed: true, corners: [Some(corner), None, None, None], ..LogColumns::default() };
    let mut writer = LogWriter::create_with(&path, columns, &LogOptions::default(), Packing::Packed).unwrap();
    for i in 0..20_000 {
        let time_s = f64::from(i) / 500.0;
        let values = LogCorner::measured((9.0 * time_s).sin(), 9.0 * (71.0 * time_s).sin());
        writer.write(&LogRow::without_motion(time_s, 20.0, [Some(values), None, None, None])).unwrap();
    }
    writer.finish().unwrap().commit().unwrap();
    assert!(LogReader::open(&path).is_ok());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let messages = LogReader::open(&path).unwrap_err().to_string();
    assert!(
        messages.contains("too few values of the mapped accelerations (") && messages.contains("cut off"),
        "{messages}"
    );
}
