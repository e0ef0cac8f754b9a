//! An MCAP file of any bytes, read as a drive log and listed. The library of its records panics on some contradictions, which the reader turns into
//! an end of the file: a panic ends the run only if it leaves the reader.
#![no_main]

use libfuzzer_sys::fuzz_target;

mod tables;

fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| tables::read("log.mcap", bytes)
);
