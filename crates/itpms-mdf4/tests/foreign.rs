//! MDF4 files of another program, and files built block by block, against the formulas they were made from. All of them
//! are made and held against the same formulas by `data/make.py`.

use std::path::{Path, PathBuf};

use itpms_mdf4::{ChannelKind, Mdf4Reader, Mdf4Repair};

const FAST: usize = 240;
const SLOW: usize = 24;

fn fast_time(i: usize) -> f64 {
    i as f64 * 0.002
}

fn slow_time(i: usize) -> f64 {
    i as f64 * 0.02 + 0.001
}

fn accel(i: usize) -> f64 {
    (i * i % 97) as f64 * 0.25 - 10.0
}

fn count(i: usize) -> f64 {
    (i * 37 % 200) as f64 - 100.0
}

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Times, values and repairs of a channel, found by its name.
struct Read {
    unit: String,
    times: Vec<f64>,
    values: Vec<f64>,
    repairs: Vec<Mdf4Repair>,
}

fn read(reader: &Mdf4Reader, channel: &str) -> Read {
    let (group, index) = find(reader, channel);
    let mut cursor = reader.cursor(group, &[index]).unwrap();
    let (mut times, mut values, mut value) = (Vec::new(), Vec::new(), [0.0]);
    while let Some(time) = cursor.next(&mut value).unwrap() {
        times.push(time);
        values.push(value[0]);
        assert!((0.0..=1.0).contains(&cursor.progress()));
    }
    assert_eq!(cursor.progress(), 1.0);
    let unit = reader.groups()[group].channels[index].unit.clone();
    Read { unit, times, values, repairs: cursor.repairs().to_vec() }
}

fn find(reader: &Mdf4Reader, channel: &str) -> (usize, usize) {
    let groups = reader.groups().iter().enumerate();
    let mut found =
        groups.filter_map(|(g, group)| Some((g, group.channels.iter().position(|c| c.name == channel)?)));
    found.next().unwrap_or_else(|| panic!("no channel {channel}"))
}

/// Equal to the last bit, or both NaN.
#[track_caller]
fn same(found: &[f64], count: usize, expected: impl Fn(usize) -> f64) {
    assert_eq!(found.len(), count);
    for (i, found) in found.iter().enumerate() {
        let expected = expected(i);
        assert!(*found == expected || (found.is_nan() && expected.is_nan()), "{i}: {found}, not {expected}");
    }
}

#[test]
fn groups_at_native_rates_are_read_however_they_are_stored() {
    for name in ["plain.mf4", "deflate.mf4", "transposed.mf4", "lists-plain.mf4", "lists-transposed.mf4"] {
        let reader = Mdf4Reader::open(&file(name)).unwrap();
        assert_eq!(reader.repairs(), [], "{name}");
        let groups: Vec<_> =
            reader.groups().iter().map(|g| (g.name.as_str(), g.samples, g.has_time)).collect();
        assert_eq!(groups, [("fast", Some(FAST as u64), true), ("slow", Some(SLOW as u64), true)], "{name}");
        for channel in ["accel_f64", "accel_f32", "accel_f16"] {
            let found = read(&reader, channel);
            same(&found.times, FAST, fast_time);
            same(&found.values, FAST, accel);
            assert_eq!((found.unit.as_str(), found.repairs.len()), ("m/s^2", 0), "{name}");
        }
        same(&read(&reader, "scaled").values, FAST, |i| 0.5 * count(i) - 3.0);
        let wide = read(&reader, "wide");
        same(&wide.times, SLOW, slow_time);
        same(&wide.values, SLOW, |i| i as f64 * 1_000_003.0);
        assert_eq!(wide.unit, "µm");
        let (group, words) = find(&reader, "words");
        assert!(matches!(reader.groups()[group].channels[words].kind, ChannelKind::VariableLength));
        let refused = reader.cursor(group, &[words]).unwrap_err().to_string();
        assert!(refused.ends_with(
            "channel \"words\" of group \"slow\" cannot be read as numbers: it is of varying length"
        ));
        let (group, commented) = find(&reader, "accel_f64");
        assert_eq!(reader.groups()[group].channels[commented].comment, "body, front left");
        // 2026-11-20, midnight UTC.
        assert_eq!(reader.start_ns(), 1_795_132_800_000_000_000);
    }
}

