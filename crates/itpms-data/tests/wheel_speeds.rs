//! Logs with wheel speeds alone: the same drive through every format, in makers' names and units.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use itpms_core::model::Corner;
use itpms_data::log::{Field, LogColumns, LogMotion, LogOptions, Slot};
use itpms_data::out::LogWriter;
use itpms_data::signals::{Candidate, resolve};
use itpms_data::{LogReader, LogRow};

/// Wheel by wheel, in km/h: a car that becomes faster in a slight left turn.
fn km_h(k: u32) -> [f64; 4] {
    let v = 60.0 + 0.01 * f64::from(k);
    [v - 0.5, v + 0.5, v - 0.4, v + 0.4]
}

const ROWS: u32 = 600;

fn read(path: &Path, options: &LogOptions) -> (LogColumns, Vec<LogRow>) {
    let log = LogReader::open_with(path, options).unwrap();
    let columns = *log.columns();
    (columns, log.map(Result::unwrap).collect())
}

fn expect(rows: &[LogRow], within_m_s: f64) {
    assert!(rows.len() + 8 > ROWS as usize, "{}", rows.len());
    for row in rows {
        let k = (row.time_s / 0.012).round();
        let sample = row.motion.sample(row.time_s, 0.3);
        for (found, expected) in sample.wheel_speed_m_s.iter().zip(km_h(k as u32)) {
            assert!((found - expected / 3.6).abs() < within_m_s, "{found} {expected} at {}", row.time_s);
        }
    }
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn table(header: &str, per_km_h: f64) -> String {
    let mut text = format!("{header}\n");
    for k in 0..ROWS {
        let [fl, fr, rl, rr] = km_h(k).map(|v| v * per_km_h);
        writeln!(text, "{},{fl},{fr},{rl},{rr}", f64::from(k) * 0.012).unwrap();
    }
    text
}

#[test]
fn a_table_of_wheel_speeds_is_a_log_in_our_names_and_in_makers() {
    let dir = tempfile::tempdir().unwrap();
    let ours = ["fl", "fr", "rl", "rr"].map(|c| format!("{c}_wheel_speed_m_s")).join(",");
    let makers =
        "time_s,WHEEL_SPEED_FL [km/h],WHEEL_SPEED_FR [km/h],WHEEL_SPEED_RL [km/h],WHEEL_SPEED_RR [km/h]";
    // As data loggers of motor sports export them, and the fields of messages.
    let logger = "\"Format\",\"AiM CSV File\"\n\"Sample Rate\",\"83\"\n\"Segment Times\",\"0:54.0\",\"1:10\"\n\n\
                  \"Time\",\"Wheel Speed FL\",\"Wheel Speed FR\",\"Wheel Speed RL\",\"Wheel Speed RR\"\n\
                  \"s\",\"km/h\",\"km/h\",\"km/h\",\"km/h\"\n";
    let fields =
        ["fl", "fr", "rl", "rr"].map(|corner| format!("carState.wheelSpeeds.{corner} [m/s]")).join(",");
    for (name, header, per_km_h) in [
        ("ours.csv", format!("time_s,{ours}"), 1.0 / 3.6),
        ("makers.csv", makers.to_owned(), 1.0),
        ("logger.csv", logger.to_owned(), 1.0),
        ("fields.csv", format!("t,{fields}"), 1.0 / 3.6),
    ] {
        let path = written(dir.path(), name, &table(&header, per_km_h));
        let (columns, rows) = read(&path, &LogOptions::default());
        assert!(columns.motion.wheel_speed && columns.present().is_empty());
        expect(&rows, 1e-9);
    }
    // Wheels of .3 m turn by 1 / .3 rad per m, and 30 / pi rpm are a rad/s.
    let rpm = 30.0 / std::f64::consts::PI / 0.3 / 3.6;
    let header = "time_s,WhlFl_W_Meas (rpm),WhlFr_W_Meas (rpm),WhlRl_W_Meas (rpm),WhlRr_W_Meas (rpm)";
    let path = written(dir.path(), "turns.csv", &table(header, rpm));
    let (columns, rows) = read(&path, &LogOptions::default());
    assert!(columns.motion.wheel_rotation && !columns.motion.wheel_speed);
    expect(&rows, 1e-9);
}

#[test]
fn what_cannot_be_a_log_of_wheel_speeds_is_refused_by_what_is_missing() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |header: &str, per_km_h: f64| {
        let path = written(dir.path(), "bad.csv", &table(header, per_km_h));
        LogReader::open(&path).map(drop).unwrap_err().to_string()
    };
    // Without a unit it could be either; the column is that of a wheel's speed, not an acceleration.
    let text = refused("time_s,WHEEL_SPEED_FL,WHEEL_SPEED_FR,WHEEL_SPEED_RL,WHEEL_SPEED_RR", 1.0);
    assert!(
        text.ends_with("column fl_wheel_speed_m_s is missing; the nearest name there is WHEEL_SPEED_FL"),
        "{text}"
    );
    let ours = ["fl", "fr", "rl", "rr"].map(|c| format!("{c}_wheel_speed_m_s"));
    let fast = refused(&format!("time_s,{}", ours.join(",")), 2.0);
    assert!(fast.contains("wheel speeds in km/h") && fast.contains("expected m/s"), "{fast}");
    let three = refused(&format!("time_s,{},gear", ours[..3].join(",")), 0.2);
    assert!(three.ends_with("column rr_wheel_speed_m_s is missing"), "{three}");
}

