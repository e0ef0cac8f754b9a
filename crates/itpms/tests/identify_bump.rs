//! `itpms lab identify bump` on drops from a small simulator of its own, on a real rig where its data are there, and on damaged records.

use std::fmt::Write as _;
use std::io::{Write as _, stderr};
use std::path::PathBuf;

use serde_json::Value;

use crate::common::Bench;

/// A corner that is let down off a block, or whose body is let go on its spring.
#[derive(Clone, Copy)]
struct Drop {
    sprung_kg: f64,
    unsprung_kg: f64,
    spring: f64,
    damping: f64,
    friction: f64,
    tire: f64,
    tire_damping: f64,
    /// Height in m from which body and wheel fall.
    body_m: f64,
    wheel_m: f64,
    /// Standard deviation of the noise of the sensors: m/s² and m.
    noise: [f64; 2],
    rate_hz: f64,
}

/// A corner of a car off a block of 15 mm: the wheel leaves the ground for a moment.
const OFF_A_BLOCK: Drop = Drop {
    sprung_kg: 360.0,
    unsprung_kg: 45.0,
    spring: 23_000.0,
    damping: 900.0,
    friction: 25.0,
    tire: 220_000.0,
    tire_damping: 60.0,
    body_m: 0.015,
    wheel_m: 0.015,
    noise: [0.02, 2e-6],
    rate_hz: 500.0,
};

/// Columns of time, body and wheel height, body and wheel acceleration.
type Rows = Vec<[f64; 5]>;

/// Runge and Kutta's fourth order at 20 kHz; the corner is held for half a second, then let go for three. Friction is a
/// spring of 0.05 mm that slips at its force (Prandtl's element): nothing like what the program fits.
fn simulate(drop: &Drop) -> Rows {
    const STEP_S: f64 = 5e-5;
    const SLIP_M: f64 = 5e-5;
    let weight = 9.81 * (drop.sprung_kg + drop.unsprung_kg);
    let slope = |x: [f64; 5]| -> [f64; 5] {
        let [body, body_v, wheel, wheel_v, slip] = x;
        let (travel, closing) = (wheel - body, wheel_v - body_v);
        let strut = drop.spring * travel + drop.damping * closing + drop.friction * slip;
        // A tire does not pull.
        let road = (weight - drop.tire * wheel - drop.tire_damping * wheel_v).max(0.0) - weight;
        let slipping = (slip >= 1.0 && closing > 0.0) || (slip <= -1.0 && closing < 0.0);
        let stretch = if slipping { 0.0 } else { closing / SLIP_M };
        [body_v, strut / drop.sprung_kg, wheel_v, (road - strut) / drop.unsprung_kg, stretch]
    };
    let along = |x: [f64; 5], d: [f64; 5], h: f64| -> [f64; 5] { std::array::from_fn(|i| x[i] + h * d[i]) };
    let mut noise = noise();
    let every = (1.0 / (drop.rate_hz * STEP_S)).round() as usize;
    let mut x = [drop.body_m, 0.0, drop.wheel_m, 0.0, 0.0];
    let mut rows = Vec::new();
    for i in 0..70_000 {
        let held = i < 10_000;
        if i % every == 0 {
            let d = if held { [0.0; 5] } else { slope(x) };
            let mut row = [i as f64 * STEP_S, x[0], x[2], d[1], d[3]];
            for (j, value) in row.iter_mut().enumerate().skip(1) {
                *value += noise() * drop.noise[usize::from(j < 3)];
            }
            rows.push(row);
        }
        if held {
            continue;
        }
        let a = slope(x);
        let b = slope(along(x, a, 0.5 * STEP_S));
        let c = slope(along(x, b, 0.5 * STEP_S));
        let d = slope(along(x, c, STEP_S));
        let sum = std::array::from_fn(|k| (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) / 6.0);
        x = along(x, sum, STEP_S);
        x[4] = x[4].clamp(-1.0, 1.0);
    }
    rows
}