#[test]
fn several_channels_of_a_group_come_side_by_side() {
    let reader = Mdf4Reader::open(&file("transposed.mf4")).unwrap();
    let (group, _) = find(&reader, "scaled");
    let indices: Vec<usize> = ["scaled", "accel_f32"].iter().map(|name| find(&reader, name).1).collect();
    let mut cursor = reader.cursor(group, &indices).unwrap();
    let mut values = [0.0; 2];
    for i in 0..FAST {
        assert_eq!(cursor.next(&mut values).unwrap(), Some(fast_time(i)));
        assert_eq!(values, [0.5 * count(i) - 3.0, accel(i)]);
    }
    assert_eq!(cursor.next(&mut values).unwrap(), None);
    assert_eq!(cursor.next(&mut values).unwrap(), None);
    assert!(reader.cursor(2, &[]).is_err());
    assert!(reader.cursor(0, &[99]).is_err());
}

#[test]
fn invalid_values_are_missing() {
    let reader = Mdf4Reader::open(&file("invalidation.mf4")).unwrap();
    same(&read(&reader, "thirds").values, FAST, |i| if i % 3 == 0 { f64::NAN } else { accel(i) });
    same(&read(&reader, "all_valid").values, FAST, accel);
    same(&read(&reader, "fifths").values, FAST, |i| if i % 5 == 4 { f64::NAN } else { count(i) });
}

#[test]
fn both_byte_orders_and_bits_anywhere_are_read() {
    let reader = Mdf4Reader::open(&file("big-endian.mf4")).unwrap();
    same(&read(&reader, "f64").values, FAST, accel);
    same(&read(&reader, "f32").values, FAST, accel);
    same(&read(&reader, "i16").values, FAST, count);
    same(&read(&reader, "u32").values, FAST, |i| i as f64 * 70_000.0);
    let reader = Mdf4Reader::open(&file("sub-byte.mf4")).unwrap();
    let three = read(&reader, "three_bits");
    same(&three.values, SLOW, |i| (i % 8) as f64);
    same(&read(&reader, "signed_12").values, SLOW, count);
    same(&read(&reader, "motorola_12").values, SLOW, count);
    same(&read(&reader, "one_bit").values, SLOW, |i| (i % 2) as f64);
    same(&read(&reader, "partly").values, SLOW, |i| match 255 - 5 * i {
        255 => f64::NAN,
        x @ 200..=220 => 0.5 * x as f64,
        x => 2.0 * x as f64 + 1.0,
    });
    // The clock of this file is computed from the number of the sample.
    same(&three.times, SLOW, |i| 1.0 + 0.01 * i as f64);
}

#[test]
fn conversions_give_physical_values_and_text_none() {
    let reader = Mdf4Reader::open(&file("conversions.mf4")).unwrap();
    let raw = |i: usize| (i % 12) as f64;
    // Through (0, 0), (4, 10), (8, 40), (12, 90).
    same(&read(&reader, "interpolated").values, FAST, |i| match raw(i) {
        x if x <= 4.0 => 2.5 * x,
        x if x <= 8.0 => 10.0 + 7.5 * (x - 4.0),
        x => 40.0 + 12.5 * (x - 8.0),
    });
    same(&read(&reader, "nearest").values, FAST, |i| match i % 12 {
        0..=2 => 0.0,
        3..=6 => 10.0,
        7..=10 => 40.0,
        _ => 90.0,
    });
    same(&read(&reader, "ranges").values, FAST, |i| match i % 12 {
        x if x % 3 == 0 && x < 9 => 100.0 * (x / 3) as f64,
        _ => -1.0,
    });
    same(&read(&reader, "rational").values, FAST, |i| 6.0 / (raw(i) + 1.0));
    same(&read(&reader, "words").values, FAST, raw);
    same(&read(&reader, "formula").values, FAST, |i| 2.0 * raw(i));
}

#[test]
fn columns_with_a_remote_time_are_read() {
    for name in ["columns.mf4", "columns-lists.mf4"] {
        let reader = Mdf4Reader::open(&file(name)).unwrap();
        // Invalidation bytes apart from the values are in the lists alone.
        let lists = name.contains("lists");
        let plain = read(&reader, "plain");
        same(&plain.times, FAST, fast_time);
        same(&plain.values, FAST, accel);
        let sevenths = read(&reader, "sevenths");
        same(&sevenths.times, FAST, fast_time);
        same(&sevenths.values, FAST, |i| if lists && i % 7 == 0 { f64::NAN } else { count(i) });
        assert_eq!((plain.repairs.len(), sevenths.repairs.len()), (0, 0));
    }
}

