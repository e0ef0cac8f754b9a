//! The version with its commit: that of `ITPMS_COMMIT` where it is set, else of the clone that is built, else none.
//!
//! `.ci/release-build` sets it, so that a clone and an archive of the same commit give the same bytes.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=ITPMS_COMMIT");
    println!("cargo::rerun-if-changed=build.rs");
    let commit = env::var("ITPMS_COMMIT").ok().or_else(cloned).unwrap_or_default();
    let commit = if commit.is_empty() { commit } else { format!(" ({commit})") };
    println!("cargo::rustc-env=ITPMS_VERSION={}{commit}", env!("CARGO_PKG_VERSION"));
}

/// The commit of the workspace's own clone; a package inside of another's has none.
fn cloned() -> Option<String> {
    if !Path::new("../../.git").exists() {
        return None;
    }
    // Written whenever HEAD moves.
    println!("cargo::rerun-if-changed={}", git(&["rev-parse", "--git-path", "logs/HEAD"])?);
    git(&["rev-parse", "--short=10", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
