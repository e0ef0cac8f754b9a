//! `itpms plot`: a log looked at without a vehicle file.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use std::fmt::Write as _;

use common::Bench;
use serde_json::Value;

fn simulated() -> Bench {
    let bench = Bench::new();
    bench.run("simulate drive-puncture --seed 1 -o drive.csv").success();
    bench
}

#[test]
fn a_drive_is_shown_on_one_page_whose_figures_are_the_logs() {
    let bench = simulated();
    let outcome = bench.run("plot drive.csv --json");
    let told: Value = serde_json::from_str(outcome.success()).unwrap();
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
    let wheel = &told["corners"]["rl"]["wheel_accel_m_s2"];
    assert_eq!(wheel["samples"].as_f64(), Some(count));
    assert!((wheel["mean"].as_f64().unwrap() - mean).abs() < 1e-9);
    assert!((wheel["sd"].as_f64().unwrap() / sd - 1.0).abs() < 1e-9);
    assert_eq!(wheel["highest"].as_f64(), values.iter().copied().reduce(f64::max));
    // A simulated body sits above its own wheel.
    for corner in ["fl", "fr", "rl", "rr"] {
        assert!(told["corners"][corner]["coherence"].as_f64().unwrap() > 0.5, "{told}");
    }
    assert_eq!(told["doubts"], Value::Array(vec![]), "{told}");
}

#[test]
fn columns_that_are_exchanged_and_one_that_stands_still_are_named() {
    let bench = simulated();
    let text = bench.read("drive.csv");
    let (head, rows) = text.split_once('\n').unwrap();
    let head = head
        .replace("fl_body_accel", "fl_x")
        .replace("fl_wheel_accel", "fl_body_accel")
        .replace("fl_x", "fl_wheel_accel");
    let at = head.split(',').position(|name| name == "fr_body_accel_m_s2").unwrap();
    let mut log = head.clone() + "\n";
    for row in rows.lines() {
        let cells: Vec<&str> =
            row.split(',').enumerate().map(|(i, cell)| if i == at { "0.25" } else { cell }).collect();
        writeln!(log, "{}", cells.join(",")).unwrap();
    }
    bench.write("wrong.csv", log);
    let outcome = bench.run("plot wrong.csv -o page.html");
    outcome.success();
    for word in ["fl: the body moves more than the wheel where wheels hop", "fr, body: always 0.25"] {
        assert!(outcome.stderr.contains(&format!("warning: {word}")), "{outcome:?}");
        assert!(bench.read("page.html").contains(word));
    }
}

#[test]
fn other_names_and_units_take_a_map() {
    let bench = simulated();
    let text = bench.read("drive.csv");
    let (head, rows) = text.split_once('\n').unwrap();
    bench.write("other.csv", format!("{}\n{rows}", head.replace("fl_wheel_accel_m_s2", "hub_vl")));
    let map = "[signals]\nfl_wheel_accel_m_s2 = { signal = \"hub_vl\", unit = \"m/s^2\" }\n";
    bench.write("map.toml", map);
    let of = |line: &str| -> Value { serde_json::from_str(bench.run(line).success()).unwrap() };
    let (plain, mapped) = (of("plot drive.csv --json"), of("plot other.csv --signals map.toml --json"));
    assert_eq!(plain["corners"]["fl"], mapped["corners"]["fl"]);
}

#[test]
fn numbers_of_any_size_are_shown() {
    let bench = Bench::new();
    for (number, name) in [("1e200", "large"), ("-1e308", "largest"), ("1e-320", "small"), ("inf", "none")] {
        let log = format!(
            "time_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2\n0,0,0\n0.005,{number},1\n0.01,1,{number}\n"
        );
        bench.write(&format!("{name}.csv"), log);
        bench.run(&format!("plot {name}.csv --trust-units")).success();
        let page = bench.read(&format!("{name}-plot.html"));
        assert!(page.len() < 200_000 && page.contains("Front left (fl)"), "{name}: {} bytes", page.len());
    }
}
