//! Studies through the crate's public face.
//!
//! One program: the estimators are generic, and every program that uses them compiles them anew.

mod gravity;
mod identify_coverage;
mod identify_parts;
mod malfunction;
mod observability_page;
mod paper;
mod part_bench;
mod plot;
mod rear_load;
mod report;
mod synthetic;
