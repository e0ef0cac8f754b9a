//! Cold pressures from outside: a simulated drive in the cold, its tires warmed by driving, with and without what the car says of the air.

use serde_json::Value;

use crate::common::{Bench, table};

const AMBIENT_C: f64 = -10.0;
const COLD_KPA: f64 = 218.0;

/// Four tires that have 218 kPa cold at -10 C: after a start from rest at 100 km/h they are 22 K warmer in the long run, with a time constant of
/// eleven minutes.
fn warm_kpa(time_s: f64) -> f64 {
    let excess_k = 22.0 * (1.0 - (-time_s / 660.0).exp());
    (COLD_KPA + 101.325) * (273.15 + AMBIENT_C + excess_k) / (273.15 + AMBIENT_C) - 101.325
}

fn winter_drive() -> Bench {
    let bench = Bench::new();
    let points: Vec<String> =
        (0..=30).map(|k| 10.0 * f64::from(k)).map(|t| format!("[{t:.1}, {:.3}]", warm_kpa(t))).collect();
    let corners: String = ["fl", "fr", "rl", "rr"]
        .map(|corner| format!("[corner.{corner}]\npressure.points_s_kpa = [{}]\n", points.join(", ")))
        .join("\n");
    bench.write(
        "winter.toml",
        format!(
            "name = \"winter\"\ndescription = \"218 kPa cold at -10 C\"\nduration_s = 300.0\nrate_hz = 200.0\nsettle_s = 8.0\nwheelbase_m = 2.7\n\
             [speed]\nconstant_km_h = 100.0\n[road.surface.iso8608]\nroughness = \"B\"\nslope = 2.0\n[sensor]\nnoise_m_s2 = 0.05\n{corners}"
        ),
    );
    bench.run("simulate winter.toml --seed 5 -o drive.csv --vehicle-out car.toml").success();
    bench
}

/// Adds columns whose values come once a second.
fn with_air(bench: &Bench, columns: &[(&str, &str)]) {
    bench.edit_drive(|line, cells| {
        cells.extend(columns.iter().map(|(name, value)| match (line, line % 200) {
            (1, _) => (*name).to_owned(),
            (_, 2) => (*value).to_owned(),
            _ => String::new(),
        }));
    });
}

fn json(bench: &Bench, more: &str) -> Value {
    bench.json(&format!("estimate drive.csv --vehicle car.toml --json {more}"))
}

#[test]
fn a_winter_morning_says_what_to_add() {
    let bench = winter_drive();
    bench.run("estimate drive.csv --vehicle car.toml -o plain.csv").success();
    let before = json(&bench, "");
    assert!(before["corners"]["fl"].get("cold").is_none());
    with_air(&bench, &[("ambient_temperature_c", "-10"), ("barometric_kpa", "101.3")]);
    let outcome = bench.run("estimate drive.csv --vehicle car.toml -o est.csv --report drive.html");
    let lines = outcome.success();
    for corner in ["fl", "fr", "rl", "rr"] {
        let line = lines.lines().find(|line| line.trim_start().starts_with(corner)).unwrap();
        assert!(line.contains(" cold at -10 C: add "), "{lines}");
    }
    assert!(bench.read("drive.html").contains(" cold at -10 C"));
    let after = json(&bench, "");
    for corner in ["fl", "fr", "rl", "rr"] {
        let cold = &after["corners"][corner]["cold"];
        let of = |name: &str| cold[name].as_f64().unwrap();
        assert!((of("pressure_kpa") - COLD_KPA).abs() < 2.0 * of("sd_kpa"), "{cold}");
        assert!(
            (of("add_kpa") - (241.3 - of("pressure_kpa"))).abs() < 1e-9 && cold["state"] == "add",
            "{cold}"
        );
        // Pressures themselves know no temperature.
        assert_eq!(after["corners"][corner]["last"], before["corners"][corner]["last"]);
    }
    // In the table all but the new columns is what it was, and these follow the tire by the gas law.
    let ((old, old_rows), (new, new_rows)) = (table(&bench.read("plain.csv")), table(&bench.read("est.csv")));
    let place = |name: &str| new.iter().position(|n| n == name).unwrap();
    for (before, after) in old_rows.iter().zip(&new_rows) {
        let pressures = old
            .iter()
            .enumerate()
            .filter(|(_, name)| name.ends_with("pressure_kpa") || name.ends_with("lost_kpa"));
        for (i, name) in pressures {
            assert_eq!(before[i], after[place(name)], "{name}");
        }
    }
    let last = new_rows.last().unwrap();
    let of = |name: &str| last[place(name)].parse::<f64>().unwrap();
    let (pressure, cold) = (of("rl_pressure_kpa"), of("rl_cold_pressure_kpa"));
    let tire_k = 263.15 + 22.0 * (1.0 - (-of("time_s") / 660.0).exp());
    assert!((cold - ((pressure + 101.3) * 263.15 / tire_k - 101.325)).abs() < 0.05, "{pressure} {cold}");
    assert!(of("rl_cold_pressure_sd_kpa") > 263.15 / tire_k * of("rl_pressure_sd_kpa"));
}
