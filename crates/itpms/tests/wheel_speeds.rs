//! A drive with wheel speeds alone, from the bus to the report: the example of the book, and what is reported where something is missing.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::common::{Bench, table};

/// When the example's rear right tire has lost a quarter of its pressure, in s.
const LOSS_S: f64 = 60.0;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/wheel-speeds").join(name)
}

/// The example's log and DBC, and a vehicle file that the command has written.
fn bench() -> Bench {
    let bench = Bench::new();
    for name in ["drive.log", "car.dbc"] {
        bench.write(name, std::fs::read(example(name)).unwrap());
    }
    bench.run("vehicle init --tire 205/55R16 --wheelbase-m 2.7 --driven front -o wheels.toml").success();
    bench
}

const ESTIMATE: &str = "estimate drive.log --dbc car.dbc --vehicle wheels.toml";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn the_example_names_the_tire_that_lost_a_quarter() {
    let bench = bench();
    let line = format!(
        "{ESTIMATE} -o est.csv --calibrate-s 50 --events events.jsonl --report report.html --json --save-reference car.reference"
    );
    let outcome = bench.run(&line);
    let summary = json(outcome.success());
    let alerts = summary["alerts"].as_array().unwrap();
    assert_eq!(alerts.len(), 1, "{alerts:?}");
    assert_eq!((&alerts[0]["kind"], &alerts[0]["wheels"]), (&"differs".into(), &serde_json::json!(["rr"])));
    let reported_s = alerts[0]["reported_s"].as_f64().unwrap();
    assert!((LOSS_S..LOSS_S + 15.0).contains(&reported_s), "{reported_s}");
    // A quarter, as far as the radius over pressure is the assumed one.
    let rr = &summary["wheel_speeds"]["wheels"]["rr"];
    assert!((rr["lost_share"].as_f64().unwrap() - 0.25).abs() < 0.06, "{rr}");
    assert_eq!(summary["wheel_speeds"]["level"], "other-tires");
    let unseen = summary["wheel_speeds"]["not_seen"].to_string();
    assert!(unseen.contains("What all four tires lose alike is not seen"), "{unseen}");

    let (head, rows) = table(&bench.read("est.csv"));
    let column = |name: &str| head.iter().position(|of| of == name).unwrap_or_else(|| panic!("no {name}"));
    let at = |time_s: f64| {
        rows.iter().find(|row| row[0].parse::<f64>().unwrap() >= time_s).unwrap_or_else(|| panic!("{time_s}"))
    };
    assert_eq!(at(10.0)[column("rr_state")], "unknown");
    assert_eq!(at(59.0)[column("rr_state")], "fine");
    assert_eq!(
        (at(100.0)[column("rr_state")].as_str(), at(100.0)[column("rr_warning")].as_str()),
        ("low", "low")
    );
    assert!(
        rows.iter()
            .all(|row| row[column("fl_warning")] == "none" && row[column("fl_level")] == "other-tires")
    );
    // The true change, rear left over right, is -.007 ln .75, within two sds.
    let number = |name: &str| at(115.0)[column(name)].parse::<f64>().unwrap();
    let (difference, sd) = (number("rear_radius_difference"), number("rear_radius_difference_sd"));
    assert!((difference - 2.01e-3).abs() < 2.0 * sd && sd < 4e-4, "{difference} {sd}");
    assert!(number("front_radius_difference").abs() < 3.0 * number("front_radius_difference_sd"));
    assert!(!head.iter().any(|name| name.contains("pressure_kpa")));

    let events = bench.read("events.jsonl");
    assert!(events.contains("\"begun\"") && events.contains("rr differs from the other tires"), "{events}");
    let page = bench.read("report.html");
    for part in [
        "The rear right tire differs from the others since the calibration",
        "data-wheels",
        // The page opens with the car: the wheel, what it has lost, what would have been found.
        "card low at-rr",
        "% lost</small>",
        "% would show</span>",
        "Differs from the others",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_stored_calibration_is_used_on_another_drive_whose_loads_may_be_others() {
    let bench = bench();
    let log = bench.read("drive.log");
    let before_loss = log.lines().position(|line| line.starts_with("(59.0")).unwrap();
    let first: String = log.lines().take(before_loss).map(|line| format!("{line}\n")).collect();
    bench.write("first.log", first);
    let learn = "estimate first.log --dbc car.dbc --vehicle wheels.toml --calibrate-s 50 --save-reference car.reference --json";
    let outcome = bench.run(learn);
    assert_eq!(json(outcome.success())["alerts"], serde_json::json!([]));
    // Loads move at a stop only: what a rear tire loses while the car drives is found, what one has lost before would not show.
    let outcome = bench.run(&format!("{ESTIMATE} --reference car.reference"));
    let text = outcome.success();
    assert!(text.contains("the rear right tire differs from the others since the calibration"), "{text}");
    assert!(text.contains("fl  fine:") && text.contains("rl  unknown:"), "{text}");
    assert!(text.contains("The car has stood since the calibration, so loads may have changed"), "{text}");
    assert!(text.contains("reported at"), "{text}");
    // The reference is this car's alone.
    let other = bench.read("wheels.toml").replace("driven = \"front\"", "driven = \"rear\"");
    bench.write("other.toml", other);
    let refused =
        bench.run("estimate drive.log --dbc car.dbc --vehicle other.toml --reference car.reference");
    assert!(refused.refusal().contains("set of parameters"), "{}", refused.stderr);
}

#[test]
fn known_pressures_of_the_calibration_are_counted_in() {
    let bench = bench();
    // Calibrated with rear right at three quarters of 240 kPa: the example's loss is then another quarter.
    let outcome =
        bench.run(&format!("{ESTIMATE} --calibrate-s 50 --pressure-kpa fl=240,fr=240,rl=240,rr=180 --json"));
    let summary = json(outcome.success());
    let alert = &summary["alerts"][0];
    assert_eq!(alert["wheels"], serde_json::json!(["rr"]));
    assert!(alert["reported_s"].as_f64().unwrap() < LOSS_S, "{alert}");
    let lost = summary["wheel_speeds"]["wheels"]["rr"]["lost_share"].as_f64().unwrap();
    // 1 - .75^2, drawn a little to what low tires have.
    assert!((lost - 0.4375).abs() < 0.1, "{lost}");
}

#[test]
fn the_tires_own_sensors_teach_a_calibration_and_are_listed() {
    let bench = bench();
    let sensors = r#"
BO_ 1950 TirePressure: 8 X
 SG_ TirePressFl : 15|8@0+ (1,0) [0|255] "kPa" X
 SG_ TirePressFr : 31|8@0+ (1,0) [0|255] "kPa" X
 SG_ TirePressRr : 47|8@0+ (1,0) [0|255] "kPa" X
 SG_ TirePressRl : 63|8@0+ (1,0) [0|255] "kPa" X
"#;
    bench.write("car.dbc", format!("{}{sensors}", bench.read("car.dbc")));
    let mut log = String::new();
    for (i, line) in bench.read("drive.log").lines().enumerate() {
        log += &format!("{line}\n");
        if i % 1000 == 0 {
            // 240, 240, 200 rear right and 240 kPa.
            log += &format!("{} can0 79E#00F000F000C800F0\n", line.split(' ').next().unwrap());
        }
    }
    bench.write("drive.log", log);
    let given =
        bench.run(&format!("{ESTIMATE} --calibrate-s 50 --pressure-kpa fl=240,fr=240,rl=240,rr=200 --json"));
    let asked = bench.run(&format!("{ESTIMATE} --calibrate-s 50 --report report.html --json"));
    let (given, summary) = (json(given.success()), json(asked.success()));
    assert_eq!(summary["wheel_speeds"], given["wheel_speeds"]);
    assert_eq!(
        summary["tire_sensors_kpa"],
        serde_json::json!({ "fl": 240.0, "fr": 240.0, "rl": 240.0, "rr": 200.0 })
    );
    let reported = "calibrated at what the tires' own sensors send: fl 240, fr 240, rl 240, rr 200 kPa";
    assert!(asked.stderr.contains(reported), "{}", asked.stderr);
    assert!(bench.read("report.html").contains("fl 240 kPa, fr 240 kPa, rl 240 kPa, rr 200 kPa"));
}
