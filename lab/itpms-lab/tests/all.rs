//! Studies through the crate's public face, and the program from outside.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod command_certify;
mod command_faults;
mod command_reproduce;
mod command_score;
mod command_soak;
#[path = "../../../crates/itpms/tests/common/mod.rs"]
mod common;
mod gravity;
mod malfunction;
mod observability_page;
mod paper;
mod rear_load;
mod unnamed_faults;

/// What studies refuse, and what they give in words.
#[cfg(target_os = "linux")]
#[test]
fn studies() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    common::session::replay(folder, "studies", &common::Bench::new());
}

/// The program that `common` runs.
const PROGRAM: &str = env!("CARGO_BIN_EXE_itpms-lab");
