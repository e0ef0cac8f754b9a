//! A PEAK trace, a table of frames and a BUSMASTER log of any bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

mod frames;

fuzz_target!(|bytes: &[u8]| {
    for name in ["log.trc", "log.csv", "log.log"] {
        frames::read(name, bytes);
    }
});
