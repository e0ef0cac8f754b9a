//! filterpy, in Python: `peers.py` on the same samples.

use std::env;
use std::io::Write;
use std::process::{Command, Stdio};

use itpms_bench::peers::corner::Drive;
use itpms_bench::peers::{Peer, STEPS, on_nalgebra, ours};

use crate::host::root;
use crate::rows::{Scalar, samples};
use crate::table::{Column, Table};

/// How far apart two programs in `f64` may be, of a quantity's largest value; as in `tests/peers.rs`.
const TOLERANCE: f64 = 1e-10;

/// Nanoseconds a step, of a filter that finds what ours finds.
pub(crate) fn run(table: &mut Table) {
    let python = env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_it = Command::new(&python).args(["-c", "import filterpy"]).stderr(Stdio::null()).status();
    if !has_it.is_ok_and(|status| status.success()) {
        table.skip(&format!("filterpy: {python} does not have it (pip install filterpy)"));
        return;
    }
    let mut child = Command::new(&python)
        .arg(root().join("lab/itpms-bench/examples/peers/peers.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python runs");
    let text = serde_json::to_string(&samples::<f64>().iter().map(<[f64; 2]>::as_slice).collect::<Vec<_>>());
    child.stdin.take().expect("its input").write_all(text.expect("numbers").as_bytes()).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "peers.py ended with {}", output.status);
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).expect("peers.py prints JSON");
    for (key, expected) in [
        ("filterpy", found::<ours::Dense<f64>>()),
        ("ordinary-filterpy", found::<on_nalgebra::Ordinary<f64>>()),
    ] {
        compare(key, &said[key]["found"], &expected);
    }
    for key in ["filterpy", "without-factor-filterpy", "ordinary-filterpy"] {
        let nanoseconds = said[key]["nanoseconds"].as_f64().expect("a time");
        table.put(key, Column::Time(Scalar::F64), format!("{nanoseconds:.0}"));
    }
}

fn found<P: Peer>() -> Vec<[f64; 6]> {
    let (mut filter, mut drive) = (P::fresh(), Drive::default());
    (0..STEPS)
        .map(|_| {
            filter.step(drive.sample());
            filter.found()
        })
        .collect()
}

fn compare(key: &str, found: &serde_json::Value, expected: &[[f64; 6]]) {
    for quantity in 0..6 {
        let size = expected.iter().fold(0.0f64, |size, at| size.max(at[quantity].abs()));
        for (step, expected) in expected.iter().enumerate() {
            let found = found[step][quantity].as_f64().unwrap_or(f64::NAN);
            let apart = (found - expected[quantity]).abs() / size;
            assert!(apart <= TOLERANCE, "{key}: quantity {quantity} is {apart:e} apart at step {step}");
        }
    }
}
