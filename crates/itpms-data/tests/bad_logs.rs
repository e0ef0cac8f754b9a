//! Every way in which a drive log can be wrong, and the sentence it earns.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use itpms_data::LogReader;
use itpms_data::log::UnitCheck;
use proptest::prelude::*;

use crate::common::Bench;

const HEADER: &str = "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2";

/// The message of reading a log to its end, without the directory.
fn message(path: &Path) -> String {
    let read = || {
        let mut log = LogReader::open(path)?;
        while log.next_row()?.is_some() {}
        Ok::<(), itpms_data::DataError>(())
    };
    let text = read().unwrap_err().to_string();
    let directory = path.parent().unwrap().display().to_string();
    text.replace(&format!("{directory}/"), "")
}

fn csv_message(content: &str) -> String {
    let bench = Bench::new();
    message(&bench.write("drive.csv", content))
}

/// A drive of sines with a plausible size, 100 Hz, `edit` changing a line (line 1 is the header).
fn drive(rows: u64, edit: impl Fn(u64, &mut String)) -> String {
    let mut out = format!("{HEADER}\n");
    for i in 0..rows {
        let t = i as f64 / 100.0;
        let mut line = format!("{t},10,{},{}", (9.0 * t).sin(), 4.0 * (70.0 * t).sin());
        edit(i + 2, &mut line);
        let _ = writeln!(out, "{line}");
    }
    out
}

#[test]
fn missing_file_directory_and_unknown_extension() {
    let bench = Bench::new();
    assert_eq!(message(&bench.path("nowhere.csv")), "nowhere.csv: no such file");
    let directory = bench.path("drives.csv");
    fs::create_dir(&directory).unwrap();
    assert_eq!(message(&directory), "drives.csv: is a directory, expected a file");
    let path = bench.write("drive.mat", "x");
    let elsewhere = message(&path);
    assert!(
        elsewhere.starts_with("drive.mat: a file of MATLAB") && elsewhere.contains("export CSV"),
        "{elsewhere}"
    );
    assert!(message(&bench.write("drive", "x")).starts_with("drive: no file extension, expected .csv"));
}

#[test]
fn empty_and_header_only() {
    for empty in ["", "\n", "\n\n  \n"] {
        assert!(csv_message(empty).starts_with("drive.csv: the file is empty, expected a header line"));
    }
    let bench = Bench::new();
    for (name, expected) in [
        #[cfg(feature = "parquet")]
        ("drive.parquet", "a Parquet file with time_s and the accelerations of a corner"),
        #[cfg(feature = "mdf4")]
        ("drive.mf4", "an MDF4 file"),
        #[cfg(feature = "can")]
        ("drive.asc", "CAN frames"),
        ("drive.csv", "a header line with time_s and the accelerations of a corner"),
    ] {
        let found = message(&bench.write(name, ""));
        assert_eq!(found, format!("{name}: the file is empty, expected {expected}"));
    }
    let text = csv_message(&format!("{HEADER}\n"));
    assert_eq!(text, "drive.csv: there is a header but no row under it");
    assert_eq!(csv_message(HEADER), text);
}

#[test]
fn text_in_another_encoding_is_read_as_it_is() {
    let bench = Bench::new();
    let text = drive(300, |_, _| {});
    let path = bench.write("drive.csv", &text);
    let rows = |path: &Path| format!("{:?}", LogReader::open(path).unwrap().collect::<Vec<_>>());
    let expected = rows(&path);
    let wide = |to: fn(u16) -> [u8; 2], mark: &str, text: &str| -> Vec<u8> {
        format!("{mark}{text}").encode_utf16().flat_map(to).collect()
    };
    // As Excel has it, with tabs and decimal commas, in each order; without a mark; with that of UTF-8.
    let tabs = text.replace(',', "\t").replace('.', ",");
    for bytes in [
        wide(u16::to_le_bytes, "\u{feff}", &tabs),
        wide(u16::to_be_bytes, "\u{feff}", &tabs),
        wide(u16::to_le_bytes, "", &text),
        format!("\u{feff}{text}").into_bytes(),
    ] {
        for name in ["drive.csv", "drive.txt"] {
            let path = bench.write(name, "");
            fs::write(&path, &bytes).unwrap();
            assert_eq!(rows(&path), expected);
        }
    }
}

