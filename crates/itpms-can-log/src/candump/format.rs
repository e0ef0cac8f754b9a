//! One frame to one line of `candump -L -x`. Called by the writer and by whoever prints frames.

use std::fmt::Write;

use super::parse::ERROR_FLAG;
use crate::frame::{CanFrame, Direction, FrameKind};

/// Class of an error of which the log says no more (`CAN_ERR_BUSERROR` of SocketCAN).
const BUS_ERROR: u32 = 0x80;

/// All classes of errors that SocketCAN has (linux/can/error.h).
const CLASSES: u32 = 0x3FF;

/// SocketCAN's class and details of an error. What comes from another format has the identifier of a frame, or none;
/// of that no class is made.
fn class_of(frame: &CanFrame) -> (u32, &[u8]) {
    match frame.id.value() {
        class @ 1..=CLASSES if frame.id.is_extended() => (class, frame.data()),
        _ => (BUS_ERROR, &[]),
    }
}

/// The line, without its end: time, interface, frame, and `R` or `T` for the direction. A time before 1970, infinite
/// or NaN is written as zero.
#[must_use]
pub fn format_line(frame: &CanFrame, interface: &str) -> String {
    let mut line = String::with_capacity(64);
    push_line(&mut line, frame, interface);
    line
}

pub(crate) fn push_line(out: &mut String, frame: &CanFrame, interface: &str) {
    let time_s = if frame.time_s.is_finite() { frame.time_s.max(0.0) } else { 0.0 };
    // Writing to a String does not fail.
    let _ = write!(out, "({time_s:017.6}) {interface} ");
    let _ = match frame.kind {
        FrameKind::Error => {
            let (class, details) = class_of(frame);
            let done = write!(out, "{:08X}#", class | ERROR_FLAG);
            push_bytes(out, details);
            done
        }
        _ => write!(out, "{}#", frame.id),
    };
    match frame.kind {
        FrameKind::Remote => {
            out.push('R');
            if frame.length() > 0 {
                let _ = write!(out, "{}", frame.length().min(8));
            }
        }
        FrameKind::Fd { bit_rate_switch, error_state_indicator } => {
            let flags = u8::from(bit_rate_switch) | u8::from(error_state_indicator) << 1;
            let _ = write!(out, "#{flags:X}");
            push_bytes(out, frame.data());
        }
        FrameKind::Data => push_bytes(out, frame.data()),
        FrameKind::Error => {}
    }
    out.push_str(match frame.direction {
        Direction::Rx => " R",
        Direction::Tx => " T",
    });
}

fn push_bytes(out: &mut String, bytes: &[u8]) {
    for byte in bytes {
        out.push(digit(byte >> 4));
        out.push(digit(byte & 15));
    }
}

fn digit(nibble: u8) -> char {
    char::from(if nibble < 10 { b'0' + nibble } else { b'A' + nibble - 10 })
}

#[cfg(test)]
mod tests {
    use super::super::parse_line;
    use super::*;

    #[test]
    fn a_line_that_is_read_is_written_again() {
        for line in [
            "(1436509052.249713) can0 123#DEADBEEF R",
            "(0000000000.000000) can1 12345678# T",
            "(1436509052.249713) can0 123#R R",
            "(1436509052.249713) can0 123#R8 R",
            "(1436509052.249713) can0 123##3112233445566778899AABBCC T",
            "(1436509052.249713) can0 20000004#0004000000000000 R",
        ] {
            let frame = parse_line(line).unwrap().frame;
            assert_eq!(format_line(&frame, &format!("can{}", frame.bus)), line);
        }
    }
}
