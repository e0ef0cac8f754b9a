//! A truck's bus (SAE J1939): wheel speeds as differences from the front axle's (EBC2) or one by one (HRW), and tires by their location (TIRE).
#![cfg(feature = "can")]

use std::fmt::Write as _;

use itpms_data::LogRow;
use itpms_data::log::LogOptions;

use crate::common::{Bench, found};

const EBC2: &str = r#"
BO_ 2566832126 EBC2: 8 X
 SG_ FrontAxleSpeed : 0|16@1+ (0.00390625,0) [0|250.996] "km/h" X
 SG_ RelativeSpeedFrontAxleLeftWheel : 16|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedFrontAxleRightWheel : 24|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedRearAxle1LeftWheel : 32|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedRearAxle1RightWheel : 40|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedRearAxle2LeftWheel : 48|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedRearAxle2RightWheel : 56|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
"#;
const HRW: &str = r#"
BO_ 2566811390 HRW: 8 X
 SG_ FrontAxleLeftWheelSpeed : 0|16@1+ (0.00390625,0) [0|250.996] "km/h" X
 SG_ FrontAxleRightWheelSpeed : 16|16@1+ (0.00390625,0) [0|250.996] "km/h" X
 SG_ RearAxleLeftWheelSpeed : 32|16@1+ (0.00390625,0) [0|250.996] "km/h" X
 SG_ RearAxleRightWheelSpeed : 48|16@1+ (0.00390625,0) [0|250.996] "km/h" X
"#;
const REST: &str = r#"
BO_ 2566844926 CCVS1: 8 X
 SG_ WheelBasedVehicleSpeed : 8|16@1+ (0.00390625,0) [0|250.996] "km/h" X
BO_ 2566845694 TIRE: 8 X
 SG_ TireLocation : 0|8@1+ (1,0) [0|250] "" X
 SG_ TirePressure : 8|8@1+ (4,0) [0|1000] "kPa" X
 SG_ TireTemperature : 16|16@1+ (0.03125,-273) [-273|1734.97] "degC" X
 SG_ TireStatus : 34|2@1+ (1,0) [0|3] "" X
BO_ 2566843134 VW: 8 X
 SG_ AxleLocation : 0|8@1+ (1,0) [0|250] "" X
 SG_ AxleWeight : 8|16@1+ (0.5,0) [0|32127.5] "kg" X
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_DEF_ "ProtocolType" STRING;
BA_ "ProtocolType" "J1939";
"#;
const ROWS: u32 = 900;
/// Steps of the two resolutions in km/h.
const FINE: f64 = 1.0 / 256.0;
const COARSE: f64 = 1.0 / 16.0;

/// Speeds of the front axle and of the wheels in km/h.
fn truth(k: u32) -> (f64, [f64; 4]) {
    let axle = 62.0 + 8.0 * (f64::from(k) * 0.01).sin();
    (axle, [0.31, -0.31, 0.77, -1.40].map(|apart| axle + apart + 0.5 * (f64::from(k) * 0.03).cos()))
}

fn ebc2(k: u32, third_axle: bool) -> [u8; 8] {
    let (axle, wheels) = truth(k);
    let sent = ((axle / FINE).round() as u16).to_le_bytes();
    let apart = wheels.map(|wheel| ((wheel - axle + 7.8125) / COARSE).round() as u8);
    let third = if third_axle { 125 } else { 0xFF };
    [sent[0], sent[1], apart[0], apart[1], apart[2], apart[3], third, third]
}

fn hrw(k: u32) -> [u8; 8] {
    let raw = truth(k).1.map(|wheel| ((wheel / FINE).round() as u16).to_le_bytes());
    std::array::from_fn(|place| raw[place / 2][place % 2])
}

/// A log with the frames of every tenth of a second: identifier and data.
fn log(mut frames: impl FnMut(u32) -> Vec<(u32, [u8; 8])>) -> String {
    let mut text = String::new();
    for k in 0..ROWS {
        let speed = ((truth(k).0 / FINE).round() as u16).to_le_bytes();
        let ccvs = (0x18FE_F100, [0xFF, speed[0], speed[1], 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]);
        for (place, (id, data)) in frames(k).into_iter().chain([ccvs]).enumerate() {
            let time_s = 0.1 * f64::from(k) + 1e-4 * place as f64;
            let data = data.iter().fold(String::new(), |text, byte| format!("{text}{byte:02X}"));
            writeln!(text, "({time_s:.6}) can0 {id:08X}#{data}").unwrap();
        }
    }
    text
}

/// Its rows, what was repaired, and which signal became what.
fn read(dbc: &str, log: &str) -> (Vec<LogRow>, String, String) {
    let bench = Bench::new();
    let options = LogOptions { dbc: Some(bench.write("truck.dbc", dbc)), ..LogOptions::default() };
    let found = found(&bench.write("truck.log", log), &options).unwrap();
    (found.rows, found.warnings.join("\n"), found.mapping.join("\n"))
}

fn compare(rows: &[LogRow], most_kmh: f64) {
    assert!(rows.len() > ROWS as usize - 20, "{}", rows.len());
    let mut known = 0;
    for row in rows {
        // Values of a message are one row at their own time.
        let wheels = truth((row.time_s / 0.1).round() as u32).1;
        for (found, wheel) in row.motion.wheel_speed_m_s.iter().zip(wheels) {
            if found.is_finite() {
                assert!((3.6 * found - wheel).abs() <= most_kmh, "{} {found} {wheel}", row.time_s);
                known += 1;
            }
        }
    }
    assert!(known > 3 * ROWS, "{known}");
}

