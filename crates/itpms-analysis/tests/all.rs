//! Analyses through the crate's public face.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

mod identify_coverage;
mod identify_parts;
mod part_bench;
mod plot;
mod report;
mod report_suspension;
mod synthetic;
