//! Tables of tooth pulses: in the order of time whatever the order of their rows, the same from text and Parquet, and refused in one line.

use std::path::PathBuf;

use itpms_core::model::Corner::{self, FrontLeft as FL, FrontRight as FR, RearLeft as RL, RearRight as RR};
use itpms_data::pulses::{Pulse, PulseReader, PulseWriter};

fn file(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

/// All pulses and repairs, or the message.
type All = Result<(Vec<(f64, Corner)>, Vec<String>), String>;

/// Those of a text, its path left out of the message.
fn read(text: &str) -> All {
    let (_folder, path) = file("p.csv", text);
    all(&path).map_err(|error| error.replacen(&format!("{}: ", path.display()), "", 1))
}

fn all(path: &std::path::Path) -> All {
    let mut reader = PulseReader::open(path).map_err(|error| error.to_string())?;
    let mut pulses = vec![];
    while let Some(pulse) = reader.next_pulse().map_err(|error| error.to_string())? {
        pulses.push((pulse.time_s, pulse.wheel));
    }
    Ok((pulses, reader.repairs()))
}

#[test]
fn rows_come_in_the_order_of_time_and_repairs_are_counted() {
    let text = "wheel;note; Time_S\n;;s\nfl;a;0,001\nRR;b;0,003\nfr;c;0,002\n# a comment\nrl;;0,004\nrl;;0,004\nfl;;\nfl;;1,5\nrr;;1,6";
    let (pulses, repairs) = read(text).unwrap();
    assert_eq!(pulses, [(0.001, FL), (0.002, FR), (0.003, RR), (0.004, RL), (1.5, FL)]);
    assert_eq!(
        repairs,
        [
            "1 pulses were put into the order of time",
            "1 pulses came twice and were left out",
            "1 rows without a time were left out",
            "the last line is cut off and was left out"
        ]
    );
    // Two wheels at one time are two pulses.
    assert_eq!(read("time_s,wheel\n1,fr\n1,fl\n").unwrap().0, [(1.0, FL), (1.0, FR)]);
}

#[test]
fn pulses_are_handed_out_up_to_a_time() {
    let (_folder, path) = file("p.csv", "time_s,wheel\n0.1,fl\n0.2,fl\n30,fl\n");
    let mut reader = PulseReader::open(&path).unwrap();
    let mut until = |time_s| reader.next_until(time_s).unwrap().map(|pulse| pulse.time_s);
    assert_eq!([until(0.15), until(0.15), until(0.2), until(29.0)], [Some(0.1), None, Some(0.2), None]);
    assert_eq!([until(31.0), until(31.0)], [Some(30.0), None]);
}

#[test]
fn what_is_no_table_of_pulses_is_refused_in_one_line() {
    for (text, message) in [
        ("", "the file is empty, expected a header line with time_s and wheel"),
        (
            "times_s,wheel\n1,fl\n",
            "found the columns times_s, wheel, expected time_s and wheel: time_s is missing; the nearest name there is times_s",
        ),
        (
            "time_s,corner\n1,fl\n",
            "found the columns time_s, corner, expected time_s and wheel: wheel is missing",
        ),
        ("time_s,wheel,WHEEL\n1,fl,fl\n", "two columns are called wheel, expected one"),
        ("time_s,wheel\nms,-\n1,fl\n", "the unit of time_s is \"ms\", expected s"),
        (
            "time_s,wheel\n1,fl\n2,front left\n",
            "line 3, column wheel: found \"front left\", expected fl, fr, rl or rr",
        ),
        ("time_s,wheel\n1,\n", "line 2, column wheel: found \"\", expected fl, fr, rl or rr"),
        (
            "time_s,wheel\n1 s,fl\n",
            "line 2, column time_s: found \"1 s\", expected a number, or NaN or nothing where it is missing",
        ),
        ("time_s,wheel\n1,fl,3\n", "line 2: found 3 cells, expected 2 as in the header"),
        (
            "time_s,wheel\n1,fl\n40,fl\n2,fr\n",
            "line 4, column time_s: found 2 s after the 40 s of line 3, expected the pulses of all wheels in the order of time (sort the table by time_s, or cut it where the clock was set)",
        ),
    ] {
        assert_eq!(read(text).unwrap_err(), message);
    }
    let missing = PulseReader::open(std::path::Path::new("nothing/p.csv")).unwrap_err().to_string();
    assert_eq!(missing, "nothing/p.csv: no such file");
    let other = PulseReader::open(std::path::Path::new("p.txt")).unwrap_err().to_string();
    assert!(other.contains("expected .csv"), "{other}");
}

#[test]
fn what_is_written_is_read_again_from_both_formats() {
    let folder = tempfile::tempdir().unwrap();
    // More than a row group and a batch, at ticks of 0.1 us.
    let pulses: Vec<Pulse> = (0..70_000)
        .map(|k| Pulse { time_s: f64::from(k) * 4.567e-4, wheel: Corner::ALL[k as usize % 4] })
        .collect();
    let expected: Vec<(f64, Corner)> = pulses.iter().map(|p| (p.time_s, p.wheel)).collect();
    let names = if cfg!(feature = "parquet") { &["p.csv", "p.parquet"][..] } else { &["p.csv"] };
    for name in names {
        let path = folder.path().join(name);
        let mut writer = PulseWriter::create(&path).unwrap();
        pulses.iter().for_each(|pulse| writer.write(pulse).unwrap());
        writer.finish().unwrap().commit().unwrap();
        let (read, repairs) = all(&path).unwrap();
        assert!(repairs.is_empty() && read.len() == expected.len());
        // To the nanosecond that is written.
        assert!(read.iter().zip(&expected).all(|(a, b)| (a.0 - b.0).abs() < 0.6e-9 && a.1 == b.1), "{name}");
    }
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_without_names_of_wheels_is_refused() {
    use itpms_data::out::{Cell, Kind, Table};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.parquet");
    let of = |kind: Kind, cell: Cell<'_>| {
        let mut table =
            Table::create(&path, &[("time_s".to_owned(), Kind::Number), ("wheel".to_owned(), kind)]).unwrap();
        table.write(&[Cell::Number(1.0), cell]).unwrap();
        table.finish().unwrap().commit().unwrap();
        let message = all(&path).unwrap_err();
        message.replacen(&format!("{}: ", path.display()), "", 1)
    };
    assert_eq!(
        of(Kind::Number, Cell::Number(2.0)),
        "column wheel holds numbers or times, expected one of the words fl, fr, rl, rr"
    );
    assert_eq!(
        of(Kind::Label, Cell::Label("left")),
        "row 1, column wheel: found another word, expected fl, fr, rl or rr"
    );
}
