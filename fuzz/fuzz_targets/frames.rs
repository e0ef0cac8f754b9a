//! What holds for a CAN log of any format, whatever is in it.

use itpms_can_log::{FrameKind, FrameReader, candump};

#[path = "scratch.rs"]
mod scratch;

/// Reads a log to its end or its error.
pub fn read(name: &str, bytes: &[u8]) {
    let path = scratch::file(name, bytes);
    let Ok(mut reader) = FrameReader::open(&path) else { return };
    let mut frames = 0_usize;
    while let Ok(Some(frame)) = reader.next_frame() {
        frames += 1;
        assert!(frame.data().len() <= 64 && frame.time_s.is_finite());
        assert!((0.0..=1.0).contains(&reader.progress()));
        // The shortest object of a BLF inflates from less than one byte, the shortest line has ten.
        assert!(frames <= bytes.len() * 1032, "more frames than the bytes can hold");
        if frames % 16 == 0 {
            let line = candump::format_line(&frame, "can0");
            let again = candump::parse_line(&line).expect("what is written is understood").frame;
            assert_eq!(again.kind, frame.kind);
            assert!(again.data() == frame.data() || frame.kind == FrameKind::Error);
        }
    }
    reader.repairs().warnings().iter().for_each(|warning| assert!(!warning.is_empty()));
    assert!(reader.next_frame().is_ok_and(|frame| frame.is_none()), "an end or an error is the end");
}
