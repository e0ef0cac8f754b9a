//! The Cortex-M4F: `examples/firmware`'s program `peers` under QEMU.

use std::process::{Command, Stdio};

use crate::host::{root, target_directory};
use crate::table::{Column, Table};

const TRIPLE: &str = "thumbv7em-none-eabihf";

/// Instructions a step in `f32`.
pub(crate) fn count(table: &mut Table) {
    const WHAT: &str = "instructions on a Cortex-M4F";
    if Command::new("qemu-system-arm").arg("--version").output().is_err() {
        table.skip(&format!("{WHAT}: QEMU for ARM is not installed (qemu-system-arm)"));
        return;
    }
    let libraries = Command::new("rustc").args(["--print", "target-libdir", "--target", TRIPLE]).output();
    let there = libraries
        .is_ok_and(|output| std::path::Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir());
    if !there {
        table.skip(&format!("{WHAT}: rustup target add {TRIPLE}"));
        return;
    }
    println!("building the controller's program; the first time takes minutes");
    let output = Command::new("cargo")
        .args(["run", "--quiet", "--locked", "--features", "peers", "--bin", "peers", "--target-dir"])
        .arg(target_directory().join("firmware"))
        // Its folder's .cargo/config.toml says how it is linked and run.
        .current_dir(root().join("examples/firmware"))
        .env_remove("CARGO_TARGET_DIR")
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo runs");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "the controller's program ended with {}: {printed}", output.status);
    for line in printed.lines() {
        // KEY MEAN LARGEST
        if let [key, mean, largest] = line.split(' ').collect::<Vec<_>>()[..] {
            table.put(key, Column::Controller, format!("{mean}, {largest}"));
        }
    }
}
