//! `itpms vehicle`: a file of typical values that every command takes, and what a file says.

use crate::common::Bench;

const INIT: &str = "vehicle init --mass 1500 --front-share 0.55 --tire 205/55R16 --wheelbase-m 2.7";

#[test]
fn show_gives_frequencies_and_what_a_per_cent_costs() {
    let bench = Bench::new();
    bench.run(&format!("{INIT} -o car.toml")).success();
    let shown: serde_json::Value = bench.json("vehicle show car.toml --json");
    let front = &shown["corners"]["fl"];
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    // The corners carry the car: half of 55 % of 1500 kg.
    let masses = ["sprung_mass", "unsprung_mass"].map(|key| number(&front["parameters"][key]["value"]));
    assert!((masses[0] + masses[1] - 412.5).abs() < 0.2, "{front}");
    // 240 kPa and the 87 kPa that the structure is worth.
    assert!((number(&front["derived"]["kpa_per_percent_of_mass"]) - 3.27).abs() < 0.005, "{front}");
    assert!((10.0..15.0).contains(&number(&front["derived"]["hop_hz"])), "{front}");
    // 15 and 8 per cent make 17: 56 kPa.
    assert!((number(&front["derived"]["uncalibrated_pressure_sd_kpa"]) - 55.6).abs() < 0.2, "{front}");
    let table = bench.run("vehicle show car.toml");
    let table = table.success();
    for word in
        ["confidence", "typical", "wheel hop (Hz)", "unsprung mass (kg)", "kPa per 1 % of unsprung mass"]
    {
        assert!(table.contains(word), "{table}");
    }
}

#[test]
fn check_finds_the_damper_that_is_not_the_files() {
    let bench = Bench::new();
    bench.run(&format!("{INIT} -o car.toml")).success();
    bench.run("simulate drive-puncture --seed 1 -o drive.csv --vehicle car.toml").success();
    let report =
        |line: &str| -> serde_json::Value { bench.json(&format!("vehicle check drive.csv {line} --json")) };
    let reported = report("--vehicle car.toml --report check.html");
    for corner in ["fl", "fr", "rl", "rr"] {
        let check = &reported["corners"][corner];
        assert_eq!(check["asks_for_change"], false, "{check}");
        let ratio = check["damping_over_file"].as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 0.1, "{check}");
    }
    let page = bench.read("check.html");
    assert!(
        page.starts_with("<!doctype html>") && !page.contains("NaN") && !page.contains("http://localhost")
    );
    assert_eq!(page.matches("<h3>").count(), 4);
    // A file that says half of the damping the car has, and is sure of it.
    let text = bench.read("car.toml");
    let damping = text.lines().find(|line| line.starts_with("damping_n_s_per_m")).unwrap();
    let value: f64 = damping.split([' ', '#']).nth(2).unwrap().parse().unwrap();
    let half = damping.replacen(&format!("{value:.1}"), &format!("{:.1}", 0.5 * value), 1);
    bench.write(
        "half.toml",
        text.replacen(damping, &half, 1).replace("damping_relative_sd = 0.30", "damping_relative_sd = 0.05"),
    );
    let wrong = report("--vehicle half.toml");
    let check = &wrong["corners"]["fl"];
    assert!((check["damping_over_file"].as_f64().unwrap() - 2.0).abs() < 0.2, "{check}");
    assert!(check["sentence"].as_str().unwrap().contains("set damping_n_s_per_m to"), "{check}");
    assert_eq!(wrong["corners"]["rl"]["asks_for_change"], false, "{wrong}");
}
