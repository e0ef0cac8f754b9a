//! `itpms convert`: what comes out reads back as what went in.
#![cfg(all(feature = "can", feature = "mdf4", feature = "parquet"))]
#![allow(clippy::unwrap_used, reason = "a test ends where something is wrong")]

use crate::common;

use std::path::Path;

use common::Bench;
use itpms_data::can::FrameReader;
use itpms_data::mdf4::Mdf4Reader;

const DRIVE: &str = "\
# a tenth of a second
time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,fl_pressure_kpa
0,20.5,0.25,-3,240
0.002,20.5,0.125,4.5,240
0.004,20.5,,NaN,240
0.006,20.5,-0.375,-1.25,240
";

/// A drive of a second, long enough that the rates of a bus can be measured.
fn bench() -> Bench {
    let mut text = DRIVE.to_owned();
    for i in 4..500 {
        let (time_s, body, wheel) =
            (f64::from(i) / 500.0, (f64::from(i) * 0.7).sin(), f64::from(i % 17) - 8.0);
        text += &format!("{time_s},20.5,{body},{wheel},240\n");
    }
    let bench = Bench::new();
    bench.write("drive.csv", text);
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can");
    for name in ["car.dbc", "map.toml"] {
        bench.write(name, std::fs::read(examples.join(name)).unwrap());
    }
    bench
}

const BUS: &str = "--dbc car.dbc --signals map.toml";

#[test]
fn tables_and_mdf4_keep_every_bit() {
    let bench = bench();
    for line in [
        "convert drive.csv a.mf4",
        "convert a.mf4 b.mf4 --plain",
        "convert b.mf4 c.parquet",
        "convert c.parquet d.csv",
        "convert drive.csv e.csv",
    ] {
        bench.run(line).success();
    }
    assert_eq!(bench.read("d.csv"), bench.read("e.csv"));
    assert_eq!(bench.read("d.csv").lines().nth(3), Some("0.004,20.5,,,240"));

    let reader = Mdf4Reader::open(&bench.path("b.mf4")).unwrap();
    let channels = reader.groups()[0].channels.iter().filter(|channel| !channel.is_time);
    let units: Vec<(&str, &str)> =
        channels.map(|channel| (channel.name.as_str(), channel.unit.as_str())).collect();
    assert_eq!(
        units,
        [
            ("speed_m_s", "m/s"),
            ("fl_body_accel_m_s2", "m/s^2"),
            ("fl_wheel_accel_m_s2", "m/s^2"),
            ("fl_pressure_kpa", "kPa"),
        ]
    );
}

#[test]
fn a_map_says_what_the_columns_of_a_table_are() {
    let bench = bench();
    let other: String = bench
        .read("drive.csv")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| match line.split(',').collect::<Vec<_>>()[..] {
            ["time_s", ..] => "Stamp,Speed,A,B,P\n".to_owned(),
            // Half the speed; all else as it is.
            [time_s, _, ref rest @ ..] => format!("{time_s},10.25,{}\n", rest.join(",")),
            _ => String::new(),
        })
        .collect();
    bench.write("other.csv", other);
    bench.write(
        "columns.toml",
        r#"[signals]
time_s = "Stamp"
speed_m_s = { signal = "Speed", factor = 2.0 }
fl_body_accel_m_s2 = { signal = "A", unit = "m/s^2" }
fl_wheel_accel_m_s2 = { signal = "B", unit = "m/s^2" }
fl_pressure_kpa = { signal = "P", unit = "kPa" }
"#,
    );
    bench.run("convert drive.csv plain.csv").success();
    bench.run("convert other.csv a.parquet --signals columns.toml").success();
    bench.run("convert other.csv b.mf4 --signals columns.toml").success();
    for mapped in ["a.parquet", "b.mf4"] {
        bench.run(&format!("convert {mapped} back.csv")).success();
        assert_eq!(bench.read("back.csv"), bench.read("plain.csv"), "{mapped}");
    }
    // A table has no frames, and without the map its columns are unknown.
    assert!(bench.run("convert other.csv c.csv").refusal().contains("time_s is missing"));
    bench.write("columns.toml", "[signals]\ntime_s = \"Stemp\"\n");
    let outcome = bench.run("convert other.csv c.csv --signals columns.toml");
    assert!(outcome.refusal().contains("Stemp"), "{outcome:?}");
}

#[test]
fn frames_keep_their_bytes_and_signals_their_units() {
    let bench = bench();
    bench.run(&format!("convert drive.csv a.log {BUS}")).success();
    for line in ["convert a.log b.asc", "convert b.asc c.blf", "convert c.blf d.log"] {
        bench.run(line).success();
    }
    let frames = |name: &str| {
        let mut reader = FrameReader::open(&bench.path(name)).unwrap();
        let frames = std::iter::from_fn(|| reader.next_frame().unwrap());
        frames.map(|frame| (frame.id, frame.data().to_vec())).collect::<Vec<_>>()
    };
    // Speed, corner and reference with every row; the example's bus has a code for a missing acceleration.
    assert_eq!(frames("a.log").len(), 3 * 500);
    assert_eq!(frames("a.log"), frames("d.log"));

    bench.run("convert c.blf e.mf4 --dbc car.dbc").success();
    let reader = Mdf4Reader::open(&bench.path("e.mf4")).unwrap();
    let index = reader.groups().iter().position(|group| group.name == "ESP_Status").unwrap();
    let group = &reader.groups()[index];
    let place = group.channels.iter().position(|channel| channel.name == "VehicleSpeed").unwrap();
    assert_eq!((group.samples, group.channels[place].unit.as_str()), (Some(500), "km/h"));
    let mut cursor = reader.cursor(index, &[place]).unwrap();
    let mut value = [0.0];
    assert_eq!(cursor.next(&mut value).unwrap(), Some(0.0));
    // 20.5 m/s are 73.8 km/h, a whole number of steps of 0.01.
    assert!((value[0] - 73.8).abs() < 1e-9);
}