/// Independent numbers of mean zero and variance one: a sum of twelve uniform ones less six.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    }
}

fn heights(rows: &Rows) -> String {
    rows.iter().fold("time_s,fl_body_m,fl_wheel_m\n".to_owned(), |mut text, row| {
        writeln!(text, "{:.6},{:.9},{:.9}", row[0], row[1], row[2]).unwrap();
        text
    })
}

fn accelerations(rows: &Rows) -> String {
    let header = "time_s,rl_body_accel_m_s2,rl_wheel_accel_m_s2\n".to_owned();
    rows.iter().fold(header, |mut text, row| {
        writeln!(text, "{:.6},{:.6},{:.6}", row[0], row[3], row[4]).unwrap();
        text
    })
}

fn identified(bench: &Bench, line: &str) -> Value {
    bench.json(&format!("identify bump {line} --json"))
}

fn masses(drop: &Drop) -> String {
    format!("--sprung-mass-kg {} --unsprung-mass-kg {}", drop.sprung_kg, drop.unsprung_kg)
}

fn value(fit: &Value, key: &str) -> (f64, f64) {
    (fit[key].as_f64().unwrap(), fit[format!("{key}_se")].as_f64().unwrap())
}

/// The truth lies within three standard errors, and the error is smaller than `most` of it.
fn holds(fit: &Value, key: &str, truth: f64, most: f64) {
    let (found, error) = value(fit, key);
    assert!((found - truth).abs() < 3.0 * error, "{key}: {found} ± {error}, truth {truth}");
    assert!(error > 0.0 && error < most * truth.abs(), "{key}: {found} ± {error}");
}

#[test]
fn a_drop_off_a_block_gives_its_parts_from_accelerations() {
    let (bench, drop) = (Bench::new(), OFF_A_BLOCK);
    bench.write("drop.csv", accelerations(&simulate(&drop)));
    let result = identified(&bench, &format!("drop.csv {}", masses(&drop)));
    let fit = &result["corners"]["rl"];
    holds(fit, "spring_n_per_m", drop.spring, 0.15);
    holds(fit, "damping_n_s_per_m", drop.damping, 0.25);
    holds(fit, "friction_n", drop.friction, 0.5);
    holds(fit, "tire_n_per_m", drop.tire, 0.05);
    // The hop's natural frequency: sqrt((ks + kt) / mw), less what the body takes of it (4 per mille).
    let hop = ((drop.spring + drop.tire) / drop.unsprung_kg).sqrt() / std::f64::consts::TAU;
    let (found, error) = value(fit, "hop_hz");
    assert!((found / hop - 1.0).abs() < 0.03 && error < 0.05 * hop, "{found} ± {error}, truth {hop}");
    let (found, _) = value(fit, "hop_damping_ratio");
    // (cs + ct) / (2 sqrt(mw (ks + kt))) = 0.145; friction adds to it.
    assert!((0.12..0.22).contains(&found), "{found}");
}

#[test]
fn a_body_let_go_gives_its_parts_from_heights() {
    let bench = Bench::new();
    let drop = Drop { body_m: 0.03, wheel_m: 0.03 * 23.0 / 243.0, damping: 500.0, ..OFF_A_BLOCK };
    bench.write("drop.csv", heights(&simulate(&drop)));
    let result = identified(&bench, &format!("drop.csv {}", masses(&drop)));
    let fit = &result["corners"]["fl"];
    holds(fit, "spring_n_per_m", drop.spring, 0.05);
    holds(fit, "damping_n_s_per_m", drop.damping, 0.25);
    holds(fit, "friction_n", drop.friction, 0.4);
    holds(fit, "tire_n_per_m", drop.tire, 0.10);
    assert!(result["axles"].as_object().unwrap().is_empty());
}

