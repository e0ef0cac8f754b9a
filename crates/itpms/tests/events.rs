//! `itpms estimate --events`: what the monitor says of a drive, line by line, and that `est.csv` says the same.

use serde_json::Value;

use crate::common::Bench;

/// The puncture at 200 Hz, which is as much as the monitor needs.
fn puncture() -> String {
    let scenario = include_str!("../../itpms-sim/scenarios/drive-puncture.toml");
    scenario.replace("rate_hz = 500.0", "rate_hz = 200.0")
}

/// Simulates a scenario and estimates it; gives the events.
fn estimated(bench: &Bench, scenario: &str, options: &str) -> Vec<Value> {
    bench.write("scenario.toml", scenario);
    bench.run("simulate scenario.toml --seed 1 -o drive.csv --vehicle-out car.toml").success();
    let line = format!("estimate drive.csv --vehicle car.toml -o est.csv --events events.jsonl {options}");
    bench.run(&line).success();
    bench.json_lines("events.jsonl")
}

/// Times in s at which a column of `est.csv` holds a text.
fn times(bench: &Bench, column: &str, text: &str) -> Vec<f64> {
    let table = bench.read("est.csv");
    let mut lines = table.lines();
    let place = lines.next().unwrap().split(',').position(|name| name == column).unwrap();
    let cells = lines.map(|line| line.split(',').collect::<Vec<_>>());
    cells.filter(|cells| cells[place] == text).map(|cells| cells[0].parse().unwrap()).collect()
}

fn reported(event: &Value, kind: &str, wheels: &[&str]) -> bool {
    event["kind"] == kind && event["wheels"].as_array().unwrap().iter().eq(wheels)
}

#[test]
fn a_puncture_is_reported_once_for_the_right_wheel_and_in_both_files() {
    let bench = Bench::new();
    let events = estimated(&bench, &puncture(), "");
    let low: Vec<&Value> =
        events.iter().filter(|e| reported(e, "under-inflated", &["fl"]) && e["event"] == "begun").collect();
    assert_eq!(low.len(), 1, "{events:?}");
    // Falling from 20 s on, a fifth is lost after 21.2 s and all of it after 22.5 s.
    let time = |name: &str| low[0][name].as_f64().unwrap();
    assert!((20.0..=22.5).contains(&time("since_s")), "{events:?}");
    assert!(
        (21.2..=24.2).contains(&time("reported_s")) && time("reported_s") == time("time_s"),
        "{events:?}"
    );
    assert!(time("pressure_kpa") + 1.645 * time("sd_kpa") < time("limit_kpa"), "{events:?}");
    assert!(
        events.iter().all(|e| reported(e, "under-inflated", &["fl"]) || reported(e, "fast-leak", &["fl"]))
    );
    assert_eq!(times(&bench, "fl_warning", "low")[0], time("reported_s"));
    for other in ["fr_warning", "rl_warning", "rr_warning"] {
        assert!(times(&bench, other, "low").is_empty());
    }
}

#[test]
fn the_regulation_sets_the_limit() {
    let bench = Bench::new();
    let limit = |options: &str| {
        let events = estimated(&bench, &puncture(), options);
        let low = events.iter().find(|e| reported(e, "under-inflated", &["fl"])).unwrap();
        (low["limit_kpa"].as_f64().unwrap(), low["reported_s"].as_f64().unwrap())
    };
    let (europe, america) = (limit("--regulation un-r141"), limit("--regulation fmvss-138"));
    // Losses of 20 and 25 % have to be warned of before they are complete.
    assert!(europe.0 > 0.8 * 241.3 && europe.0 < 241.3, "{europe:?}");
    assert!(america.0 > 0.75 * 241.3 && america.0 < europe.0, "{america:?}");
    assert!(america.1 >= europe.1);
}

