//! A drive log of any bytes as text, plain or behind gzip.
#![no_main]

use libfuzzer_sys::fuzz_target;

mod tables;

fuzz_target!(|bytes: &[u8]| tables::read("drive.csv", bytes));
