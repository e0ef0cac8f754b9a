//! `itpms plot`: a log looked at without a vehicle file.

use serde_json::Value;

use crate::common::Bench;

fn simulated() -> Bench {
    let bench = Bench::new();
    bench.run("simulate drive-puncture --seed 1 -o drive.csv").success();
    bench
}

#[test]
fn a_drive_is_shown_on_one_page_whose_figures_are_the_logs() {
    let bench = simulated();
    let outcome = bench.run("plot drive.csv --json");
    let reported: Value = serde_json::from_str(outcome.success()).unwrap();
    assert_eq!(bench.names(), ["drive-plot.html", "drive.csv"]);
    assert!(outcome.stderr.contains("wrote drive-plot.html"), "{outcome:?}");
    let page = bench.read("drive-plot.html");
    for word in [
        "Front left (fl)",
        "Rear right (rr)",
        "Coherence of body and wheel",
        "Spectra",
        "Pressure in the log",
    ] {
        assert!(page.contains(word), "{word}");
    }
    // The shell's own script, which asks for day or night, and nothing that is loaded.
    assert!(page.matches("<script").count() == 1 && !page.contains("src=") && !page.contains("href="));
    // Against the file itself.
    let text = bench.read("drive.csv");
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|name| name == "rl_wheel_accel_m_s2").unwrap();
    let values: Vec<f64> = lines.filter_map(|line| line.split(',').nth(at)?.parse().ok()).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let sd = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let wheel = &reported["corners"]["rl"]["wheel_accel_m_s2"];
    assert_eq!(wheel["samples"].as_f64(), Some(count));
    assert!((wheel["mean"].as_f64().unwrap() - mean).abs() < 1e-9);
    assert!((wheel["sd"].as_f64().unwrap() / sd - 1.0).abs() < 1e-9);
    assert_eq!(wheel["highest"].as_f64(), values.iter().copied().reduce(f64::max));
    // A simulated body sits above its own wheel.
    for corner in ["fl", "fr", "rl", "rr"] {
        assert!(reported["corners"][corner]["coherence"].as_f64().unwrap() > 0.5, "{reported}");
    }
    assert_eq!(reported["doubts"], Value::Array(vec![]), "{reported}");
}
