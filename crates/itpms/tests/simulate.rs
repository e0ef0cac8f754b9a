//! `itpms lab simulate` from outside.

use crate::common::{Bench, interrupt, table};

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
