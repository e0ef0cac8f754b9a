//! CAN logs as buses make them: values that mean "none", messages that never come, frames that come twice, stamps before a trigger, one signal in two
//! places. Each gives the rows of its plain twin.
#![cfg(feature = "can")]

use std::fmt::Write as _;

use itpms_data::LogRow;
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::signals::{Lister, resolve_among};

use crate::common::{Bench, found};

const SAMPLES: u32 = 800;

/// Hundredths of the speed in m/s and of the accelerations of front left's body and wheel in sample `k`.
fn raw(k: u32) -> [i16; 3] {
    let wave = |step: u32, most: i16| ((k * step) % 997) as i16 % (2 * most + 1) - most;
    [2222, wave(37, 150), wave(101, 900)]
}

const DBC: &str = "BO_ 256 Veh: 8 E\n SG_ speed_m_s : 0|16@1- (0.01,0) [-327|327] \"m/s\" E\nBO_ 272 Susp: 8 E\n SG_ fl_body_accel_m_s2 : 0|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n SG_ fl_wheel_accel_m_s2 : 16|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n";

/// The frames of sample `k`: identifier and data.
fn frames(k: u32) -> [(u32, Vec<u8>); 2] {
    let [speed, body, wheel] = raw(k);
    let bytes = |words: &[i16]| {
        let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        bytes.resize(8, 0);
        bytes
    };
    [(0x100, bytes(&[speed])), (0x110, bytes(&[body, wheel]))]
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02X}");
        text
    })
}

/// A log of candump with the frames that `change` makes of each.
fn candump(mut change: impl FnMut(u32, u32, Vec<u8>) -> Vec<u8>) -> String {
    let mut text = String::new();
    for k in 0..SAMPLES {
        for (place, (id, data)) in frames(k).into_iter().enumerate() {
            let time_s = 1.7e9 + 0.005 * f64::from(k) + 1e-4 * place as f64;
            let _ = writeln!(text, "({time_s:.6}) can0 {id:03X}#{}", hex(&change(k, id, data)));
        }
    }
    text
}

/// The rows of a log, and the remarks on it.
fn read(bench: &Bench, name: &str, log: &str, dbc: &str) -> Result<(Vec<LogRow>, Vec<String>), String> {
    let (log, dbc) = (bench.write(name, log), Some(bench.write("bus.dbc", dbc)));
    let options = LogOptions { units: UnitCheck::Trusting, dbc, ..LogOptions::default() };
    found(&log, &options).map(|found| (found.rows, found.warnings))
}

fn plain_twin(bench: &Bench) -> Vec<LogRow> {
    read(bench, "plain.log", &candump(|_, _, data| data), DBC).unwrap().0
}

/// Time from the first row, speed and accelerations, to compare.
fn numbers(rows: &[LogRow]) -> Vec<[String; 4]> {
    let first_s = rows[0].time_s;
    let number = |row: &LogRow| {
        let corner = row.corners[0].unwrap();
        let numbers = [row.time_s - first_s, row.speed_m_s, corner.body_accel_m_s2, corner.wheel_accel_m_s2];
        numbers.map(|number| format!("{number:.5}"))
    };
    rows.iter().map(number).collect()
}

#[test]
fn an_end_of_the_raw_numbers_beyond_the_stated_range_is_no_value() {
    let bench = Bench::new();
    let missing = |k: u32| k % 50 == 7;
    let log = candump(|k, id, mut data| {
        if id == 0x110 && missing(k) {
            data[2..4].copy_from_slice(&[0x00, 0x80]);
        }
        data
    });
    let (rows, messages) = read(&bench, "odd.log", &log, DBC).unwrap();
    let labelled = format!("{DBC}VAL_ 272 fl_wheel_accel_m_s2 -32768 \"SNA\" ;\n");
    let (twin, _) = read(&bench, "odd.log", &log, &labelled).unwrap();
    assert_eq!(numbers(&rows), numbers(&twin));
    for (row, plain) in rows.iter().zip(plain_twin(&bench)) {
        let k = ((row.time_s - 1.7e9) / 0.005).round() as u32;
        assert_eq!(row.corners[0].unwrap().wheel_accel_m_s2.is_nan(), missing(k), "{k}");
        assert_eq!(row.corners[0].unwrap().body_accel_m_s2, plain.corners[0].unwrap().body_accel_m_s2);
    }
    let messages = messages.join("\n");
    let expected = "16 values are an end of their raw numbers beyond the stated range and were taken as not available: Susp.fl_wheel_accel_m_s2 16 times (raw 0x8000, stated [-327|327])";
    assert!(messages.contains(expected), "{messages}");
    // Without a range nothing is known, and a value beyond it that is no end stays one.
    let (rows, _) = read(&bench, "odd.log", &log, &DBC.replace("[-327|327]", "[0|0]")).unwrap();
    assert!(rows.iter().all(|row| row.corners[0].unwrap().wheel_accel_m_s2.is_finite()));
    let (rows, messages) =
        read(&bench, "plain.log", &candump(|_, _, data| data), &DBC.replace("[-327|327]", "[-1|1]")).unwrap();
    assert_eq!((numbers(&rows), messages), (numbers(&plain_twin(&bench)), Vec::new()));
}

