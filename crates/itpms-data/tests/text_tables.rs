//! Text tables as programs of many kinds write them: each has to give the very rows of its plain twin.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use itpms_data::log::{LogOptions, UnitCheck};
use itpms_data::{LogReader, LogRow};

use crate::common::{Bench, found, listed};

const NAMES: [&str; 4] = ["time_s", "speed_m_s", "fl_body_accel_m_s2", "fl_wheel_accel_m_s2"];
const ROWS: u32 = 300;

/// Values that every spelling has exactly: hundredths of s, halves and quarters.
fn values(i: u32) -> [f64; 4] {
    let wheel = f64::from(i % 13) - 6.0;
    [f64::from(i) / 100.0, 20.0 + 0.5 * f64::from(i % 3), 0.25 * wheel, wheel]
}

/// A table whose cells are written by `cell` and parted by `separator`.
fn table(separator: &str, cell: impl Fn(usize, f64) -> String) -> String {
    let mut text = NAMES.join(separator) + "\n";
    for i in 0..ROWS {
        let cells: Vec<String> =
            values(i).iter().enumerate().map(|(place, value)| cell(place, *value)).collect();
        text += &(cells.join(separator) + "\n");
    }
    text
}

fn plain() -> String {
    table(",", |_, value| value.to_string())
}

fn read(path: &Path, map: Option<&Path>) -> Result<(Vec<LogRow>, Vec<String>), String> {
    let options = LogOptions { signals: map.map(Path::to_owned), ..LogOptions::from(UnitCheck::Trusting) };
    found(path, &options).map(|found| (found.rows, found.warnings))
}

fn same(found: &[LogRow], expected: &[LogRow], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        // Compared as text, for NaN is NaN here.
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{what}");
    }
}

#[test]
fn every_dialect_gives_the_rows_of_its_plain_twin() {
    let bench = Bench::new();
    let (expected, _) = read(&bench.write("plain.csv", plain()), None).unwrap();
    let decimal = |_: usize, value: f64| value.to_string().replace('.', ",");
    let dialects = [
        ("sep.csv", format!("sep=;\n{}", table(";", decimal))),
        ("tabs.tsv", table("\t", |_, value| value.to_string())),
        ("bars.txt", table("|", |_, value| value.to_string())),
        ("trailing.csv", plain().replace('\n', ",\n").replacen(",\n", "\n", 1)),
        ("trailing header.csv", plain().replacen('\n', ",\n", 1)),
        ("trailing both.csv", plain().replace('\n', ",\n")),
        ("quotes.csv", table(",", |_, value| format!("\"{value}\""))),
        ("windows.csv", plain().replace('\n', "\r\n")),
        ("mark.csv", format!("\u{feff}{}", plain())),
        ("units.csv", plain().replacen('\n', "\ns,m/s,m/s^2,[m/s\u{b2}]\n", 1)),
    ];
    for (name, text) in dialects {
        let path = bench.write(name, text);
        let (rows, warnings) = read(&path, None).unwrap_or_else(|text| panic!("{name}: {text}"));
        same(&rows, &expected, name);
        assert_eq!(warnings, Vec::<String>::new(), "{name}");
        let listing = listed(&path);
        assert_eq!((listing.samples, listing.clock.as_deref()), (u64::from(ROWS), Some("time_s")), "{name}");
    }
}

#[test]
fn a_packed_table_is_read_as_it_is() {
    let bench = Bench::new();
    let (expected, _) = read(&bench.write("plain.csv", plain()), None).unwrap();
    for name in ["drive.csv.gz", "drive.TSV.GZ", "called.csv"] {
        let path = bench.path(name);
        let mut packer = GzEncoder::new(File::create(&path).unwrap(), Compression::default());
        packer.write_all(plain().as_bytes()).unwrap();
        packer.finish().unwrap();
        same(&read(&path, None).unwrap().0, &expected, name);
    }
    let text = read(&bench.write("drive.gz", "x"), None).unwrap_err();
    assert!(text.contains("unknown file extension .gz, expected .csv"), "{text}");
}

