//! What turns with the wheels, from outside: imbalances that are put in, found by `itpms estimate`.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use serde_json::Value;

use crate::common::Bench;

/// In kg m, of each wheel.
const IMBALANCE: [(&str, f64); 4] = [("fl", 0.006), ("fr", 0.0), ("rl", 0.010), ("rr", 0.0)];

/// A sweep of speeds; a simulated imbalance turns with the way of the car, so that its speed is each wheel's own.
fn swept() -> Bench {
    let bench = Bench::new();
    let corners: String = IMBALANCE
        .map(|(corner, kg_m)| {
            format!(
                "[corner.{corner}]\npressure.constant_kpa = 241.3\ntruth = {{ imbalance_kg_m = {kg_m} }}\n"
            )
        })
        .concat();
    bench.write(
        "sweep.toml",
        format!(
            "name = \"sweep\"\nduration_s = 300.0\nrate_hz = 200.0\nwheelbase_m = 2.7\n[speed]\npoints_s_km_h = [[0, 50], [60, 120], [120, 50], [180, 120], [240, 50], [300, 120]]\n\
             [road.surface.iso8608]\nroughness = \"A\"\nslope = 2.0\n[sensor]\nnoise_m_s2 = 0.05\n[car]\n{corners}"
        ),
    );
    bench.run("simulate sweep.toml --seed 5 -o drive.csv --vehicle-out car.toml").success();
    bench
}

#[test]
fn the_forces_of_a_sweep_are_those_that_are_there() {
    let bench = swept();
    let summary: Value = serde_json::from_str(
        bench.run("estimate drive.csv --vehicle car.toml --report drive.html --json").success(),
    )
    .unwrap();
    for (corner, kg_m) in IMBALANCE {
        let found = &summary["once_per_turn"][corner];
        if kg_m == 0.0 {
            assert_eq!(found["state"], "no-line", "{corner} {found}");
            continue;
        }
        let of = |name: &str| found[name].as_f64().unwrap_or_else(|| panic!("{corner} {name} {found}"));
        let truth_n = kg_m * of("at_rad_per_s").powi(2);
        assert!((of("force_n") / truth_n - 1.0).abs() < 0.15, "{corner} {truth_n} {found}");
        assert!((of("imbalance_g") - 5e3 * kg_m).abs() < 2.0 * of("imbalance_sd_g"), "{corner} {found}");
    }
    assert!(bench.read("drive.html").contains("What turns with the wheels"));
}
