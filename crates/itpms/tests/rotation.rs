//! What turns with the wheels, from outside: imbalances that are put in, found by `itpms estimate`.

use serde_json::Value;

use crate::common::Bench;

/// In kg m, of each wheel.
const IMBALANCE: [(&str, f64); 4] = [("fl", 0.006), ("fr", 0.0), ("rl", 0.010), ("rr", 0.0)];

/// A scenario: a sweep of speeds, and what else is known of the car.
fn sweep(name: &str, car: &str) -> String {
    let corner = |(corner, kg_m)| {
        format!("[corner.{corner}]\npressure.constant_kpa = 241.3\ntruth = {{ imbalance_kg_m = {kg_m} }}\n")
    };
    format!(
        "name = \"{name}\"\nduration_s = 300.0\nrate_hz = 200.0\nwheelbase_m = 2.7\n[speed]\npoints_s_km_h = [[0, 50], [60, 120], [120, 50], [180, 120], [240, 50], [300, 120]]\n\
         [road.surface.iso8608]\nroughness = \"A\"\nslope = 2.0\n[sensor]\nnoise_m_s2 = 0.05\n[car]\n{car}{}",
        IMBALANCE.map(corner).concat()
    )
}

/// Driven so.
fn swept() -> Bench {
    let bench = Bench::new();
    bench.write("sweep.toml", sweep("sweep", ""));
    bench.run("simulate sweep.toml --seed 5 -o drive.csv --vehicle-out car.toml").success();
    bench
}

#[test]
fn the_forces_of_a_sweep_are_those_that_are_there() {
    let bench = swept();
    let summary: Value = bench.json("estimate drive.csv --vehicle car.toml --report drive.html --json");
    for (corner, kg_m) in IMBALANCE {
        let found = &summary["once_per_turn"][corner];
        if kg_m == 0.0 {
            assert_eq!(found["state"], "no-line", "{corner} {found}");
            continue;
        }
        let of = |name: &str| found[name].as_f64().unwrap_or_else(|| panic!("{corner} {name} {found}"));
        let truth_n = kg_m * of("at_rad_per_s").powi(2);
        assert!((of("force_n") / truth_n - 1.0).abs() < 0.15, "{corner} {truth_n} {found}");
        // The car's speed is no wheel's.
        assert!(found["imbalance_g"].is_null(), "{corner} {found}");
    }
    assert!(bench.read("drive.html").contains("What turns with the wheels"));
    // The live monitor has worked out the same when its source has ended.
    bench.run("monitor --replay drive.csv --speed max --vehicle car.toml --json live.jsonl").success();
    let last: Value = serde_json::from_str(bench.read("live.jsonl").lines().last().unwrap()).unwrap();
    for what in ["once_per_turn", "dampers", "load"] {
        assert_eq!(last[what], summary[what], "{what}");
    }
}

/// The same car on a winding road, its wheels at speeds of their own: by radius, load, slip and bends. Where a wheel turns otherwise than the car
/// goes, its imbalance turns with it.
#[test]
fn in_bends_each_wheel_is_known_by_its_own_speed() {
    let bench = Bench::new();
    // A bend of 1.5 m/s² to either side every half minute.
    let bends: String =
        (0..30).map(|k| format!("[{}, {}], ", 10 * k, [0.0, 1.5, 0.0, -1.5][k % 4])).collect();
    let winding =
        format!("lateral_points_s_m_s2 = [{bends}]\n[wheel_speeds]\ncar_seed = 3\nturns_imbalance = true\n");
    bench.write("winding.toml", sweep("winding", &winding));
    bench.run("simulate winding.toml --seed 5 -o own.csv --vehicle-out car.toml").success();
    let own = bench.read("own.csv");
    let (head, rows) = own.split_once('\n').unwrap();
    // The same log without the wheels' speeds: the car's stands for them.
    bench.write("car.csv", format!("{}\n{rows}", head.replace("_wheel_speed_m_s", "_unused")));
    let found = |log: &str| -> Value {
        let line = format!("estimate {log} --vehicle car.toml --json");
        bench.json(&line)["once_per_turn"].clone()
    };
    let (by_own, by_car) = (found("own.csv"), found("car.csv"));
    for (corner, kg_m) in IMBALANCE.into_iter().filter(|(_, kg_m)| *kg_m > 0.0) {
        let of =
            |name: &str| by_own[corner][name].as_f64().unwrap_or_else(|| panic!("{corner} {name} {by_own}"));
        let truth_n = kg_m * of("at_rad_per_s").powi(2);
        assert!((of("force_n") / truth_n - 1.0).abs() < 0.15, "{corner} {truth_n} {by_own}");
        assert!((of("imbalance_g") - 5e3 * kg_m).abs() < 2.0 * of("imbalance_sd_g"), "{corner} {by_own}");
        assert!(by_car[corner]["imbalance_g"].is_null(), "{corner} {by_car}");
    }
}