#[test]
fn a_hop_that_only_friction_drives_is_not_believed() {
    let bench = Bench::new();
    // Body and wheel let go in equilibrium: the wheel does not hop by itself, friction's turns shake it.
    for (damping, friction) in [(500.0, 25.0), (900.0, 35.0), (1_500.0, 20.0), (800.0, 5.0)] {
        let drop = Drop { body_m: 0.03, wheel_m: 0.03 * 23.0 / 243.0, damping, friction, ..OFF_A_BLOCK };
        bench.write("drop.csv", accelerations(&simulate(&drop)));
        let fit = &identified(&bench, "drop.csv")["corners"]["rl"];
        let hop = ((drop.spring + drop.tire) / drop.unsprung_kg).sqrt() / std::f64::consts::TAU;
        if !fit["hop_hz"].is_null() {
            let (found, error) = value(fit, "hop_hz");
            assert!(
                (found - hop).abs() < 3.0 * error,
                "{damping} {friction}: {found} ± {error}, truth {hop}"
            );
        }
    }
}

#[test]
fn without_masses_there_are_frequencies_and_nothing_else() {
    let (bench, drop) = (Bench::new(), Drop { damping: 600.0, friction: 5.0, ..OFF_A_BLOCK });
    bench.write("drop.csv", heights(&simulate(&drop)));
    let result = identified(&bench, "drop.csv");
    let fit = &result["corners"]["fl"];
    for key in ["spring_n_per_m", "damping_n_s_per_m", "friction_n", "tire_n_per_m", "tire_n_per_m_se"] {
        assert!(fit[key].is_null(), "{fit}");
    }
    let w = (drop.spring / drop.sprung_kg).sqrt();
    holds(fit, "body_hz", w / std::f64::consts::TAU, 0.1);
    holds(fit, "body_damping_ratio", drop.damping / (2.0 * w * drop.sprung_kg), 0.25);
    // One mass without the other is half a question.
    let outcome = bench.run("identify bump drop.csv --sprung-mass-kg 360");
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
}

#[test]
fn the_figure_and_the_table_are_written() {
    let (bench, drop) = (Bench::new(), OFF_A_BLOCK);
    bench.write("drop.csv", heights(&simulate(&drop)));
    let run = bench.run(&format!("identify bump drop.csv {} --plot drop.svg", masses(&drop)));
    for word in ["spring ks", "friction", "tire kt", "wheel hop", "concerns"] {
        assert!(run.success().contains(word), "{run:?}");
    }
    let svg = bench.read("drop.svg");
    assert!(svg.starts_with("<svg") && !svg.contains("NaN"), "{svg}");
    // An unsprung mass that is not the wheel's shows: no tire fits it.
    assert!(!run.stdout.contains("the masses are of another corner"), "{run:?}");
    let wrong = bench.run("identify bump drop.csv --sprung-mass-kg 360 --unsprung-mass-kg 30");
    assert!(wrong.success().contains("the masses are of another corner"), "{wrong:?}");
}

#[test]
fn unusable_records_are_refused_in_one_sentence() {
    let bench = Bench::new();
    let rows = simulate(&OFF_A_BLOCK);
    let refused = |name: &str, text: String| -> String {
        bench.write(name, text);
        let before = bench.names();
        let outcome = bench.run(&format!("identify bump {name} --plot out.svg"));
        assert_eq!(bench.names(), before);
        outcome.refusal().to_owned()
    };
    let good = heights(&rows);
    let text = refused("a.csv", good.replace("fl_body_m", "fl_boby_m"));
    assert_eq!(
        text,
        "a.csv: column fl_body_m is missing; a corner has both: without fl_wheel_m the record is read without this corner"
    );
    let text = refused("b.csv", good.replace("fl_", "xx_"));
    assert!(text.starts_with("b.csv: no corner is measured, expected {c}_body_m"), "{text}");
    let text = refused("c.csv", good.replacen("0.002000,", "0.009000,", 1));
    assert!(text.starts_with("c.csv: time_s does not increase") || text.contains("steps by"), "{text}");
    let still: Rows = rows.iter().map(|row| [row[0], 0.1, 0.1, 0.0, 0.0]).collect();
    assert_eq!(refused("d.csv", heights(&still)), "d.csv: the body's height is constant (0.1)");
    let slow: Rows = rows.iter().step_by(10).copied().collect();
    assert_eq!(refused("e.csv", heights(&slow)), "e.csv: found 50.0 rows per second, expected at least 100");
    let short: Rows = rows.iter().take(330).copied().collect();
    assert!(refused("f.csv", heights(&short)).contains("rows of free motion, expected at least 250"));
    let text = refused("g.csv", good.replacen("0.002000,", "0.002000,nan", 1));
    assert!(text.contains("g.csv: line 3, column fl_body_m: found"), "{text}");
}

