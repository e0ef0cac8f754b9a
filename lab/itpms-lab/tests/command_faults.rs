//! `itpms-lab faults`: the faults that take nothing.
#![cfg(unix)]

use crate::common::Bench;

#[test]
fn faults_are_tried_and_take_nothing() {
    let bench = Bench::new();
    let value: serde_json::Value = bench.json("--quiet faults --effort 5 --json");
    let faults = value["faults"].as_array().unwrap();
    assert_eq!(faults.len(), 11);
    for fault in faults {
        assert!(fault["tried"].as_u64().unwrap() > 0, "{fault}");
        assert_eq!(fault["lost"], 0, "{fault}");
    }
    // A kill that never met a save would have shown nothing.
    assert!(bench.names().is_empty(), "{:?}", bench.names());
}
