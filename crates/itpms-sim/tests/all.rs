//! The simulated world through the crate's public face.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail as tests do")]

mod bench;
mod drive;
mod full_car;
mod real_car;
mod road;
mod scenario;
mod simulation;
mod torsion;
mod wheel_speeds;
