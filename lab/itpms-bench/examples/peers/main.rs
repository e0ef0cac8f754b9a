//! The published filter's step on every Kalman filter at hand, side by side: what the controller takes, what this machine takes, in
//! instructions, time and bytes. `cargo run --release -p itpms-bench --features peers --example peers`, from anywhere in the repository.
//!
//! Instructions on this machine need valgrind, those on a Cortex-M4F QEMU for ARM and `rustup target add thumbv7em-none-eabihf`, filterpy
//! a `python3` (or what `PYTHON` names) that has it. What is not there is skipped, and reported.
#![allow(clippy::expect_used, clippy::panic)] // A benchmark that cannot run has nothing to say.

mod controller;
mod host;
mod python;
mod rows;
mod table;

use std::env;

use rows::{Scalar, rows};

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.as_slice() {
        // Under valgrind: only what is counted.
        [option, key, scalar] if option == host::ONLY => host::run_only(key, scalar),
        [] => side_by_side(),
        _ => panic!("takes no arguments"),
    }
}

fn side_by_side() {
    let rows = rows();
    let mut table = table::Table::default();
    controller::count(&mut table);
    for row in &rows {
        for scalar in Scalar::BOTH {
            table.put(row.key, table::Column::Bytes(scalar), (row.bytes)(scalar).to_string());
        }
    }
    host::count(&rows, &mut table);
    host::time(&rows, &mut table);
    python::run(&mut table);
    table.print(&rows);
}
