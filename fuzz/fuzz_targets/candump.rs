//! Lines of candump of any bytes, as a file and one by one.
#![no_main]

use itpms_can_log::{FrameKind, candump};
use libfuzzer_sys::fuzz_target;

mod frames;

fuzz_target!(|bytes: &[u8]| {
    frames::read("log.log", bytes);
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for line in text.lines() {
        let Ok(parsed) = candump::parse_line(line) else { continue };
        let again = candump::format_line(&parsed.frame, "can0");
        let again = candump::parse_line(&again).expect("what is written is understood").frame;
        assert_eq!(again.kind, parsed.frame.kind);
        assert!(again.data() == parsed.frame.data() || again.kind == FrameKind::Error);
    }
});
