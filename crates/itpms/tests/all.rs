//! The command from outside: arguments in, files, text and exit codes out.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod advice;
mod cold_pressure;
mod common;
mod events;
mod field;
mod fleet;
mod hostile_files;
mod identify;
mod identify_bump;
mod mcap;
mod monitor;
mod owners_path;
mod plot;
mod pulses;
mod reference;
mod rotation;
mod roughness;
mod simulate;
mod simulated_wheel_speeds;
mod slow_leak;
mod slow_speed;
mod surveyed_road;
mod transcript;
mod truck;
mod vehicle;
mod vehicle_learn;
mod wheel_speeds;

/// The program that `common` runs.
const PROGRAM: &str = env!("CARGO_BIN_EXE_itpms");
