//! A truck's bus from outside (SAE J1939): wheel speeds of EBC2 and tire sensors of TIRE into events, summary and report.

use std::fmt::Write as _;

use serde_json::Value;

use crate::common::{Bench, table};

const DBC: &str = r#"
BO_ 2566832126 EBC2: 8 X
 SG_ FrontAxleSpeed : 0|16@1+ (0.00390625,0) [0|250.996] "km/h" X
 SG_ RelativeSpeedFrontAxleLeftWheel : 16|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedFrontAxleRightWheel : 24|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedRearAxle1LeftWheel : 32|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
 SG_ RelativeSpeedRearAxle1RightWheel : 40|8@1+ (0.0625,-7.8125) [-7.8125|7.8125] "km/h" X
BO_ 2565868030 VDC2: 8 X
 SG_ YawRate : 24|16@1+ (0.0001220703125,-3.92) [-3.92|3.92] "rad/s" X
BO_ 2566845694 TIRE: 8 X
 SG_ TireLocation : 0|8@1+ (1,0) [0|250] "" X
 SG_ TirePressure : 8|8@1+ (4,0) [0|1000] "kPa" X
 SG_ TireTemperature : 16|16@1+ (0.03125,-273) [-273|1734.97] "degC" X
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_DEF_ "ProtocolType" STRING;
BA_ "ProtocolType" "J1939";
"#;
const SECONDS: f64 = 1500.0;
const PLACARD_KPA: f64 = 241.3;

/// How much a tire has warmed up after `time_s`, in K, and its pressure of `cold_kpa`.
fn warm_k(time_s: f64) -> f64 {
    18.0 * (1.0 - (-time_s / 600.0).exp())
}

fn warm_kpa(cold_kpa: f64, time_s: f64) -> f64 {
    (cold_kpa + 101.3) * (293.15 + warm_k(time_s)) / 293.15 - 101.3
}

/// A drive whose front left tire loses this share from 400 s on to its end, as candump has it; its sensor says what `sent` makes of time and truth.
fn drive(bench: &Bench, lost: f64, sent: impl Fn(f64, f64) -> f64) {
    let scenario = format!(
        "name = \"truck\"\nduration_s = {SECONDS}\nrate_hz = 50\n[speed]\npoints_s_km_h = [[0, 70], [200, 85], [400, 72], [600, 84], [800, 70], [1000, 85], [1200, 70], [1400, 80]]\n\
         [road.surface.iso8608]\nroughness = \"A\"\nslope = 2.0\n[car]\n[wheel_speeds]\nalone = true\ncar_seed = 7\n[corner]\n\
         fl = {{ pressure.points_s_kpa = [[0, {PLACARD_KPA}], [400, {PLACARD_KPA}], [{SECONDS}, {}]] }}\n\
         fr = {{ pressure.constant_kpa = {PLACARD_KPA} }}\nrl = {{ pressure.constant_kpa = {PLACARD_KPA} }}\nrr = {{ pressure.constant_kpa = {PLACARD_KPA} }}\n",
        PLACARD_KPA * (1.0 - lost)
    );
    bench.write("truck.toml", scenario);
    bench.run("lab simulate truck.toml --seed 11 -o raw.csv --vehicle-out car.toml").success();
    let (head, rows) = table(&bench.read("raw.csv"));
    let column = |name: &str| head.iter().position(|of| of == name).unwrap();
    let wheels = ["fl", "fr", "rl", "rr"].map(|corner| column(&format!("{corner}_wheel_speed_m_s")));
    let yaw_rate = column("yaw_rate_rad_s");
    let mut log = String::new();
    for (number, row) in rows.iter().enumerate().filter(|(number, _)| number % 5 == 0) {
        let time_s: f64 = row[0].parse().unwrap();
        let kmh = wheels.map(|place| 3.6 * row[place].parse::<f64>().unwrap_or(f64::NAN));
        if kmh.iter().any(|speed| speed.is_nan()) {
            continue;
        }
        let axle = ((kmh[0] + kmh[1]) * 128.0).round();
        let [low, high] = (axle as u16).to_le_bytes();
        let apart = kmh.map(|speed| ((speed - axle / 256.0 + 7.8125) * 16.0).round() as u8);
        let [a, b, c, d] = apart;
        writeln!(log, "({time_s:.6}) can0 18FEBF0B#{low:02X}{high:02X}{a:02X}{b:02X}{c:02X}{d:02X}FFFF")
            .unwrap();
        let yaw = row[yaw_rate].parse::<f64>().unwrap_or(f64::NAN);
        let [low, high] = (((yaw + 3.92) * 8192.0).round() as u16).to_le_bytes();
        writeln!(log, "({:.6}) can0 18F0090B#FFFFFF{low:02X}{high:02X}FFFFFF", time_s + 0.002).unwrap();
        // A tire every 2.5 s.
        if number % 125 == 0 {
            let place = number / 125 % 4;
            let cold = if place == 0 {
                PLACARD_KPA * (1.0 - lost * ((time_s - 400.0) / (SECONDS - 400.0)).max(0.0))
            } else {
                PLACARD_KPA
            };
            let truth = warm_kpa(cold, time_s);
            let kpa = if place == 0 { sent(time_s, truth) } else { truth };
            let [low, high] = (((20.0 + warm_k(time_s) + 273.0) * 32.0) as u16).to_le_bytes();
            let (location, raw) = ([0x00, 0x01, 0x10, 0x11][place], (kpa / 4.0).round() as u8);
            writeln!(
                log,
                "({:.6}) can0 18FEF433#{location:02X}{raw:02X}{low:02X}{high:02X}FFFFFFFF",
                time_s + 0.01
            )
            .unwrap();
        }
    }
    bench.write("truck.log", log);
    bench.write("truck.dbc", DBC);
}