#[test]
fn a_unit_under_a_name_is_that_columns() {
    let bench = Bench::new();
    let (expected, _) = read(&bench.write("plain.csv", plain()), None).unwrap();
    // Our names with other units; and another program's names, with a map for what they do not say.
    let scaled = table(",", |place, value| match place {
        0 => format!("{}", (value * 1000.0).round()),
        1 => format!("{}", value * 3.6),
        _ => value.to_string(),
    });
    let ours = scaled.replacen('\n', "\nms,km/h,m/s^2,m/s^2\n", 1);
    let theirs = ours.replacen(&NAMES.join(","), "Time,VehicleSpeed,FL_BodyAccZ,hub", 1);
    let map = bench.write("map.toml", "[signals]\nfl_wheel_accel_m_s2 = \"hub\"\n");
    for (name, text, map) in [("ours.csv", ours, None), ("theirs.csv", theirs, Some(map.as_path()))] {
        let (rows, _) = read(&bench.write(name, text), map).unwrap_or_else(|text| panic!("{name}: {text}"));
        assert_eq!(rows.len(), expected.len(), "{name}");
        for (found, expected) in rows.iter().zip(&expected) {
            assert!((found.time_s - expected.time_s).abs() < 1e-12, "{name}");
            assert!((found.speed_m_s - expected.speed_m_s).abs() < 1e-12, "{name}");
            assert_eq!(
                found.corners[0].unwrap().body_accel_m_s2,
                expected.corners[0].unwrap().body_accel_m_s2
            );
        }
    }
    let wrong = plain().replacen('\n', "\ns,m/s,kPa,m/s^2\n", 1);
    let text = read(&bench.write("wrong.csv", wrong), None).unwrap_err();
    assert!(text.ends_with("column fl_body_accel_m_s2 has the unit kPa, expected m/s^2"), "{text}");
}

#[test]
fn what_is_missing_has_many_spellings_in_a_log() {
    let bench = Bench::new();
    let spelled = |word: &str| {
        table(
            ",",
            |place, value| if place == 2 && value == 0.0 { word.to_owned() } else { value.to_string() },
        )
    };
    let (expected, _) = read(&bench.write("plain.csv", spelled("")), None).unwrap();
    assert!(expected.iter().any(|row| row.corners[0].unwrap().body_accel_m_s2.is_nan()));
    for word in ["NA", "#N/A", "None", "<NA>", "nan", "-nan(ind)", "null"] {
        let (rows, _) = read(&bench.write("drive.csv", spelled(word)), None)
            .unwrap_or_else(|text| panic!("{word}: {text}"));
        same(&rows, &expected, word);
    }
}

#[test]
fn names_that_come_again_and_zeros_at_the_end_are_reported() {
    let bench = Bench::new();
    let (expected, _) = read(&bench.write("plain.csv", plain()), None).unwrap();
    let head = NAMES.join(",") + "\n";
    let middle = plain().find("\n1.5,").unwrap() + 1;
    let again = format!("{}{head}{}", &plain()[..middle], &plain()[middle..]);
    let (rows, warnings) = read(&bench.write("again.csv", again), None).unwrap();
    same(&rows, &expected, "again");
    assert_eq!(warnings, ["the header comes once more and was left out"]);
    for zeros in [1, 5000, 3 << 20] {
        let text = [plain().as_bytes(), b"3.0,20", &vec![0; zeros]].concat();
        let (rows, warnings) = read(&bench.write("zeros.csv", text), None).unwrap();
        same(&rows, &expected, "zeros");
        assert!(warnings[0].starts_with("1 line at the end is cut off"), "{warnings:?}");
    }
}

#[test]
fn a_clock_of_dates_is_read_in_every_spelling() {
    let bench = Bench::new();
    for zone in ["", "Z", "+0000", "+00", "+00:00", " UTC"] {
        for point in [".", ","] {
            let stamp = |value: f64| format!("2026-03-01 08:00:{value:06.3}{zone}").replace('.', point);
            let text = table("\t", |place, value| if place == 0 { stamp(value) } else { value.to_string() });
            let (rows, _) =
                read(&bench.write("drive.csv", text), None).unwrap_or_else(|text| panic!("{zone}: {text}"));
            for (i, row) in rows.iter().enumerate() {
                assert!(
                    (row.time_s - 1_772_352_000.0 - i as f64 / 100.0).abs() < 3e-7,
                    "{zone}{point} {row:?}"
                );
            }
        }
    }
}

/// A table with a row for every message: the speed's, the body's, the wheel's, each later than the one before by `lag_s`.
fn messages(lag_s: f64) -> String {
    let mut text = NAMES.join(",") + "\n";
    for i in 0..ROWS {
        let [time_s, values @ ..] = values(i);
        for (place, value) in values.iter().enumerate() {
            let mut cells = [const { String::new() }; NAMES.len()];
            cells[0] = format!("{:.4}", time_s + lag_s * place as f64);
            cells[1 + place] = value.to_string();
            text += &(cells.join(",") + "\n");
        }
    }
    text
}

