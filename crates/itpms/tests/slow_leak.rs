//! A tire that leaks over weeks: no day shows it, and the days together do.

use serde_json::Value;

use crate::common::Bench;

/// A car on a motorway, the same one every day; its front left tire has lost 1.1 % a day.
const SCENARIO: &str = r#"
name = "rolling"
duration_s = DURATION
rate_hz = 50
[speed]
points_s_km_h = [[0, 70], [100, 90], [200, 70], [300, 90], [400, 70]]
[road.surface.iso8608]
roughness = "A"
slope = 2.0
[car]
[wheel_speeds]
alone = true
car_seed = 7
[corner]
fl = { pressure.constant_kpa = PRESSURE }
fr = { pressure.constant_kpa = 241.3 }
rl = { pressure.constant_kpa = 241.3 }
rr = { pressure.constant_kpa = 241.3 }
"#;
const LEAK_PER_DAY: f64 = 0.011;
const DAYS: [u32; 8] = [4, 8, 12, 16, 20, 24, 28, 32];
const FLEET: &str = "--quiet fleet logs/*.csv --vehicle car.toml --out out --calibrate-s 400";

/// The drive of a day, with its date or without.
fn drive(bench: &Bench, name: &str, day: u32, dated: bool) {
    let duration_s = if day == 0 { 400 } else { 200 };
    let pressure_kpa = 241.3 * (1.0 - LEAK_PER_DAY).powi(i32::try_from(day).unwrap());
    let scenario = SCENARIO.replace("DURATION", &duration_s.to_string());
    bench.write("scenario.toml", scenario.replace("PRESSURE", &format!("{pressure_kpa:.2}")));
    let line = format!(
        "lab simulate scenario.toml --seed {} -o raw.csv --no-truth --vehicle-out car.toml",
        10 + day
    );
    bench.run(&line).success();
    let raw = bench.read("raw.csv");
    let began_s = if dated { 1.7e9 + 86_400.0 * f64::from(day) } else { 0.0 };
    let mut log = String::new();
    for (number, line) in raw.lines().enumerate() {
        let (time, rest) = line.split_once(',').unwrap();
        let time = match number {
            0 => time.to_owned(),
            _ => format!("{:.3}", began_s + time.parse::<f64>().unwrap()),
        };
        log += &format!("{time},{rest}\n");
    }
    bench.write(name, log);
}

#[test]
fn days_name_a_slow_leak_that_no_day_shows() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("logs")).unwrap();
    drive(&bench, "logs/day00.csv", 0, true);
    bench
        .run("estimate logs/day00.csv --vehicle car.toml --calibrate-s 400 --save-reference car.reference")
        .success();
    // The day is the log's.
    let taught = bench.read("car.reference");
    assert!(taught.starts_with("itpms-reference 6 ") && taught.contains("2023-11-14"), "{taught}");
    let each_day = |log: &str| {
        bench.run(&format!(
            "estimate {log} --vehicle car.toml --reference car.reference --save-reference car.reference --json"
        ))
    };
    let mut named = Vec::new();
    for day in DAYS {
        let name = format!("logs/day{day:02}.csv");
        drive(&bench, &name, day, true);
        let alone =
            bench.run(&format!("estimate {name} --vehicle car.toml --reference car.reference --json"));
        let outcome = each_day(&name);
        let summary: Value = serde_json::from_str(outcome.success()).unwrap();
        let alerts = summary["alerts"].as_array().unwrap();
        // The file counts for nothing before it has the days.
        assert_eq!(
            alerts.len(),
            serde_json::from_str::<Value>(alone.success()).unwrap()["alerts"].as_array().unwrap().len()
        );
        for alert in alerts {
            assert_eq!((&alert["kind"], &alert["wheels"]), (&"slow-leak".into(), &serde_json::json!(["fl"])));
            assert!(alert["probability"].as_f64().unwrap() > 0.99, "{alert}");
            let of = |key: &str| alert[key].as_f64().unwrap();
            let (rate, sd) = (of("lost_share_per_day"), of("lost_sd_share_per_day"));
            assert!((rate - LEAK_PER_DAY).abs() < 2.0 * sd && sd < 0.011, "{alert}");
            assert_eq!(summary["wheel_speeds"]["wheels"]["fl"]["state"], "low");
            named.push(day);
        }
    }
    assert!(bench.read("car.reference").starts_with("itpms-reference 7 "));
    assert!(!named.is_empty() && named.contains(&32), "{named:?}");
    // The same day again is no other day, and nothing else is in the folder.
    let before = bench.read("car.reference");
    each_day("logs/day32.csv").success();
    assert_eq!(bench.read("car.reference"), before);
    assert_eq!(bench.names(), ["car.reference", "car.toml", "logs", "raw.csv", "scenario.toml"]);
    // A drive without a date is no day, and is reported.
    drive(&bench, "undated.csv", 30, false);
    let outcome = each_day("undated.csv");
    assert!(
        outcome.code == Some(2) && outcome.stderr.contains("the drive has no date"),
        "{}",
        outcome.stderr
    );
    assert_eq!(bench.read("car.reference"), before);

    // A fleet finds the same, whatever is estimated first.
    bench.run(FLEET).success();
    let of_day = |day: u32| {
        let name = format!("logs/day{day:02}.csv,");
        let table = bench.read("out/fleet.csv");
        let line = table.lines().find(|line| line.starts_with(&name)).unwrap().to_owned();
        line.contains(",low,")
    };
    assert_eq!(DAYS.into_iter().filter(|day| of_day(*day)).collect::<Vec<_>>(), named);
    assert!(bench.read("out/index.html").contains("slow leak"));
}