#[test]
fn a_message_that_never_comes_competes_with_none_that_does() {
    let bench = Bench::new();
    let old = "BO_ 1000 Old: 8 E\n SG_ fl_body_accel_m_s2 : 0|16@1- (0.005,0) [0|0] \"m/s^2\" E\n";
    let log = candump(|_, _, data| data);
    // Before and after the one that comes, and one that comes but is never available.
    let never =
        format!("{old}{}", "BO_ 1001 Sna: 2 E\n SG_ FL_BodyAccZ : 0|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n");
    for dbc in [format!("{DBC}{old}"), format!("{old}{DBC}"), format!("{never}{DBC}")] {
        let log = if dbc.contains("1001") {
            format!("(1.7e9) can0 3E9#0080\n{log}").replace("1.7e9", "1699999999.999000")
        } else {
            log.clone()
        };
        let (rows, _) = read(&bench, "a.log", &log, &dbc).unwrap();
        assert_eq!(numbers(&rows), numbers(&plain_twin(&bench)), "{dbc}");
        let mut lister = Lister::open(&bench.path("a.log"), Some(&bench.path("bus.dbc")), &[]).unwrap();
        while lister.step().unwrap() {}
        let listing = lister.finish();
        let resolved = resolve_among(&listing.candidates(), &listing.has_samples(), &[], None).unwrap();
        let map = resolved.to_toml(None);
        assert!(map.contains("fl_body_accel_m_s2 = \"Susp.fl_body_accel_m_s2\""), "{map}");
    }
    // Where only that would be it, the reason is reported.
    let dbc = format!("{old}{}", DBC.replace("fl_body_accel_m_s2", "other"));
    let mut listing = read(&bench, "a.log", &log, &dbc);
    assert!(listing.is_err());
    let two =
        format!("{dbc}BO_ 1002 Older: 2 E\n SG_ fl_body_accel_m_s2 : 0|16@1- (0.01,0) [0|0] \"m/s^2\" E\n");
    listing = read(&bench, "a.log", &log, &two);
    let messages = listing.unwrap_err();
    assert!(
        messages
            .contains("fl_body_accel_m_s2 could be Old.fl_body_accel_m_s2, which has no samples in this log"),
        "{messages}"
    );
}

/// The lines of an ASC file: stamp, whether sent, identifier, data.
fn asc(lines: impl Iterator<Item = (f64, bool, u32, Vec<u8>)>) -> String {
    let mut text = "date Thu May 16 06:16:50 pm 2024\nbase hex timestamps absolute\n".to_owned();
    for (time_s, sent, id, data) in lines {
        let bytes: Vec<String> = data.iter().map(|byte| format!("{byte:02X}")).collect();
        let direction = if sent { "Tx" } else { "Rx" };
        let _ = writeln!(text, "{time_s:.6} 1  {id:X} {direction} d 8 {}", bytes.join(" "));
    }
    text
}

#[test]
fn frames_that_come_twice_count_once_and_stamps_may_be_negative() {
    let bench = Bench::new();
    let at = |k: u32, place: usize| 0.005 * f64::from(k) + 1e-4 * place as f64;
    let all = || {
        (0..SAMPLES).flat_map(move |k| {
            frames(k).into_iter().enumerate().map(move |(place, (id, data))| (at(k, place), id, data))
        })
    };
    let twice = all()
        .flat_map(|(time_s, id, data)| [(time_s, true, id, data.clone()), (time_s + 2e-5, false, id, data)]);
    let (rows, messages) = read(&bench, "twice.asc", &asc(twice), DBC).unwrap();
    assert_eq!(numbers(&rows), numbers(&plain_twin(&bench)));
    assert!(messages.join("\n").contains("1600 frames repeat the one before"), "{messages:?}");
    let negative = all().map(|(time_s, id, data)| (time_s - 2.0, false, id, data));
    let (rows, messages) = read(&bench, "negative.asc", &asc(negative), DBC).unwrap();
    assert_eq!((numbers(&rows), messages), (numbers(&plain_twin(&bench)), Vec::new()));
}

#[test]
fn one_signal_in_two_branches_of_a_multiplexer_is_one_signal() {
    let bench = Bench::new();
    let susp = "BO_ 272 Susp: 8 E\n SG_ Lay M : 0|8@1+ (1,0) [0|0] \"\" E\n SG_ fl_body_accel_m_s2 m0 : 8|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n SG_ fl_wheel_accel_m_s2 m0 : 24|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n SG_ fl_body_accel_m_s2 m1 : 16|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n SG_ fl_wheel_accel_m_s2 m1 : 32|16@1- (0.01,0) [-327|327] \"m/s^2\" E\n";
    let plain = format!("{}{susp}", &DBC[..DBC.find("BO_ 272").unwrap()]);
    // With extended multiplexing the ranges of a name stand together.
    let extended = format!(
        "{plain}SG_MUL_VAL_ 272 fl_body_accel_m_s2 Lay 0-0, 1-1;\nSG_MUL_VAL_ 272 fl_wheel_accel_m_s2 Lay 0-0, 1-1;\n"
    );
    let log = candump(|k, id, data| {
        if id != 0x110 {
            return data;
        }
        let layout = (k % 2) as u8;
        let mut moved = vec![layout; 1 + usize::from(layout)];
        moved.extend_from_slice(&data[..4]);
        moved.resize(8, 0);
        moved
    });
    for dbc in [plain, extended] {
        let (rows, messages) = read(&bench, "two.log", &log, &dbc).unwrap();
        assert_eq!((numbers(&rows), messages), (numbers(&plain_twin(&bench)), Vec::new()), "{dbc}");
    }
}