/// The summary, the kinds of events of tire sensors and the report.
fn estimate(bench: &Bench) -> (Value, Vec<String>, String) {
    let line = "estimate truck.log --dbc truck.dbc --vehicle car.toml --calibrate-s 300 --pressure-kpa 241.3 --events events.jsonl --report truck.html --json";
    let summary = bench.json(line);
    let events = bench.read("events.jsonl");
    let kinds = events.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let kinds = kinds
        .map(|event| format!("{} {}", event["kind"].as_str().unwrap(), event["wheels"][0].as_str().unwrap()));
    (summary, kinds.filter(|kind| kind.starts_with("tire-sensor")).collect(), bench.read("truck.html"))
}

fn state<'a>(summary: &'a Value, corner: &str) -> &'a str {
    summary["tire_sensors"][corner]["state"].as_str().unwrap()
}

#[test]
fn healthy_sensors_are_fine() {
    let bench = Bench::new();
    drive(&bench, 0.0, |_, truth| truth);
    let (summary, kinds, _) = estimate(&bench);
    assert!(kinds.is_empty(), "{kinds:?} {}", summary["tire_sensors"]);
    for corner in ["fl", "fr", "rl", "rr"] {
        assert_eq!(state(&summary, corner), "fine", "{}", summary["tire_sensors"]);
    }
}

#[test]
fn a_sensor_that_sees_a_leak_is_believed() {
    let bench = Bench::new();
    drive(&bench, 0.12, |_, truth| truth);
    let (summary, kinds, page) = estimate(&bench);
    assert_eq!(kinds, ["tire-sensor-leak fl"], "{}", summary["tire_sensors"]);
    // A line through what was lost from 400 s on alone is steeper than the loss over all.
    let lost = summary["tire_sensors"]["fl"]["lost_kpa"].as_f64().unwrap();
    assert!((lost - 0.12 * PLACARD_KPA).abs() < 10.0, "{lost}");
    assert!(page.contains("by its own sensor the tire has lost"));
    // The live monitor finds the same, warns of it, and no longer calls all tires fine.
    bench.run("monitor --replay truck.log --speed max --dbc truck.dbc --vehicle car.toml --calibrate-s 300 --json live.jsonl").success();
    let live = bench.read("live.jsonl");
    let lines: Vec<Value> = live.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let warned = lines.iter().filter(|line| line["kind"] == "tire-sensor-leak");
    assert_eq!(warned.map(|line| line["wheels"][0].as_str().unwrap()).collect::<Vec<_>>(), ["fl"]);
    let last = lines.last().unwrap();
    assert_eq!(last["tire_sensors"], summary["tire_sensors"]);
    assert!(last["alerts"].as_array().unwrap().iter().any(|alert| alert["kind"] == "tire-sensor-leak"));
}

