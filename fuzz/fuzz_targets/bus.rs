//! Frames in an MDF4 file of any bytes, and the description that may be inside.
#![no_main]

use itpms_data::frame_description;
use libfuzzer_sys::fuzz_target;

mod frames;
mod scratch;

fuzz_target!(|bytes: &[u8]| {
    frames::read("log.mf4", bytes);
    let _ = frame_description(&scratch::file("attached.mf4", bytes), None);
});
