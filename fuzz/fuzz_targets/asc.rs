//! A ASC file of any bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

mod frames;

fuzz_target!(|bytes: &[u8]| frames::read("log.asc", bytes));