#[test]
fn every_format_that_is_written_reads_back() {
    let dir = tempfile::tempdir().unwrap();
    let slots: Vec<Slot> = Slot::all().filter(|slot| !slot.name().contains("accel_m_s2")).collect();
    let columns = LogColumns::of(&slots);
    let row = |k: u32| {
        let motion = LogMotion {
            wheel_speed_m_s: km_h(k).map(|v| v / 3.6),
            yaw_rate_rad_s: 1e-3 * f64::from(k % 7),
            accel_x_m_s2: 0.25,
            accel_y_m_s2: -0.125,
            brake: f64::from(k % 2),
            ..LogMotion::UNKNOWN
        };
        LogRow { time_s: f64::from(k) * 0.012, speed_m_s: 16.0, corners: [None; 4], motion }
    };
    for name in ["drive.csv", "drive.parquet", "drive.mf4"] {
        let path = dir.path().join(name);
        let mut writer = LogWriter::create(&path, columns).unwrap();
        (0..ROWS).for_each(|k| writer.write(&row(k)).unwrap());
        writer.finish().unwrap().commit().unwrap();
        let (read_columns, rows) = read(&path, &LogOptions::default());
        assert!(read_columns.motion.wheel_speed && read_columns.motion.brake, "{name}");
        expect(&rows, 1e-9);
        let last = rows.last().unwrap();
        let k = (last.time_s / 0.012).round() as u32;
        assert_eq!(last.motion.brake, row(k).motion.brake, "{name}");
        assert_eq!(last.motion.yaw_rate_rad_s, row(k).motion.yaw_rate_rad_s, "{name}");
        assert_eq!((last.motion.accel_x_m_s2, last.motion.accel_y_m_s2), (0.25, -0.125), "{name}");
    }
}

const DBC: &str = r#"VERSION ""
BO_ 170 WHEEL_SPEEDS: 8 XXX
 SG_ WHEEL_SPEED_FR : 7|16@0+ (0.01,-67.67) [0|250] "kph" XXX
 SG_ WHEEL_SPEED_FL : 23|16@0+ (0.01,-67.67) [0|250] "kph" XXX
BO_ 171 WHEEL_SPEEDS_REAR: 8 XXX
 SG_ WHEEL_SPEED_RR : 7|16@0+ (0.01,-67.67) [0|250] "kph" XXX
 SG_ WHEEL_SPEED_RL : 23|16@0+ (0.01,-67.67) [0|250] "kph" XXX
BO_ 36 KINEMATICS: 8 XXX
 SG_ YAW_RATE : 1|10@0+ (0.25,-128) [0|250] "deg/sec" XXX
"#;

#[test]
fn frames_of_a_bus_become_rows_at_the_wheels_pace() {
    let dir = tempfile::tempdir().unwrap();
    let dbc = written(dir.path(), "car.dbc", DBC);
    let mut text = String::new();
    let big_endian = |km_h: f64| format!("{:04X}", ((km_h + 67.67) / 0.01).round() as u16);
    for k in 0..ROWS {
        let time_s = f64::from(k) * 0.012;
        let [fl, fr, rl, rr] = km_h(k);
        writeln!(text, "({time_s:.6}) can0 0AA#{}{}00000000", big_endian(fr), big_endian(fl)).unwrap();
        // The rear's message comes 4 ms later: what it shows is by then a third of a step on.
        let [rl, rr] = [rl, rr].map(|v| v + 0.01 / 3.0);
        writeln!(text, "({:.6}) can0 0AB#{}{}00000000", time_s + 0.004, big_endian(rr), big_endian(rl))
            .unwrap();
        if k % 2 == 0 {
            // 512 is -128 + .25 * 512 = 0 deg/s, four more are 1 deg/s.
            writeln!(text, "({:.6}) can0 024#0204000000000000", time_s + 0.001).unwrap();
        }
    }
    let path = written(dir.path(), "bus.log", &text);
    let options = LogOptions { dbc: Some(dbc), ..LogOptions::default() };
    let (columns, rows) = read(&path, &options);
    assert!(columns.motion.wheel_speed && columns.motion.yaw_rate);
    // Half a step of .01 km/h of each reading.
    expect(&rows[2..], 0.0075 / 3.6);
    let yaw = rows[100].motion.yaw_rate_rad_s;
    assert!((yaw - 0.017_453_292_519_943).abs() < 1e-12, "{yaw}");
}

#[test]
fn an_acceleration_is_nothing_like_a_wheel_speed() {
    let candidates: Vec<Candidate> = Corner::ALL
        .into_iter()
        .map(|corner| Candidate {
            group: "WHL_SPD11".to_owned(),
            name: format!("WHL_SPD_{}", corner.label().to_uppercase()),
            unit: "km/h".to_owned(),
        })
        .collect();
    let resolved = resolve(&candidates, None).unwrap();
    assert_eq!(resolved.unusable(), None);
    assert_eq!(resolved.slots(), Corner::ALL.map(|corner| Slot::Corner(corner, Field::WheelSpeed)));
    // Three are of no use, and what is missing is reported.
    let resolved = resolve(&candidates[..3], None).unwrap();
    assert!(resolved.unusable().unwrap().contains("the speeds of four wheels"));
    assert!(
        resolved.assumptions().iter().any(|line| line.ends_with("missing: rr")),
        "{:?}",
        resolved.assumptions()
    );
}