/// Four people with their luggage get in while the car stands, and out again: 400 kg, a third of the car.
#[test]
fn a_load_that_changes_is_no_pressure() {
    let mut scenario = puncture()
        .replace("duration_s = 40.0", "duration_s = 150.0")
        .replace("constant_km_h = 80.0", "points_s_km_h = [[0.0, 60.0], [40.0, 60.0], [46.0, 0.0], [56.0, 0.0], [64.0, 60.0], [100.0, 60.0], [106.0, 0.0], [116.0, 0.0], [124.0, 60.0]]")
        .replace("points_s_kpa = [[20.0, 241.3], [22.5, 137.9]]", "constant_kpa = 241.3");
    for (behind_front_m, left_m) in [(1.2, 0.36), (1.2, -0.36), (2.4, 0.36), (2.4, -0.36)] {
        let in_and_out = "points_s_kg = [[49.0, 0.0], [51.0, 100.0], [109.0, 100.0], [111.0, 0.0]]";
        scenario += &format!(
            "\n[[car.payload]]\nbehind_front_m = {behind_front_m}\nleft_m = {left_m}\n{in_and_out}\n"
        );
    }
    let bench = Bench::new();
    let events = estimated(&bench, &scenario, "");
    assert!(events.is_empty(), "{events:?}");
    // Nor was it silent for want of knowing.
    for wheel in ["fl", "fr", "rl", "rr"] {
        let valid = times(&bench, &format!("{wheel}_valid"), "true");
        assert!(valid.iter().filter(|time_s| **time_s > 64.0 && **time_s < 100.0).count() > 340, "{wheel}");
    }
}

#[test]
fn a_tire_with_too_much_is_reported_and_is_no_low_one() {
    let scenario = puncture()
        .replace("duration_s = 40.0", "duration_s = 120.0")
        .replace("points_s_kpa = [[20.0, 241.3], [22.5, 137.9]]", "constant_kpa = 340.0");
    let bench = Bench::new();
    let events = estimated(&bench, &scenario, "");
    assert_eq!(events.len(), 1, "{events:?}");
    assert!(reported(&events[0], "over-inflated", &["fl"]), "{events:?}");
    // It has to hold for a minute.
    assert!((60.0..=100.0).contains(&events[0]["reported_s"].as_f64().unwrap()), "{events:?}");
    for wheel in ["fl", "fr", "rl", "rr"] {
        assert!(times(&bench, &format!("{wheel}_warning"), "low").is_empty(), "{wheel}");
    }
}

#[test]
fn a_stuck_sensor_is_reported_and_taken_back_and_its_pressure_is_not_shown_meanwhile() {
    let bench = Bench::new();
    let fault =
        "\n[[fault]]\ncorner = \"rr\"\nsensor = \"wheel\"\nfrom_s = 8.0\nto_s = 12.0\nkind = \"stuck\"\n";
    let events = estimated(&bench, &(puncture() + fault), "");
    let at = |event: &str| {
        let found =
            events.iter().find(|e| e["event"] == event && e["kind"].as_str().unwrap() == "malfunction");
        found.map(|e| (e["time_s"].as_f64().unwrap(), e["wheels"].clone()))
    };
    let (begun, ended) = (at("begun").unwrap(), at("ended").unwrap());
    assert_eq!(begun.1, serde_json::json!(["rr"]), "{events:?}");
    // Not one change for half a second, looked at every half second; back after it has changed for 1.5 s.
    assert!((8.0..=9.5).contains(&begun.0), "{events:?}");
    assert!((13.0..=15.0).contains(&ended.0), "{events:?}");
    let shown = times(&bench, "rr_valid", "true");
    assert!(!shown.iter().any(|&t| t > begun.0 && t < 12.0), "{events:?}");
    assert!(shown.iter().any(|&t| t < 8.0) && shown.iter().any(|&t| t > 20.0));
    let told = times(&bench, "rr_warning", "malfunction");
    assert!(told.iter().all(|&t| t >= begun.0 && t <= ended.0) && !told.is_empty());
}
