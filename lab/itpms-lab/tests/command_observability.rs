//! `itpms lab observability`: a page of text, JSON, and a directory of files.

use crate::common;

use common::Bench;
use serde_json::Value;

const CAR: &str = "\
[tire]
stiffness_per_kpa = 713.91
stiffness_at_zero = 60880.0
[corner.fl]
sprung_mass_kg = 240.8
unsprung_mass_kg = 56.9
damping_n_s_per_m = 925.8
spring_n_per_m = 29114.0
placard_kpa = 241.3
[corner.rl]
sprung_mass_kg = 216.0
unsprung_mass_kg = 48.0
damping_n_s_per_m = 925.8
spring_n_per_m = 29114.0
placard_kpa = 241.3
";

#[test]
fn the_summary_says_what_is_free_and_what_is_not() {
    let bench = Bench::new();
    bench.write("car.toml", CAR);
    let outcome = bench.run("observability --vehicle car.toml");
    let text = outcome.success();
    for words in ["one measurement", "difference only", "10 of 13", "48.0 kg against 56.9", "road known"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(!text.contains("made up"), "{text}");
    assert!(text.is_ascii() && text.lines().all(|line| line.len() <= 110), "{text}");
}

#[test]
fn files_are_complete_and_the_same_every_time() {
    let bench = Bench::new();
    bench.write("car.toml", CAR);
    let json = bench.run("observability --vehicle car.toml --corner rl --out a --json").success().to_owned();
    bench.run("observability --vehicle car.toml --corner rl --out b").success();
    let value: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(value["corner"], "rl");
    assert_eq!(value["ranks"][0]["stiffness"], "free");
    // Corners alike with the same pressure: nothing is known of the pressure itself.
    let curves = value["curves"].as_array().unwrap();
    let alike = curves.iter().find(|c| c["sources"] == "b" && c["situation"] == "constant").unwrap();
    assert!(alike["points"][0][1].is_null(), "{alike}");
    for name in [
        "observability.json",
        "observability.html",
        "observability-twins.svg",
        "observability-time.svg",
        "observability-sweeps.svg",
    ] {
        let (a, b) = (bench.read(&format!("a/{name}")), bench.read(&format!("b/{name}")));
        assert!(a.len() > 200 && a == b, "{name}");
    }
    assert_eq!(bench.read("a/observability.json").trim_end(), json.trim_end());
}

#[test]
fn a_corner_that_is_not_there_is_refused() {
    let bench = Bench::new();
    bench.write("car.toml", CAR);
    let outcome = bench.run("observability --vehicle car.toml --corner fr --out out");
    let refusal = outcome.refusal();
    assert!(refusal.contains("no corner fr") && refusal.contains("fl, rl"), "{refusal}");
    assert_eq!(bench.names(), ["car.toml"]);
    // Nor is a file a folder.
    let refusal = bench.run("observability --vehicle car.toml --out car.toml");
    assert!(refusal.refusal().contains("it is a file, expected a directory"));
    assert_eq!(bench.names(), ["car.toml"]);
}