#[test]
fn mixed_records_are_sorted_by_their_ids() {
    for name in ["unsorted.mf4", "unfinalised-unsorted.mf4"] {
        let reader = Mdf4Reader::open(&file(name)).unwrap();
        let (fast, slow) = (read(&reader, "accel"), read(&reader, "count"));
        // A count of 10 µs times 1e-5 s, as a product in both programs.
        same(&fast.times, FAST, |i| (200 * i) as f64 * 1e-5);
        same(&fast.values, FAST, accel);
        same(&slow.times, SLOW, |i| (2000 * i + 100) as f64 * 1e-5);
        same(&slow.values, SLOW, count);
        assert!(fast.times.iter().enumerate().all(|(i, t)| (t - fast_time(i)).abs() < 1e-12));
        assert_eq!((fast.repairs.len(), slow.repairs.len()), (0, 0), "{name}: {:?}", fast.repairs);
        let (group, words) = find(&reader, "words");
        assert_eq!(reader.groups()[group].channels[words].kind, ChannelKind::VariableLength);
    }
}

#[test]
fn versions_2_and_3_are_read_with_their_conversions() {
    for name in ["v330.dat", "v214.dat"] {
        let reader = Mdf4Reader::open(&file(name)).unwrap();
        assert_eq!(reader.repairs(), [], "{name}");
        let raw = |i: usize| count(i);
        let linear = read(&reader, "linear");
        same(&linear.times, SLOW, slow_time);
        same(&linear.values, SLOW, |i| 0.125 * raw(i) - 7.0);
        assert_eq!(linear.unit, "kPa");
        same(&read(&reader, "rational").values, SLOW, |i| (2.0 * raw(i) + 6.0) / 4.0);
        same(&read(&reader, "formula").values, SLOW, |i| raw(i) * 0.5 + 3.0);
        same(&read(&reader, "nothing").values, SLOW, raw);
        // Through (-100, 0), (0, 10) and (100, 40).
        same(&read(&reader, "interpolated").values, SLOW, |i| {
            let x = raw(i);
            if x < 0.0 { (x + 100.0) / 100.0 * 10.0 } else { 10.0 + x / 100.0 * 30.0 }
        });
        same(&read(&reader, "a_name_that_is_longer_than_32_letters_in_all").values, SLOW, accel);
        let accel_f64 = read(&reader, "accel");
        same(&accel_f64.times, FAST, fast_time);
        same(&accel_f64.values, FAST, accel);
    }
    // Records of two kinds by their ids, numbers in Motorola's order; 24 March 2003, 12:52:32.
    let reader = Mdf4Reader::open(&file("v300-mixed.dat")).unwrap();
    assert_eq!((reader.repairs(), reader.start_ns()), (&[][..], 1_048_510_352_000_000_000));
    let (fast, slow) = (read(&reader, "accel"), read(&reader, "count"));
    same(&fast.times, FAST, |i| (200 * i) as f64 * 1e-5);
    same(&fast.values, FAST, accel);
    same(&slow.values, SLOW, count);
}

#[test]
fn an_unfinalised_file_is_read_to_its_end_and_that_is_reported() {
    let reader = Mdf4Reader::open(&file("unfinalised.mf4")).unwrap();
    let messages: Vec<String> = reader.repairs().iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "the file was not finalised (missing: numbers of samples, length of the last data block): taken from \
          the data instead"
        ]
    );
    assert_eq!(reader.groups()[0].samples, None);
    let found = read(&reader, "accel");
    same(&found.times, FAST, fast_time);
    same(&found.values, FAST, accel);
    let cut = Mdf4Repair::PartialRecord { group: "fast".to_owned(), bytes: 5 };
    assert_eq!(found.repairs, [cut]);
}

#[test]
fn a_file_whose_writer_was_killed_and_never_said_so_is_read_to_its_end() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("killed.mf4");
    let mut bytes = std::fs::read(file("unfinalised.mf4")).unwrap();
    bytes[..8].copy_from_slice(b"MDF     ");
    bytes[60] = 0;
    std::fs::write(&path, bytes).unwrap();
    let reader = Mdf4Reader::open(&path).unwrap();
    assert_eq!(reader.repairs(), [Mdf4Repair::CountZero { group: "fast".to_owned() }]);
    let found = read(&reader, "accel");
    same(&found.times, FAST, fast_time);
    same(&found.values, FAST, accel);
    let messages = found.repairs[0].to_string();
    assert!(messages.ends_with("has no length; it is taken to reach to the end of the file"), "{messages}");
}