/// The rig's records: name, sprung mass of a side in kg.
const RIG: [(&str, f64); 4] = [
    ("rig_undamped", 216.5),
    ("rig_damped_500", 216.5),
    ("rig_damped_1500", 216.5),
    // 100 N more on a side.
    ("rig_undamped_100", 216.5 + 100.0 / 9.81),
];

fn shared_data() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let found = folder.join("rig_undamped.parquet").exists();
    if !found {
        // Past the capture of the test's output: a test that did not run should not look as if it had.
        stderr().write_all(b"skipped: no ../shared/data/rig_undamped.parquet\n").unwrap();
    }
    found.then_some(folder)
}

#[test]
fn a_real_rig_has_the_same_parts_at_every_damper_setting() {
    let Some(folder) = shared_data() else { return };
    let bench = Bench::new();
    let fits: Vec<Value> = RIG
        .iter()
        .map(|(name, sprung_kg)| {
            let log = folder.join(format!("{name}.parquet"));
            identified(
                &bench,
                &format!("{} --sprung-mass-kg {sprung_kg} --unsprung-mass-kg 56.1", log.display()),
            )
        })
        .collect();
    // Least squares on both masses, by another program: 18.6 kN/m, 330 kN/m a side, friction some 14 N.
    for result in &fits {
        for corner in ["fl", "fr"] {
            let fit = &result["corners"][corner];
            for (key, expected) in [("spring_n_per_m", 18_600.0), ("tire_n_per_m", 330_000.0)] {
                let (found, error) = value(fit, key);
                assert!((found / expected - 1.0).abs() < 0.05, "{corner} {key}: {found} ± {error}");
            }
        }
        let (friction, error) = value(&result["axles"]["front"], "friction_n");
        assert!((8.0..20.0).contains(&friction), "{friction} ± {error}");
    }
    // The same part at every setting.
    for corner in ["fl", "fr"] {
        for key in ["spring_n_per_m", "friction_n", "tire_n_per_m"] {
            let found: Vec<_> = fits.iter().map(|result| value(&result["corners"][corner], key)).collect();
            let weights: f64 = found.iter().map(|(_, e)| e.powi(-2)).sum();
            let mean = found.iter().map(|(v, e)| v / e.powi(2)).sum::<f64>() / weights;
            let chi: f64 = found.iter().map(|(v, e)| ((v - mean) / e).powi(2)).sum();
            // Chi-square with three degrees of freedom: 1 % beyond 11.3.
            assert!(chi < 11.3, "{corner} {key}: {found:?}, chi-square {chi}");
        }
    }
    // Spectral peaks of the wheel: 9.92 Hz, with 100 N more 9.69 Hz, by the rig's description; a resolution of 0.25 Hz. Without a
    // damper they are clear, else what friction drives may hide them.
    for (result, hop) in fits.iter().zip([9.92, 9.92, 9.92, 9.69]) {
        let found = result["corners"]["fl"]["hop_hz"].as_f64();
        assert!(found.is_none_or(|found| (found - hop).abs() < 0.25), "{found:?} for {hop}");
    }
    assert!(fits[0]["corners"]["fl"]["hop_hz"].is_f64() && fits[3]["corners"]["fl"]["hop_hz"].is_f64());
}