#[test]
fn a_sensor_that_drifts_is_named() {
    let bench = Bench::new();
    drive(&bench, 0.0, |time_s, truth| truth - 140.0 * (time_s / SECONDS));
    let (summary, kinds, page) = estimate(&bench);
    assert_eq!(kinds.last().unwrap(), "tire-sensor-drift fl", "{kinds:?} {}", summary["tire_sensors"]);
    assert_eq!([state(&summary, "fl"), state(&summary, "rr")], ["drift", "fine"]);
    assert!(page.contains("the tire&#39;s own sensor drifts") || page.contains("own sensor drifts"));
}

#[test]
fn a_sensor_that_rises_hides_no_leak() {
    let bench = Bench::new();
    drive(&bench, 0.0, |time_s, truth| truth + 40.0 * (time_s / SECONDS));
    let (summary, kinds, page) = estimate(&bench);
    assert_eq!(kinds, ["tire-sensor-drift fl"], "{}", summary["tire_sensors"]);
    assert!(page.contains("a tire gains no air while it rolls"));
}

#[test]
fn a_sensor_that_is_stuck_while_its_tire_loses_air_is_named() {
    let bench = Bench::new();
    drive(&bench, 0.45, |_, _| PLACARD_KPA);
    let (summary, kinds, _) = estimate(&bench);
    assert_eq!(kinds, ["tire-sensor-stuck fl"], "{}", summary["tire_sensors"]);
    assert_eq!(state(&summary, "fl"), "stuck");
    let alerts = summary["alerts"].to_string();
    assert!(alerts.contains("differs"), "{alerts}");
}

/// A car with accelerations: its estimate knows a change to a few kPa.
#[test]
fn accelerations_tell_a_drift_of_a_few_steps() {
    let bench = Bench::new();
    let corners: String = ["fl", "fr", "rl", "rr"]
        .map(|corner| format!("[corner.{corner}]\npressure.constant_kpa = 241.3\n"))
        .concat();
    bench.write(
        "car.scenario.toml",
        format!("name = \"drift\"\nduration_s = 480.0\nrate_hz = 200.0\nwheelbase_m = 2.7\n[speed]\nconstant_km_h = 90.0\n[road.surface.iso8608]\nroughness = \"B\"\nslope = 2.0\n[sensor]\nnoise_m_s2 = 0.05\n{corners}"),
    );
    bench.run("simulate car.scenario.toml --seed 5 -o drive.csv --vehicle-out car.toml").success();
    // Three sensors are right, in steps of 2.5 kPa, one drifts by 40 kPa.
    bench.edit_drive(|line, cells| {
        for (place, corner) in ["fl", "fr", "rl", "rr"].into_iter().enumerate() {
            let drift = if place == 3 { 40.0 * line as f64 / 96_000.0 } else { 0.0 };
            cells.push(match line {
                1 => format!("{corner}_tpms_kpa"),
                _ if line % 2000 == 2 + 7 * place => format!("{}", 2.5 * ((241.3 + drift) / 2.5).round()),
                _ => String::new(),
            });
        }
    });
    let line = "estimate drive.csv --vehicle car.toml --calibrate-s 60 --json";
    let summary: Value = bench.json(line);
    assert_eq!(
        ["fl", "fr", "rl", "rr"].map(|corner| state(&summary, corner)),
        ["fine", "fine", "fine", "drift"],
        "{}",
        summary["tire_sensors"]
    );
}