#[test]
fn rows_that_are_messages_are_put_together_by_their_times() {
    let bench = Bench::new();
    let (expected, _) = read(&bench.write("plain.csv", plain()), None).unwrap();
    let accelerations = |row: &LogRow| row.corners[0].map(|c| (c.body_accel_m_s2, c.wheel_accel_m_s2));
    for lag_s in [0.0, 0.0005] {
        let path = bench.write("messages.csv", messages(lag_s));
        let (rows, _) = read(&path, None).unwrap();
        assert_eq!(rows.len(), expected.len());
        for (row, expected) in rows.iter().zip(&expected) {
            assert!(
                (row.time_s - expected.time_s - lag_s).abs() < 1e-9,
                "{} {}",
                row.time_s,
                expected.time_s
            );
            assert_eq!(accelerations(row), accelerations(expected), "{lag_s} {}", row.time_s);
        }
        let log = LogReader::open(&path).unwrap();
        assert!(log.remarks()[0].contains("each row of the table is a message"), "{:?}", log.remarks());
    }
}

/// Rows in memory are looked at as those of a file are, and one without a time is reported.
#[test]
fn messages_in_memory_and_one_without_a_time() {
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); NAMES.len()];
    for i in 0..ROWS {
        let [time_s, values @ ..] = values(i);
        for (place, value) in values.iter().enumerate() {
            columns[0].push(if (i, place) == (200, 0) { f64::NAN } else { time_s });
            (1..NAMES.len()).for_each(|k| columns[k].push(if k == 1 + place { *value } else { f64::NAN }));
        }
    }
    let mut piece = Some(columns.into_iter().map(Ok).collect());
    let names = NAMES.map(str::to_owned);
    let pieces = Box::new(move || Ok(piece.take()));
    let options = LogOptions::from(UnitCheck::Trusting);
    let mut log = LogReader::from_pieces(Path::new("frame"), &names, None, pieces, &options).unwrap();
    let mut rows = 0;
    while let Some(row) = log.next_row().unwrap() {
        let expected = values(rows);
        assert_eq!((row.time_s, row.corners[0].unwrap().wheel_accel_m_s2), (expected[0], expected[3]));
        rows += 1;
    }
    assert_eq!(rows, ROWS);
    let warnings = log.repairs().warnings();
    assert!(warnings.iter().any(|text| text.contains("1 row without a time was left out")), "{warnings:?}");
}

/// A sensor that loses seven of eight samples is one that loses samples: the others' are in the same rows.
#[test]
fn a_sensor_that_loses_samples_makes_no_messages_of_rows() {
    let bench = Bench::new();
    let lossy = table(",", |place, value| {
        let is_lost = place == 3 && value != 3.0;
        if is_lost { String::new() } else { value.to_string() }
    });
    let path = bench.write("lossy.csv", lossy);
    let (rows, _) = read(&path, None).unwrap();
    assert_eq!(rows.len(), ROWS as usize);
    assert!(rows.iter().filter(|row| row.corners[0].unwrap().wheel_accel_m_s2.is_nan()).count() > 250);
    assert!(LogReader::open(&path).unwrap().alignment().is_none());
}

/// A logger that writes all rows at the rate of its fastest sensor leaves the cells of the others empty in between.
#[test]
fn sensors_of_lower_rates_are_no_sensors_that_lose_samples() {
    let bench = Bench::new();
    let sparse = |every: u32, columns: &[usize]| {
        let mut text = NAMES.join(",") + "\n";
        for i in 0..2 * ROWS {
            let [_, values @ ..] = values(i);
            text += &format!("{:.4}", f64::from(i) / 200.0);
            for (place, value) in values.iter().enumerate() {
                let is_blank = i % every != 0 && columns.contains(&(1 + place));
                text += &if is_blank { ",".to_owned() } else { format!(",{value}") };
            }
            text += "\n";
        }
        text
    };
    for columns in [&[2, 3][..], &[2], &[1, 2]] {
        let path = bench.write("rates.csv", sparse(2, columns));
        let (rows, _) = read(&path, None).unwrap();
        assert!(rows.len().abs_diff(ROWS as usize) < 12, "{columns:?} {}", rows.len());
        let corners = || rows.iter().filter_map(|row| row.corners[0]);
        let lost = corners().filter(|c| (c.body_accel_m_s2 + c.wheel_accel_m_s2).is_nan()).count();
        assert!(lost < 12, "{columns:?} {lost}");
        let log = LogReader::open_with(&path, &LogOptions::from(UnitCheck::Trusting)).unwrap();
        assert!(log.remarks()[0].contains("at a rate of their own"), "{:?}", log.remarks());
        assert!((log.survey().sample_rate_hz - 100.0).abs() < 1e-6);
    }
    // At random half of the samples: those are lost.
    let mut text = NAMES.join(",") + "\n";
    let mut state = 1u32;
    for i in 0..2 * ROWS {
        let [_, speed, body, wheel] = values(i);
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let wheel = if state >> 31 == 0 { String::new() } else { wheel.to_string() };
        text += &format!("{:.4},{speed},{body},{wheel}\n", f64::from(i) / 200.0);
    }
    let path = bench.write("lossy.csv", text);
    let log = LogReader::open_with(&path, &LogOptions::from(UnitCheck::Trusting)).unwrap();
    assert!(log.alignment().is_none());
}

