//! The car's own tire sensors in a log: sparse in time, in steps of a kPa, witnesses and no truth.
#![cfg(feature = "can")]

use std::fmt::Write as _;

use itpms_data::LogReader;
use itpms_data::log::LogOptions;

const ROWS: u32 = 1500;
const PERIOD_S: f64 = 0.02;
/// A sensor sends with every seven seconds.
const EVERY: u32 = 350;

fn sent(k: u32) -> [u32; 4] {
    let step = k / EVERY;
    [193 - step, 186, 198, 133 + step]
}

/// The sensors' values in a log, row by row, where it has any.
fn found(log: LogReader) -> Vec<(f64, [f64; 4], [f64; 4])> {
    assert_eq!(log.columns().motion.tire_sensors, [true; 4]);
    let rows =
        log.map(Result::unwrap).map(|row| (row.time_s, row.motion.tire_sensor_kpa, row.motion.tire_sensor_c));
    rows.filter(|(_, kpa, _)| kpa.iter().any(|kpa| kpa.is_finite())).collect()
}

#[test]
fn a_bus_that_sends_them_now_and_then_gives_each_reading_once() {
    let dir = tempfile::tempdir().unwrap();
    let dbc = r#"VERSION ""
BO_ 535 WheelSpeed: 8 X
 SG_ WhlFl_W_Meas : 7|16@0+ (0.01,0) [0|655] "km/h" X
 SG_ WhlFr_W_Meas : 23|16@0+ (0.01,0) [0|655] "km/h" X
 SG_ WhlRl_W_Meas : 39|16@0+ (0.01,0) [0|655] "km/h" X
 SG_ WhlRr_W_Meas : 55|16@0+ (0.01,0) [0|655] "km/h" X
BO_ 949 TirePressure: 8 X
 SG_ TirePressFl : 15|8@0+ (1,0) [0|255] "kPa" X
 SG_ TirePressFr : 31|8@0+ (1,0) [0|255] "kPa" X
 SG_ TirePressRr : 47|8@0+ (1,0) [0|255] "kPa" X
 SG_ TirePressRl : 63|8@0+ (1,0) [0|255] "kPa" X
BO_ 950 TPMS_Temp: 8 X
 SG_ Temp_FL : 0|8@1+ (1,-40) [-40|215] "degC" X
"#;
    let mut text = String::new();
    for k in 0..ROWS {
        let time_s = f64::from(k) * PERIOD_S;
        let speed = format!("{:04X}", 6000 + k % 50);
        writeln!(text, "({time_s:.6}) can0 217#{}", speed.repeat(4)).unwrap();
        if k % EVERY == 0 {
            let [fl, fr, rl, rr] = sent(k);
            writeln!(text, "({:.6}) can0 3B5#00{fl:02X}00{fr:02X}00{rr:02X}00{rl:02X}", time_s + 0.001)
                .unwrap();
            writeln!(text, "({:.6}) can0 3B6#{:02X}00000000000000", time_s + 0.001, 40 + 25).unwrap();
        }
    }
    std::fs::write(dir.path().join("car.dbc"), dbc).unwrap();
    let path = dir.path().join("bus.log");
    std::fs::write(&path, text).unwrap();
    let options = LogOptions { dbc: Some(dir.path().join("car.dbc")), ..LogOptions::default() };
    let log = LogReader::open_with(&path, &options).unwrap();
    assert!(
        log.columns().motion.wheel_speed
            && log.columns().motion.tire_temperatures == [true, false, false, false]
    );
    let found = found(log);
    assert_eq!(found.len(), ROWS.div_ceil(EVERY) as usize, "{found:?}");
    for (n, (time_s, kpa, celsius)) in found.iter().enumerate() {
        let k = n as u32 * EVERY;
        assert_eq!(*kpa, sent(k).map(f64::from));
        assert_eq!(celsius[0], 25.0);
        // In the row after it was sent.
        assert!((time_s - f64::from(k + 1) * PERIOD_S).abs() < 1e-9, "{time_s} {k}");
    }
}

#[test]
fn a_table_has_them_in_its_rows_and_the_truth_is_another_column() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("drive.csv");
    let mut text = String::from(
        "time_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2,fl_pressure_kpa,fl_tpms_kpa,fr_tpms_kpa,rl_tpms_kpa,rr_tpms_kpa\n",
    );
    for k in 0..ROWS {
        let shake = (f64::from(k) * 0.7).sin();
        write!(text, "{},{shake},{},240.5", f64::from(k) * 0.005, 3.0 * shake).unwrap();
        match k % EVERY {
            0 => sent(k).iter().for_each(|kpa| write!(text, ",{kpa}").unwrap()),
            _ => text.push_str(",,,,"),
        }
        text.push('\n');
    }
    std::fs::write(&path, text).unwrap();
    let log = LogReader::open(&path).unwrap();
    assert!(log.columns().corners[0].unwrap().pressure);
    let found = found(log);
    let expected: Vec<[f64; 4]> = (0..ROWS).step_by(EVERY as usize).map(|k| sent(k).map(f64::from)).collect();
    assert_eq!(found.iter().map(|(_, kpa, _)| *kpa).collect::<Vec<_>>(), expected);
}
