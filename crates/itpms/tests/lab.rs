//! `itpms lab`: the studies under it and without it, and the faults that take nothing.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common;

use common::Bench;

const STUDIES: [&str; 9] = [
    "simulate",
    "score",
    "soak",
    "certify",
    "malfunctions",
    "identify",
    "calibrate",
    "observability",
    "reproduce",
];

/// The names in a list of commands.
fn listed(help: &str) -> Vec<String> {
    let commands =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = commands.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

#[test]
fn studies_are_listed_under_lab_alone_and_go_on_without_it() {
    let bench = Bench::new();
    let top = listed(bench.run("--help").success());
    let lab = listed(bench.run("lab --help").success());
    assert!(top.contains(&"estimate".to_owned()) && top.contains(&"lab".to_owned()), "{top:?}");
    for study in STUDIES {
        assert!(
            !top.contains(&study.to_owned()) && lab.contains(&study.to_owned()),
            "{study}: {top:?} {lab:?}"
        );
        let [old, new] =
            [format!("{study} --help"), format!("lab {study} --help")].map(|line| bench.run(&line));
        let body = |help: &str| help.split_once("Usage:").unwrap().0.to_owned();
        assert_eq!(body(old.success()), body(new.success()));
    }
    bench.run("simulate paper-drop --seed 3 -o old.csv").success();
    bench.run("lab simulate paper-drop --seed 3 -o new.csv").success();
    assert_eq!(bench.read("old.csv"), bench.read("new.csv"));
    for shell in ["bash", "zsh", "fish"] {
        let script = bench.run(&format!("completions {shell}"));
        assert!(STUDIES.iter().all(|study| script.success().contains(study)), "{shell}");
    }
}

#[cfg(all(feature = "live", unix))]
#[test]
fn faults_are_tried_and_take_nothing() {
    let bench = Bench::new();
    let outcome = bench.run("--quiet lab faults --effort 5 --json");
    let value: serde_json::Value = serde_json::from_str(outcome.success()).unwrap();
    let faults = value["faults"].as_array().unwrap();
    assert_eq!(faults.len(), 11);
    for fault in faults {
        assert!(fault["tried"].as_u64().unwrap() > 0, "{fault}");
        assert_eq!(fault["lost"], 0, "{fault}");
    }
    // A kill that never met a save would have shown nothing.
    assert!(bench.names().is_empty(), "{:?}", bench.names());
    let refused = bench.run("lab faults --only nonsense");
    assert!(
        refused.refusal().starts_with("--only nonsense: no such fault, there are: state: killed"),
        "{refused:?}"
    );
}