#[test]
fn a_clock_of_another_name_is_the_time_and_messages_name_it() {
    let bench = Bench::new();
    let (expected, _) = read(&bench.write("plain.csv", plain()), None).unwrap();
    let renamed = |name: &str, time: &dyn Fn(f64) -> String| {
        let cell = |place, value: f64| if place == 0 { time(value) } else { value.to_string() };
        table(",", cell).replacen("time_s", name, 1)
    };
    let german = renamed("Datum", &|t| format!("30.03.2025 00:59:0{t:.3}"));
    let american = renamed("DateTime", &|t| format!("03/30/2025 12:59:0{t:.3} AM"));
    for text in [
        german,
        american,
        renamed("timestamp", &|t| t.to_string()),
        renamed("t [ms]", &|t| (1e3 * t).to_string()),
    ] {
        let (rows, _) = read(&bench.write("clock.csv", &text), None).unwrap();
        assert_eq!(rows.len(), expected.len());
        for (row, expected) in rows.iter().zip(&expected) {
            let since_s = row.time_s - rows[0].time_s;
            assert!((since_s - expected.time_s).abs() < 1e-5, "{since_s} {}", expected.time_s);
            let accelerations =
                |row: &LogRow| row.corners[0].map(|c| (c.body_accel_m_s2, c.wheel_accel_m_s2));
            assert_eq!(accelerations(row), accelerations(expected));
        }
    }
    for (name, scale, first, unit) in [
        ("timestamp", 1e3, 1.7e12, "ms"),
        ("time_s", 1e9, 1.7e18, "ns"),
        ("Time", 1.0 / 86_400.0, 45_000.5, "d"),
    ] {
        let text = renamed(name, &|t| format!("{:.11}", first + scale * t));
        let path = bench.write("clock.csv", text);
        let message = read(&path, None).unwrap_err();
        let line = format!("time_s = {{ signal = {name:?}, unit = {unit:?} }}");
        assert!(message.contains(&line), "{message}");
        let map = bench.write("map.toml", format!("[signals]\n{line}\n"));
        let (rows, _) = read(&path, Some(&map)).unwrap();
        assert_eq!(rows.len(), expected.len(), "{name}");
    }
}

#[test]
fn what_is_no_table_of_samples_is_refused_with_the_remedy() {
    let bench = Bench::new();
    let frames = "(1436509052.249713) can0 123#DEADBEEF\n(1436509052.259713) can0 123#DEADBEEF\n";
    let message = read(&bench.write("bus.txt", frames), None).unwrap_err();
    assert!(message.contains("rename it to end in .log"), "{message}");
    let message = read(&bench.write("mean.csv", plain() + "Mean,20,1,2\n"), None).unwrap_err();
    assert!(message.contains("line 302") && message.contains("delete it"), "{message}");
    let twice = plain().replacen("speed_m_s", "time_s", 1);
    let message = read(&bench.write("twice.csv", twice), None).unwrap_err();
    assert!(message.contains("twice (columns 1 and 2), expected once: rename one"), "{message}");
    // Every 20th value of the body is missing.
    let body = std::cell::Cell::new(0);
    let missing = table(",", |place, value| {
        body.set(body.get() + u32::from(place == 2));
        if place == 2 && body.get().is_multiple_of(20) { "-9999".to_owned() } else { value.to_string() }
    });
    let message = LogReader::open(&bench.write("missing.csv", missing)).unwrap_err().to_string();
    assert!(message.contains("fl body acceleration is -9999 in 15 of the first 300 rows"), "{message}");
}
