//! A drive log of any bytes as Parquet. The library that decodes it panics on some contradictions, which the reader turns into an error:
//! a panic ends the run only if it leaves the reader.
#![no_main]

use libfuzzer_sys::fuzz_target;

mod tables;

fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| tables::read("drive.parquet", bytes)
);
