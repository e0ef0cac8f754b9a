//! `itpms lab simulate` from outside.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::{Bench, interrupt, table};

const LONG: &str = r#"
name = "long"
duration_s = 100000.0
rate_hz = 500.0
speed.constant_km_h = 50.0
road.surface.iso8608 = { roughness = "B", slope = 2.0 }
corner.fl.pressure.points_s_kpa = [[0.0, 240.0]]
"#;

#[test]
fn a_simulated_drive_is_a_log_with_its_truth_and_the_same_for_the_same_seed() {
    let bench = Bench::new();
    bench.run("simulate paper-drop --seed 7 -o a.csv --vehicle-out car.toml").success();
    let (names, rows) = table(&bench.read("a.csv"));
    assert_eq!(
        names.join(" "),
        "time_s speed_m_s fl_body_accel_m_s2 fl_wheel_accel_m_s2 fl_pressure_kpa fl_road_m"
    );
    // 40 s at 500 Hz; 241.3 kPa at the start, 137.9 at the end.
    assert_eq!(rows.len(), 20_000);
    assert_eq!((rows[0][4].as_str(), rows[19_999][4].as_str()), ("241.3", "137.9"));
    assert!(bench.read("car.toml").contains("sprung_mass_kg = 240.8"));

    bench.run("simulate paper-drop --seed 7 -o b.csv --quiet").success();
    assert_eq!(bench.read("a.csv"), bench.read("b.csv"));
    bench.run("simulate paper-drop --seed 8 -o c.csv --no-truth").success();
    let (names, _) = table(&bench.read("c.csv"));
    assert_eq!(names.len(), 4);
    assert_eq!(bench.names(), ["a.csv", "b.csv", "c.csv", "car.toml"]);
}

#[test]
fn what_was_written_can_be_asked_for_as_json() {
    let bench = Bench::new();
    let outcome = bench.run("simulate paper-drop --seed 3 -o d.csv --json");
    let value: serde_json::Value = serde_json::from_str(outcome.success()).unwrap();
    assert_eq!((value["rows"].as_u64(), value["seed"].as_u64()), (Some(20_000), Some(3)));
    assert_eq!(outcome.stderr, "");
}

#[test]
fn unusable_arguments_end_with_code_2_and_leave_nothing() {
    let bench = Bench::new();
    bench.write(
        "car.toml",
        "[tire]\nstiffness_per_kpa = 700\nstiffness_at_zero = 6e4\n[corner.fl]\nsprung_mass = 1\n",
    );
    for (line, message) in [
        ("simulate paper-dorp -o d.csv", "did you mean `paper-drop`?"),
        ("simulate nowhere.toml -o d.csv", "nowhere.toml"),
        ("simulate paper-drop -o d.xls", "d.xls: unknown file extension .xls, expected .csv"),
        (
            "simulate paper-drop -o missing/d.csv",
            "missing/d.csv: cannot be written: the directory missing does not exist",
        ),
        ("simulate paper-drop -o .", ".: is a directory, expected a file"),
        ("simulate paper-drop -o d.csv --vehicle none.toml", "none.toml: no such file"),
        (
            "simulate paper-drop -o d.csv --vehicle car.toml",
            "car.toml: line 5: unknown key sprung_mass in [corner.fl] (did you mean sprung_mass_kg?)",
        ),
        ("simulate paper-drop -o d.csv --vehicle-out no/car.toml", "no/car.toml: cannot be written"),
    ] {
        let outcome = bench.run(line);
        assert!(outcome.refusal().contains(message), "{line}: {outcome:?}");
        assert_eq!(bench.names(), ["car.toml"], "{line}");
    }
    // Missing arguments are reported by the parser in several lines, with the same code.
    assert_eq!(bench.run("simulate paper-drop").code, Some(2));
    assert_eq!(bench.run("simulate").code, Some(2));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let bench = Bench::new();
    let outcome = bench.run("simulate paper-drop -o /dev/full");
    assert!(
        outcome.refusal().starts_with("/dev/full: cannot be written: No space left on device"),
        "{outcome:?}"
    );
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing() {
    for (signal, output) in [("INT", "d.csv"), ("TERM", "e.csv")] {
        let bench = Bench::new();
        bench.write("long.toml", LONG);
        let child = bench.start(&format!("simulate long.toml -o {output}"), output);
        let outcome = interrupt(child, signal);
        assert_eq!(outcome.code, Some(130), "{outcome:?}");
        assert_eq!(outcome.stderr, "error: interrupted, nothing was written\n");
        assert_eq!(bench.names(), ["long.toml"]);
    }
}

#[test]
fn completions_know_the_commands() {
    let bench = Bench::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let outcome = bench.run(&format!("completions {shell}"));
        assert!(outcome.success().contains("simulate"), "{shell}");
    }
}

#[test]
fn help_has_examples_and_exit_codes() {
    let bench = Bench::new();
    let help = bench.run("--help");
    assert!(help.success().contains("Examples:") && help.stdout.contains("Exit codes: 0"));
    assert!(bench.run("simulate --help").success().contains("itpms lab simulate paper-drop"));
}

#[test]
fn a_car_that_cannot_be_simulated_leaves_no_log() {
    let bench = Bench::new();
    let scenario = include_str!("../../itpms-sim/scenarios/drive-puncture.toml");
    let impossible = scenario.replace("unsprung_mass_kg = 50.0", "unsprung_mass_kg = 0.001");
    assert_ne!(impossible, scenario);
    bench.write("impossible.toml", impossible);
    let outcome = bench.run("simulate impossible.toml -o drive.csv --vehicle-out car.toml");
    assert!(outcome.refusal().contains("the car's accelerations are no numbers"), "{outcome:?}");
    assert_eq!(bench.names(), ["impossible.toml"]);
}
