//! `itpms signals`: what is in a log, by its formats.
#![cfg(feature = "can")]
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can").join(name)
}

fn signals(arguments: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_itpms")).arg("signals").args(arguments).output().unwrap()
}

/// Two seconds: the speed at 50 Hz, one corner at 500 Hz, and once in a second an unknown frame.
fn bus_log(folder: &Path) -> PathBuf {
    let mut text = String::new();
    for i in 0..1000 {
        let time_s = 1_700_000_000.0 + f64::from(i) * 2e-3;
        if i % 10 == 0 {
            // 0x1F40 is 80 km/h.
            let _ = writeln!(text, "({time_s:.6}) can0 120#1F40000000000000");
        }
        // Body 0x03E8 is 2 m/s², axle 0xFC18 is -10 m/s².
        let _ = writeln!(text, "({:.6}) can0 210#E80318FC1400", time_s + 1e-4);
        if i % 500 == 0 {
            let _ = writeln!(text, "({:.6}) can0 7E8#0102", time_s + 2e-4);
        }
    }
    let path = folder.join("drive.log");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_bus_log_is_listed_with_rates_ranges_and_columns() {
    let folder = tempfile::tempdir().unwrap();
    let log = bus_log(folder.path());
    let map = folder.path().join("found.toml");
    let (dbc, own_map) = (example("car.dbc"), example("map.toml"));
    let output = signals(&[
        &log,
        "--dbc".as_ref(),
        &dbc,
        "--signals".as_ref(),
        &own_map,
        "--write-map".as_ref(),
        &map,
        "--json".as_ref(),
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&value["kind"], &value["samples"]), (&"message".into(), &1102.into()));
    let group = |id: &str| {
        value["groups"].as_array().unwrap().iter().find(|group| group["id"] == id).unwrap().clone()
    };
    assert_eq!((&group("120")["rate_hz"], &group("210")["rate_hz"]), (&50.0.into(), &500.0.into()));
    assert_eq!(group("7E8")["known"], false);
    let corner = group("210")["signals"].clone();
    assert_eq!((&corner[0]["column"], &corner[0]["min"]), (&"fl_body_accel_m_s2".into(), &2.0.into()));
    assert_eq!((&corner[1]["column"], &corner[1]["max"]), (&"fl_wheel_accel_m_s2".into(), &(-10.0).into()));
    // The other corners' messages are in the DBC, and did not come.
    assert!(value["not_in_log"].as_array().unwrap().contains(&"rr_wheel_accel_m_s2".into()));
    // What was found is a map that says the same.
    let again = signals(&[&log, "--dbc".as_ref(), &dbc, "--signals".as_ref(), &map, "--json".as_ref()]);
    let again: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["columns"].as_array().unwrap().len(), 17);
}

#[test]
fn a_person_reads_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let log = bus_log(folder.path());
    let output = signals(&[&log, "--dbc".as_ref(), &example("car.dbc")]);
    let text = String::from_utf8(output.stdout).unwrap();
    let line = |word: &str| text.lines().find(|line| line.contains(word)).unwrap_or_default().to_owned();
    assert!(text.contains("1 102 frames in 1.998"), "{text}");
    assert!(line("BodyAccZ_FL").ends_with("1 000    2    2  fl_body_accel_m_s2"), "{text}");
    assert!(text.contains("1 identifier without signals, not in the DBC:"), "{text}");
    assert!(text.contains("In the DBC, not in this log: Suspension_FR, Suspension_RL"), "{text}");
    assert!(
        text.contains(
            "fr_body_accel_m_s2 could be Suspension_FR.BodyAccZ_FR, which has no samples in this log"
        ),
        "{text}"
    );
    let missing = line("Not in this log, though it would be a column: ");
    assert!(missing.contains(" fr_body_accel_m_s2") && missing.contains(" rr_body_accel_m_s2"), "{text}");
    assert!(!missing.contains("fl_body_accel_m_s2") && !missing.contains("speed_m_s"), "{text}");
    assert!(text.contains("no signal for fl_wheel_accel_m_s2, so this corner cannot be estimated"), "{text}");
}