#[test]
fn missing_and_duplicate_columns() {
    let text = csv_message("time_s,fl_body_accel_m_s2,fl_wheel_accel\n0,1,2\n");
    assert_eq!(
        text,
        "drive.csv: column fl_wheel_accel_m_s2 is missing; the nearest name there is fl_wheel_accel"
    );
    let text = csv_message("\u{feff}time_s,time_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2\n0,0,1,2\n");
    assert_eq!(text, "drive.csv: column time_s appears twice (columns 1 and 2), expected once: rename one");
}

#[test]
fn a_file_that_is_no_table_does_not_flood_the_screen() {
    let bench = Bench::new();
    let path = bench.path("noise.csv");
    let bytes: Vec<u8> = (0..20_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    fs::write(&path, bytes).unwrap();
    let text = message(&path);
    assert!(text.starts_with("noise.csv: ") && text.len() < 200, "{text}");
}

#[test]
fn a_cell_that_is_no_number_is_found_by_line_and_column() {
    let text = csv_message(&drive(10, |line, text| {
        if line == 7 {
            *text = text.replacen(",10,", ",fast,", 1);
        }
    }));
    assert_eq!(
        text,
        "drive.csv: line 7, column speed_m_s: found \"fast\", expected a number, or NaN or nothing where it is missing"
    );
    // Lines are those of the file: comments and blank lines count.
    for line_end in ["\n", "\r\n"] {
        let lines = ["# a comment", HEADER, "0,1,2,3", "", "# another", "1,1,x,3", ""];
        let text = csv_message(&lines.join(line_end));
        assert!(text.starts_with("drive.csv: line 6, column fl_body_accel_m_s2: found \"x\""), "{text}");
    }
    // Beyond the rows that are looked at first, too.
    let text = csv_message(&drive(6000, |line, text| {
        if line == 5500 {
            text.push('!');
        }
    }));
    assert!(text.starts_with("drive.csv: line 5500, column fl_wheel_accel_m_s2: found"), "{text}");
}

#[test]
fn a_row_of_another_length_is_an_error_unless_the_file_was_cut_off_there() {
    let text = csv_message(&drive(10, |line, text| {
        if line == 5 {
            text.push_str(",1");
        }
    }));
    assert_eq!(text, "drive.csv: line 5: found 5 cells, expected 4 as in the header");
    let text = csv_message(&drive(10, |line, text| {
        if line == 5 {
            text.truncate(3);
        }
    }));
    assert!(text.starts_with("drive.csv: line 5: found 1 cells"), "{text}");
}

#[test]
fn a_last_line_without_its_end_is_left_out_and_counted_wherever_it_was_cut() {
    let bench = Bench::new();
    let whole = drive(10, |_, _| {});
    let last = whole.lines().last().unwrap().len();
    // From the line end alone, which leaves a number that looks whole, to all but the first digit.
    for missing in 1..=last {
        let path = bench.write("drive.csv", &whole[..whole.len() - missing]);
        let mut log = LogReader::open(&path).unwrap();
        assert_eq!(log.by_ref().count(), 9, "{missing} bytes are missing");
        assert_eq!(log.repairs().cut_off_lines, 1, "{missing} bytes are missing");
        assert_eq!(
            log.repairs().warnings(),
            ["1 line at the end is cut off (it has no line end) and was left out"]
        );
    }
    let mut log = LogReader::open(&bench.write("drive.csv", &whole)).unwrap();
    assert_eq!(log.by_ref().count(), 10);
    assert!(log.repairs().is_clean());
}

#[test]
fn time_going_backwards_standing_still_or_missing() {
    let text = csv_message(&drive(100, |line, text| {
        let (_, rest) = text.split_once(',').unwrap();
        *text = format!("{},{rest}", 200 - line);
    }));
    assert_eq!(
        text,
        "drive.csv: time goes backwards in 99 of the 100 rows read, at line 3 from 198 to 197 s, expected it to increase \
         (rows are put in order over ten seconds; sort the file by its time, or cut it where the clock was set)"
    );
    let text = csv_message(&drive(100, |_, text| *text = format!("5{}", &text[text.find(',').unwrap()..])));
    assert_eq!(
        text,
        "drive.csv: time is constant: time_s is 5 in all of the 100 rows read, expected it to increase"
    );
    let text = csv_message(&drive(100, |_, text| *text = text[text.find(',').unwrap()..].to_owned()));
    assert_eq!(text, "drive.csv: column time_s has no value in any of 100 rows");
    // Set back long after the start.
    let text = csv_message(&drive(20_000, |line, text| {
        if line > 12_000 {
            let (time, rest) = text.split_once(',').unwrap();
            *text = format!("{},{rest}", time.parse::<f64>().unwrap() - 100.0);
        }
    }));
    assert!(text.contains("at line 12001 from 119.98 to 19.989"), "{text}");
}

#[test]
fn one_sample_and_all_nan() {
    let text = csv_message(&drive(1, |_, _| {}));
    assert_eq!(text, "drive.csv: found 1 sample with a time, expected at least 2");
    for rows in [50, 9000] {
        let all_nan = drive(rows, |_, text| *text = format!("{},10,NaN,", text.split_once(',').unwrap().0));
        assert_eq!(
            csv_message(&all_nan),
            format!(
                "drive.csv: column fl_body_accel_m_s2 has no value in any of {rows} rows, and no other corner is complete"
            )
        );
    }
}

#[test]
fn milliseconds_in_the_time_column() {
    let text = csv_message(&drive(100, |line, text| {
        *text = format!("{},{}", 2 * line, text.split_once(',').unwrap().1);
    }));
    assert!(text.contains("sample period is 2 s (0.500 Hz)") && text.contains("milliseconds"), "{text}");
}

#[test]
fn accelerations_in_g_unless_the_user_insists() {
    let bench = Bench::new();
    let path = bench.write(
        "drive.csv",
        drive(1000, |_, text| {
            let cells: Vec<f64> = text.split(',').map(|cell| cell.parse().unwrap()).collect();
            *text = format!("{},{},{},{}", cells[0], cells[1], 1.0 + cells[2] / 9.81, 1.0 + cells[3] / 9.81);
        }),
    );
    let text = message(&path);
    assert!(
        text.starts_with("drive.csv: wrong units suspected (accelerations in g): fl body and wheel"),
        "{text}"
    );
    assert!(text.ends_with("expected m/s^2"));
    assert_eq!(LogReader::open_with(&path, &UnitCheck::Trusting.into()).unwrap().count(), 1000);
}

#[test]
fn small_flaws_are_repaired_and_counted() {
    let bench = Bench::new();
    let path = bench.write(
        "drive.csv",
        drive(6000, |line, text| match line {
            10 => *text = format!("-1{}", &text[text.find(',').unwrap()..]),
            20 => *text = format!("0.17{}", &text[text.find(',').unwrap()..]),
            30 => *text = "0.28,,,".to_owned(),
            40 => *text = ",10,0,0".to_owned(),
            5000.. => {
                let (time, rest) = text.split_once(',').unwrap();
                *text = format!("{},{rest}", time.parse::<f64>().unwrap() + 1.0);
            }
            _ => {}
        }),
    );
    let mut log = LogReader::open(&path).unwrap();
    assert_eq!(log.survey().sample_rate_hz, 100.0);
    let times: Vec<f64> = log.by_ref().map(|row| row.unwrap().time_s).collect();
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
    let report = log.repairs();
    assert_eq!((report.rows_read, report.rows_kept), (6000, 5997));
    assert_eq!((report.out_of_order, report.duplicate_times, report.without_time), (1, 1, 1));
    assert_eq!((report.missing_accelerations, report.missing_speeds), (2, 1));
    // A second is missing before line 5000; leaving out single rows of 10 ms opens no gap of 30 ms.
    assert_eq!(report.gaps, 1);
    let (length_s, begin_s) = report.longest_gap.unwrap();
    assert!((length_s - 1.01).abs() < 1e-9 && (begin_s - 49.97).abs() < 1e-9);
    assert_eq!(report.warnings().len(), 6);
}

proptest! {
    /// Whatever is in a file: rows in the order of time, or one sentence, never a panic.
    #[test]
    fn no_content_brings_the_reader_down(
        header in any::<bool>(),
        body in proptest::collection::vec(prop_oneof![
            8 => "[0-9.,eE+-]{0,12}\n",
            2 => "[ -~]{0,20}\r?\n",
            1 => "\\PC{0,20}",
        ], 0..30),
        tail in proptest::collection::vec(any::<u8>(), 0..40),
    ) {
        let bench = Bench::new();
        let path = bench.path("drive.csv");
        let mut bytes = if header { format!("{HEADER}\n").into_bytes() } else { Vec::new() };
        bytes.extend(body.concat().into_bytes());
        bytes.extend(tail);
        fs::write(&path, bytes).unwrap();
        let mut last_s = f64::NEG_INFINITY;
        if let Ok(log) = LogReader::open(&path) {
            for row in log {
                let Ok(row) = row else { break };
                prop_assert!(row.time_s > last_s);
                last_s = row.time_s;
            }
        }
    }
}
