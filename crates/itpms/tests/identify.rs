//! `itpms lab identify` and `itpms lab calibrate` on the measurements under `examples/identify/`, and on damaged ones.

use std::fs;
use std::path::Path;

use crate::common::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/identify");
    for name in ["load-displacement.csv", "sine.csv", "tire-tests.csv"] {
        fs::copy(examples.join(name), bench.path(name)).unwrap();
    }
    bench
}

fn json(bench: &Bench, line: &str) -> serde_json::Value {
    bench.json(&format!("{line} --json"))
}

fn within(estimate: &serde_json::Value, truth: f64) {
    let (value, error) = (estimate["value"].as_f64().unwrap(), estimate["standard_error"].as_f64().unwrap());
    // Three standard errors: one example each, chosen before it was looked at.
    assert!((value - truth).abs() < 3.0 * error && error > 0.0 && error < 0.01 * truth, "{estimate}");
}

#[test]
fn the_example_spring_and_damper_are_those_of_the_bench() {
    let bench = bench();
    let spring = json(&bench, "identify spring load-displacement.csv --plot spring.svg");
    within(&spring["stiffness_n_per_m"], 20_663.0);
    assert_eq!(spring["concerns"].as_array().unwrap().len(), 0);
    let damper = json(&bench, "identify damper sine.csv --plot damper.svg");
    within(&damper["damping_n_s_per_m"], 435.2);
    assert_eq!(damper["runs"].as_array().unwrap().len(), 3);
    for name in ["spring.svg", "damper.svg"] {
        let svg = bench.read(name);
        assert!(
            svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"),
            "{name}"
        );
    }
    let text = bench.run("identify spring load-displacement.csv");
    assert!(text.success().starts_with("spring stiffness ks      2066"), "{text:?}");
    let text = bench.run("identify damper sine.csv");
    assert!(text.success().contains("concerns                 none"), "{text:?}");
}
