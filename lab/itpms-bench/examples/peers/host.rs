//! This machine: instructions under valgrind's callgrind, time by criterion.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{env, fs};

use itpms_bench::peers::STEPS;

use crate::rows::{Row, Scalar, rows};
use crate::table::{Column, Table};

/// Option of this program under valgrind.
pub(crate) const ONLY: &str = "--only";

/// The steps of one filter and nothing else.
pub(crate) fn run_only(key: &str, scalar: &str) {
    let rows = rows();
    let row = rows.iter().find(|row| row.key == key).expect("a key of a row");
    let scalar = Scalar::BOTH.into_iter().find(|known| known.label() == scalar).expect("f32 or f64");
    (row.run)(scalar);
}

/// Instructions a step: of all that `counted_step` does, over the steps.
pub(crate) fn count(rows: &[Row], table: &mut Table) {
    if Command::new("valgrind").arg("--version").output().is_err() {
        table.skip("instructions on this machine: valgrind is not installed");
        return;
    }
    let program = env::current_exe().expect("this program");
    for row in rows {
        for scalar in Scalar::BOTH {
            let output = Command::new("valgrind")
                .args([
                    "--tool=callgrind",
                    "--callgrind-out-file=/dev/null",
                    "--toggle-collect=*counted_step*",
                ])
                .arg(&program)
                .args([ONLY, row.key, scalar.label()])
                .output()
                .expect("valgrind runs");
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}, {}: {said}", row.key, scalar.label());
            let collected =
                said.lines().find_map(|line| line.split_once("Collected :")).map(|(_, count)| count.trim());
            let count: f64 = collected.and_then(|count| count.parse().ok()).expect("callgrind's sum");
            assert!(count > 0.0, "callgrind does not know the function by its name");
            table.put(row.key, Column::Host(scalar), format!("{:.0}", count / STEPS as f64));
        }
    }
}

/// Nanoseconds a step: the fastest of criterion's samples, as other programs on the machine slow the rest down.
pub(crate) fn time(rows: &[Row], table: &mut Table) {
    let directory = target_directory().join("peers-criterion");
    let mut criterion = criterion::Criterion::default()
        .without_plots()
        .output_directory(&directory)
        .sample_size(50)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for row in rows {
        for scalar in Scalar::BOTH {
            let id = format!("{}-{}", row.key, scalar.label());
            (row.time)(scalar, &mut criterion, &id);
            let file = directory.join(&id).join("new/sample.json");
            let text = fs::read_to_string(&file).expect("criterion's samples");
            let samples: serde_json::Value =
                serde_json::from_str(&text).expect("criterion's samples are JSON");
            let numbers = |name: &str| -> Vec<f64> {
                samples[name].as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
            };
            let (times, runs) = (numbers("times"), numbers("iters"));
            let all = times.iter().zip(&runs).map(|(time, runs)| time / runs).min_by(f64::total_cmp);
            let all = all.expect("samples");
            table.put(row.key, Column::Time(scalar), format!("{:.0}", all / STEPS as f64));
        }
    }
}

/// Where cargo has put this program: `target/release/examples/peers`.
pub(crate) fn target_directory() -> PathBuf {
    let program = env::current_exe().expect("this program");
    program.ancestors().nth(3).expect("a target directory").to_path_buf()
}

/// The repository.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
