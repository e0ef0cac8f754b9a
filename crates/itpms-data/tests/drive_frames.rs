//! A drive written as the frames of a bus and read back: the same rows, to the resolution of the signals.
#![cfg(feature = "can")]

use std::fs;
use std::path::{Path, PathBuf};

use itpms_core::model::Corner;
use itpms_data::log::{CornerColumns, LogColumns, LogCorner, LogOptions, UnitCheck};
use itpms_data::out::{LogWriter, Packing};
use itpms_data::{LogReader, LogRow};

const DBC: &str = r#"VERSION ""
BU_: A
BO_ 288 Car: 8 A
 SG_ speed_m_s : 7|16@0+ (0.01,0) [0|300] "m/s" A
 SG_ Other : 39|16@0- (1,0) [0|0] "" A
BO_ 2147484192 Left: 8 A
 SG_ fl_body_accel_m_s2 : 0|16@1- (0.002,0) [0|0] "m/s^2" A
 SG_ fl_wheel_accel_m_s2 : 16|16@1- (0.01,0) [0|0] "m/s^2" A
BO_ 529 Right: 8 A
 SG_ fr_body_accel : 0|16@1- (0.0002,0) [0|0] "g" A
 SG_ fr_wheel_accel : 31|16@0- (0.01,5) [0|0] "m/s^2" A
"#;

fn truth() -> Vec<LogRow> {
    (0..2000)
        .map(|i| {
            let time_s = f64::from(i) / 500.0;
            let corner = |k: f64| LogCorner {
                body_accel_m_s2: 3.0 * (7.0 * time_s + k).sin(),
                wheel_accel_m_s2: 30.0 * (61.0 * time_s + k).cos(),
                pressure_kpa: 200.0 + k,
                road_m: f64::NAN,
            };
            let mut corners = [None; 4];
            corners[Corner::FrontLeft.index()] = Some(corner(0.0));
            corners[Corner::FrontRight.index()] = Some(corner(1.0));
            LogRow::without_motion(time_s, 20.0 + 0.7 * time_s, corners)
        })
        .collect()
}

fn columns() -> LogColumns {
    let truth = CornerColumns { pressure: true, road: false };
    LogColumns { speed: true, corners: [Some(truth), Some(truth), None, None], ..LogColumns::default() }
}

fn write(folder: &Path, name: &str, rows: &[LogRow]) -> (PathBuf, LogOptions, Vec<String>) {
    let (log, dbc) = (folder.join(name), folder.join("car.dbc"));
    fs::write(&dbc, DBC).unwrap();
    let options = LogOptions { dbc: Some(dbc), units: UnitCheck::Trusting, signals: None, rows: vec![] };
    let mut writer = LogWriter::create_with(&log, columns(), &options, Packing::Packed).unwrap();
    rows.iter().for_each(|row| writer.write(row).unwrap());
    let losses = writer.losses();
    writer.finish().unwrap().commit().unwrap();
    (log, options, losses)
}

#[test]
fn a_drive_goes_through_every_bus_log() {
    let folder = tempfile::tempdir().unwrap();
    let truth = truth();
    for name in ["d.log", "d.candump", "d.asc", "d.blf"] {
        let (log, options, losses) = write(folder.path(), name, &truth);
        assert_eq!(losses.len(), 3, "{losses:?}");
        assert!(losses[0].contains("fl_pressure_kpa has no signal"), "{losses:?}");
        assert!(losses[2].starts_with("Car.Other in the frames' messages"), "{losses:?}");
        let mut reader = LogReader::open_with(&log, &options).unwrap();
        assert_eq!(reader.survey().sample_rate_hz, 500.0);
        let mut count = 0;
        while let Some(row) = reader.next_row().unwrap() {
            let meant = &truth[count];
            // Stamps of a microsecond; half a step of each signal, and of the rounding of the sum.
            assert!((row.time_s - meant.time_s).abs() < 1.1e-6, "{name} {}", row.time_s);
            assert!((row.speed_m_s - meant.speed_m_s).abs() < 0.0051, "{name}");
            for (corner, body_step) in [(Corner::FrontLeft, 0.002), (Corner::FrontRight, 0.0002 * 9.806_65)] {
                let (found, meant) =
                    (row.corners[corner.index()].unwrap(), meant.corners[corner.index()].unwrap());
                assert!((found.body_accel_m_s2 - meant.body_accel_m_s2).abs() < 0.51 * body_step, "{name}");
                assert!((found.wheel_accel_m_s2 - meant.wheel_accel_m_s2).abs() < 0.0051, "{name}");
                assert!(found.pressure_kpa.is_nan());
            }
            count += 1;
        }
        assert_eq!(count, truth.len(), "{name}");
        assert_eq!(reader.repairs().warnings(), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn what_a_frame_cannot_hold_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = truth();
    let left = |row: &mut LogRow| row.corners[0].as_mut().unwrap().body_accel_m_s2 = 70.0;
    left(&mut rows[10]);
    rows[20].corners[1].as_mut().unwrap().wheel_accel_m_s2 = f64::NAN;
    let (log, options, losses) = write(folder.path(), "d.log", &rows);
    assert!(losses[3].starts_with("1 frames were left out"), "{losses:?}");
    assert!(losses[4].contains("Left.fl_body_accel_m_s2"), "{losses:?}");
    let read: Vec<LogRow> = LogReader::open_with(&log, &options).unwrap().map(Result::unwrap).collect();
    assert_eq!(read.len(), rows.len());
    assert!((read[10].corners[0].unwrap().body_accel_m_s2 - 65.534).abs() < 1e-9);
    assert!(read[20].corners[1].unwrap().wheel_accel_m_s2.is_nan());
}

#[test]
fn a_bus_log_needs_its_description() {
    let folder = tempfile::tempdir().unwrap();
    let (log, _, _) = write(folder.path(), "d.log", &truth());
    let text = LogReader::open(&log).unwrap_err().to_string();
    assert!(text.ends_with("expected a DBC file (--dbc car.dbc)"), "{text}");
    let text = LogWriter::create(&log, columns()).unwrap_err().to_string();
    assert!(text.ends_with("expected a DBC file (--dbc car.dbc)"), "{text}");
}

#[test]
#[cfg(feature = "mdf4")]
fn a_description_inside_a_bus_logging_is_used_where_none_is_given() {
    let data = |of: &str, name: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join("tests/data").join(name)
    };
    let log = data("itpms-can-log", "python_can.mf4");
    let given = data("itpms-can-log", "rich.dbc");
    let expected = itpms_data::dbc::Dbc::read(&given).unwrap();
    assert_eq!(itpms_data::frame_description(&log, None).unwrap(), expected);
    assert_eq!(
        itpms_data::frame_description(&data("itpms-can-log", "python_can.log"), Some(&given)).unwrap(),
        expected
    );
    let none =
        itpms_data::frame_description(&data("itpms-mdf4", "bus-apart.mf4"), None).unwrap_err().to_string();
    assert!(none.ends_with("expected a DBC file (--dbc car.dbc)"), "{none}");
    assert!(itpms_data::holds_frames(&log, None).unwrap());
    // Signals and no frames, whatever is given.
    assert!(!itpms_data::holds_frames(&data("itpms-mdf4", "plain.mf4"), Some(&given)).unwrap());
}
