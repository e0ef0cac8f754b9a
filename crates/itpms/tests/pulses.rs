//! Tooth pulses from the scenario to what is reported of the tires: all four low, from one drive to the next, and what is refused.

use serde_json::Value;

use crate::common::{Bench, table};

/// A car about 80 km/h on class B; from 1500 to 1560 s all four tires lose a quarter.
const SCENARIO: &str = r#"
name = "rolling"
duration_s = 3000
rate_hz = 50
[speed]
points_s_km_h = [[0, 70], [200, 90], [400, 70], [600, 90], [800, 70], [1000, 90], [1200, 70], [1400, 90], [1600, 70], [1800, 90], [2000, 70], [2200, 90], [2400, 70], [3000, 90]]
[road.surface.iso8608]
roughness = "B"
slope = 2.0
[car]
[wheel_speeds]
alone = true
car_seed = 5
[corner]
fl = { pressure.points_s_kpa = [[1500.0, 241.3], [1560.0, 181.0]] }
fr = { pressure.points_s_kpa = [[1500.0, 241.3], [1560.0, 181.0]] }
rl = { pressure.points_s_kpa = [[1500.0, 241.3], [1560.0, 181.0]] }
rr = { pressure.points_s_kpa = [[1500.0, 241.3], [1560.0, 181.0]] }
"#;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn all_four_are_found_by_their_pulses_in_the_drive_and_on_the_next_one() {
    let bench = Bench::new();
    bench.write("rolling.toml", SCENARIO);
    bench
        .run("lab simulate rolling.toml --seed 3 -o drive.csv --pulses-out teeth.parquet --vehicle-out car.toml")
        .success();
    let estimate = "estimate drive.csv --pulses teeth.parquet --vehicle car.toml --json";
    let first = format!("{estimate} --calibrate-s 1200 --save-reference car.reference");
    let summary = json(bench.run(&first).success());
    let alerts = summary["alerts"].as_array().unwrap();
    assert_eq!(alerts.len(), 1, "{alerts:?}");
    assert_eq!(alerts[0]["wheels"], serde_json::json!(["fl", "fr", "rl", "rr"]), "{alerts:?}");
    let reported_s = alerts[0]["reported_s"].as_f64().unwrap();
    // R141 gives an hour.
    assert!((1500.0..3000.0).contains(&reported_s), "{reported_s}");
    assert!(!summary["wheel_speeds"]["not_seen"].to_string().contains("all four"), "{summary}");
    for wheel in ["fl", "fr", "rl", "rr"] {
        let [change, sd] =
            ["change_kpa", "change_sd_kpa"].map(|key| summary["torsion"][wheel][key].as_f64().unwrap());
        // 60 kPa were lost, half an hour ago; the Hz per kPa are known to a fifth.
        assert!((change + 60.3).abs() < 2.5 * sd && sd < 20.0, "{wheel} {change} {sd}");
    }
    // The same drive with what was learned: from its beginning to its loss all is well, then all four.
    let text =
        bench.run("estimate drive.csv --pulses teeth.parquet --vehicle car.toml --reference car.reference");
    let text = text.success();
    assert!(text.contains("all four tires have lost air since the calibration"), "{text}");
    assert!(text.contains("by the tooth pulses since the calibration fl -"), "{text}");
    the_monitor_and_a_fleet_find_them_too(&bench, text, &summary);
    // Without pulses it is unknown.
    let without =
        json(bench.run("estimate drive.csv --vehicle car.toml --reference car.reference --json").success());
    assert_eq!((&without["alerts"], &without["torsion"]), (&serde_json::json!([]), &Value::Null));
}

/// The replayed log warns as the estimate of the second drive did; a fleet of both drives, with tables beside them, of each as its estimate.
fn the_monitor_and_a_fleet_find_them_too(bench: &Bench, second: &str, first: &Value) {
    #[cfg(feature = "live")]
    {
        let replay = "monitor --replay drive.csv --pulses teeth.parquet --speed max --vehicle car.toml";
        let live = bench.run(&format!("{replay} --reference car.reference --json live.jsonl"));
        live.success();
        let lines = bench.read("live.jsonl");
        let warnings: Vec<Value> = lines.lines().map(json).filter(|line| line["type"] == "warning").collect();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert_eq!(warnings[0]["event"], "begun");
        let sentence = warnings[0]["text"].as_str().unwrap_or_else(|| panic!("{warnings:?}"));
        assert!(second.contains(sentence), "{sentence:?} in {second}");
    }
    std::fs::create_dir(bench.path("logs")).unwrap();
    for name in ["1", "2"] {
        for (from, to) in [("drive.csv", "csv"), ("teeth.parquet", "pulses.parquet")] {
            std::fs::hard_link(bench.path(from), bench.path(&format!("logs/{name}.{to}"))).unwrap();
        }
    }
    let fleet = "fleet logs/* --vehicle car.toml --out out --calibrate-s 1200 --json";
    let found = json(bench.run(fleet).success());
    assert_eq!((&found["drives"], &found["failed"]), (&2.into(), &serde_json::json!([])), "{found}");
    let (head, rows) = table(&bench.read("out/fleet.csv"));
    let column = |name: &str| head.iter().position(|of| of == name).unwrap_or_else(|| panic!("no {name}"));
    let of = |row: &[String], name: &str| row[column(name)].clone();
    assert_eq!(rows.len(), 8);
    for row in &rows {
        let carried = if of(row, "file") == "logs/1.csv" { "drive" } else { "carried" };
        assert_eq!(of(row, "calibration"), carried, "{row:?}");
        assert_eq!((of(row, "state").as_str(), of(row, "concerns").as_str()), ("low", ""), "{row:?}");
    }
    let kept = bench.read("out/drives.jsonl");
    let first_alert = first["alerts"][0]["text"].as_str().unwrap();
    assert!(kept.lines().any(|line| json(line)["alerts"].to_string().contains(first_alert)), "{kept}");
    // Nothing is estimated twice, and other pulses are another drive.
    assert_eq!(json(bench.run(fleet).success())["kept"], 2);
    std::fs::remove_file(bench.path("logs/2.pulses.parquet")).unwrap();
    assert_eq!(json(bench.run(fleet).success())["kept"], 1);
    let (_, rows) = table(&bench.read("out/fleet.csv"));
    assert!(rows[4..].iter().all(|row| of(row, "state") != "low"), "{rows:?}");
}