#[test]
fn differences_from_the_front_axle_are_four_wheel_speeds() {
    let dbc = format!("{EBC2}{REST}");
    let (rows, repairs, mapping) = read(&dbc, &log(|k| vec![(0x18FE_BF0B, ebc2(k, false))]));
    // Half a step of either.
    compare(&rows, 0.5 * (FINE + COARSE) + 1e-9);
    assert!(mapping.contains("RelativeSpeedRearAxle1LeftWheel + FrontAxleSpeed"), "{mapping}");
    assert!(!repairs.contains("third axle"), "{repairs}");
    let speeds = rows.iter().filter(|row| row.speed_m_s.is_finite()).count();
    assert!(speeds > rows.len() / 2, "the vehicle's speed is based on its wheels'");

    let (rows, repairs, _) = read(&dbc, &log(|k| vec![(0x18FE_BF0B, ebc2(k, true))]));
    compare(&rows, 0.5 * (FINE + COARSE) + 1e-9);
    assert!(repairs.contains("900 frames have wheels or tires of a third axle"), "{repairs}");
}

#[test]
fn speeds_that_are_sent_one_by_one_come_before_differences() {
    let dbc = format!("{EBC2}{HRW}{REST}");
    let both = |k| vec![(0x18FE_BF0B, ebc2(k, false)), (0x0CFE_6E0B, hrw(k))];
    compare(&read(&dbc, &log(both)).0, 0.5 * FINE + 1e-9);
    // Described, but not sent.
    compare(&read(&dbc, &log(|k| vec![(0x18FE_BF0B, ebc2(k, false))])).0, 0.5 * (FINE + COARSE) + 1e-9);
}

#[test]
fn what_is_not_available_or_wrong_is_no_speed() {
    let dbc = format!("{EBC2}{REST}");
    let frames = |k: u32| {
        let mut data = ebc2(k, false);
        match k % 10 {
            1 => (data[0], data[1]) = (0xFF, 0xFF),
            2 => data[3] = 0xFE,
            _ => {}
        }
        vec![(0x18FE_BF0B, data)]
    };
    let (rows, repairs, _) = read(&dbc, &log(frames));
    // 0xFFFF would be 256 km/h, 0xFE 8 more than the axle; what is missing for two samples may be interpolated.
    compare(&rows, 0.2);
    assert!(repairs.contains("values were sent as not available"), "{repairs}");
}

/// The tires of these locations in turn, one every half a second.
fn tires(k: u32, locations: &[u8]) -> Vec<(u32, [u8; 8])> {
    let mut frames = vec![(0x18FE_BF0B, ebc2(k, false))];
    if k.is_multiple_of(5) {
        let location = locations[(k / 5) as usize % locations.len()];
        let (pressure, [low, high]) = (180u8.wrapping_add(location), 9984u16.to_le_bytes());
        frames.push((0x18FE_F433, [location, pressure, low, high, 0xFF, 0xFF, 0xFF, 0xFF]));
    }
    frames
}

fn last(rows: &[LogRow]) -> [f64; 4] {
    [0, 1, 2, 3].map(|wheel| {
        let mut sent = rows.iter().map(|row| row.motion.tire_sensor_kpa[wheel]);
        sent.rfind(|kpa| kpa.is_finite()).unwrap_or(f64::NAN)
    })
}

#[test]
fn a_tire_is_where_its_location_says() {
    let dbc = format!("{EBC2}{REST}");
    let (rows, repairs, _) = read(&dbc, &log(|k| tires(k, &[0x00, 0x01, 0x10, 0x11])));
    assert_eq!(last(&rows), [720.0, 724.0, 784.0, 788.0]);
    let warm = rows.iter().find_map(|row| Some(row.motion.tire_sensor_c[2]).filter(|c| c.is_finite()));
    assert_eq!(warm, Some(39.0));
    assert!(!repairs.contains("third axle"), "{repairs}");
}

#[test]
fn two_tires_on_a_side_and_a_third_axle_are_left_out_and_counted() {
    let dbc = format!("{EBC2}{REST}");
    let dual = [0x00, 0x01, 0x10, 0x11, 0x12, 0x13, 0x20, 0x21];
    let (rows, repairs, _) = read(&dbc, &log(|k| tires(k, &dual)));
    let found = last(&rows);
    assert_eq!(found[..2], [720.0, 724.0]);
    assert!(found[2..].iter().all(|kpa| kpa.is_nan()), "{found:?}");
    assert!(repairs.contains("two tires on a side, which are not read"), "{repairs}");
    let (rows, _, _) = read(&dbc, &log(|k| tires(k, &[0xFF, 0x00])));
    assert_eq!(last(&rows)[0], 720.0);
}

#[test]
fn axle_loads_are_where_their_location_says() {
    let frames = |k: u32| {
        let (axle, [low, high]) = ((k % 3) as u8, (10_000 + 2_000 * (k % 3) as u16).to_le_bytes());
        vec![
            (0x18FE_BF0B, ebc2(k, false)),
            (0x18FE_EA2F, [axle << 4, low, high, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),
        ]
    };
    let (rows, repairs, _) = read(&format!("{EBC2}{REST}"), &log(frames));
    let last = |axle: usize| rows.iter().map(|row| row.motion.axle_kg[axle]).rfind(|kg| kg.is_finite());
    assert_eq!([last(0), last(1)], [Some(5000.0), Some(6000.0)]);
    assert!(repairs.contains("300 frames have wheels or tires of a third axle"), "{repairs}");
}
