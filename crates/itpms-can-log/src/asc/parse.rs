//! One line of an ASC file. Called by the reader beside it; keeps nothing between lines.

use super::date;
use crate::digits::{self, Base};
use crate::frame::{CanFrame, CanId, Direction, FrameKind, Payload, length_of_code};
use crate::lines::Words;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum AscLine {
    /// Nothing that matters here: blank, a comment, another part of the header.
    Nothing,
    /// The log's beginning, in s since 1970; `None` if the date is not understood.
    Date(Option<f64>),
    /// The base of the numbers that follow, and whether stamps are differences.
    Base { base: Base, stamps: Stamps },
    /// A trigger block begins, in s since 1970; `None` if the date is not understood.
    Block(Option<f64>),
    /// A frame; its time is the stamp.
    Frame(CanFrame),
    /// An event that is no frame, with its stamp in s.
    Event(f64),
}

/// The origin of a file's stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stamps {
    /// The beginning of the measurement.
    Absolute,
    /// The event before.
    Relative,
}

pub(super) const EXPECTED: &str = "an ASC line such as 0.25 1 123 Rx d 2 DE AD";
const EXPECTED_CHANNEL: &str = "a channel from 1 to 65535";
const EXPECTED_ID: &str = "an identifier, with x if it has 29 bits";
const EXPECTED_DATA: &str = "d with a length and as many bytes, or r";
const EXPECTED_FD: &str = "BRS, ESI, DLC, length and as many bytes after the identifier of CANFD";

/// The content of a line, or the expected content.
pub(super) fn parse(line: &[u8], base: Base) -> Result<AscLine, &'static str> {
    let text = line.trim_ascii();
    let mut words = Words::new(text);
    let Some(first) = words.next() else { return Ok(AscLine::Nothing) };
    match digits::seconds(first) {
        Some(stamp_s) => stamped(stamp_s, &mut words, base),
        None => unstamped(first, &mut words),
    }
}

/// Header, trigger blocks, comments.
fn unstamped(first: &[u8], words: &mut Words<'_>) -> Result<AscLine, &'static str> {
    let is =
        |word: Option<&[u8]>, text: &str| word.is_some_and(|word| word.eq_ignore_ascii_case(text.as_bytes()));
    let first = Some(first);
    if is(first, "date") {
        Ok(AscLine::Date(date::parse(words.rest())))
    } else if is(first, "base") {
        let base = match words.next() {
            word if is(word, "hex") => Base::Hexadecimal,
            word if is(word, "dec") => Base::Decimal,
            _ => return Err("base hex or base dec"),
        };
        let is_relative = is(words.next(), "timestamps") && is(words.next(), "relative");
        Ok(AscLine::Base { base, stamps: if is_relative { Stamps::Relative } else { Stamps::Absolute } })
    } else if is(first, "begin") && is(words.next(), "triggerblock") {
        Ok(AscLine::Block(date::parse(words.rest())))
    } else if first.is_some_and(|word| word.starts_with(b"//"))
        || ["begin", "end", "internal", "no", "previous", "next", "split"].iter().any(|text| is(first, text))
    {
        // "no internal events logged", "previous log file: ...".
        Ok(AscLine::Nothing)
    } else {
        Err(EXPECTED)
    }
}

fn stamped(stamp_s: f64, words: &mut Words<'_>, base: Base) -> Result<AscLine, &'static str> {
    let bus = match words.next() {
        Some(b"CANFD") => return fd(stamp_s, words, base),
        Some(channel) if channel.iter().all(u8::is_ascii_digit) => bus_of(channel),
        _ => return Ok(AscLine::Event(stamp_s)),
    };
    let Some(id) = words.next() else { return Err(EXPECTED) };
    if id.eq_ignore_ascii_case(b"ErrorFrame") {
        return Ok(AscLine::Frame(error(stamp_s, bus?, Direction::Rx)));
    }
    let direction = match words.next() {
        Some(b"Rx") => Direction::Rx,
        Some(b"Tx") => Direction::Tx,
        // A request to send is followed by the frame itself; what has no direction is statistics and the like.
        _ => return Ok(AscLine::Event(stamp_s)),
    };
    let (kind, payload) = match words.next() {
        Some(b"d" | b"D") => (FrameKind::Data, classic_data(words, base)?),
        Some(b"r" | b"R") => (FrameKind::Remote, requested(words.clone().next(), base)),
        _ => return Err(EXPECTED_DATA),
    };
    let id = identifier(id, base).or_else(|| numeric_id(words.rest())).ok_or(EXPECTED_ID)?;
    Ok(AscLine::Frame(CanFrame { time_s: stamp_s, bus: bus?, id, kind, direction, payload }))
}

fn error(time_s: f64, bus: u16, direction: Direction) -> CanFrame {
    let id = CanId::extended_of(0);
    CanFrame { time_s, bus, id, kind: FrameKind::Error, direction, payload: Payload::EMPTY }
}

/// Channels count from one, buses from zero.
fn bus_of(channel: &[u8]) -> Result<u16, &'static str> {
    let channel = digits::unsigned(channel, Base::Decimal).ok_or(EXPECTED_CHANNEL)?;
    u16::try_from(channel.saturating_sub(1)).map_err(|_| EXPECTED_CHANNEL)
}

/// An identifier in the file's base, `x` after it for 29 bits.
fn identifier(text: &[u8], base: Base) -> Option<CanId> {
    match text {
        [number @ .., b'x' | b'X'] => CanId::extended(digits::unsigned(number, base)?),
        number => CanId::standard(digits::unsigned(number, base)?),
    }
}

/// The decimal identifier at the end of a line that has a symbolic name in its place: `Length = ... ID = 291`.
fn numeric_id(rest: &[u8]) -> Option<CanId> {
    let mut words = Words::new(rest);
    while let Some(word) = words.next() {
        if word == b"ID" && words.next() == Some(b"=") {
            return identifier(words.next()?, Base::Decimal);
        }
    }
    None
}

/// The length code and the bytes of a classic frame; codes above 8 mean 8 bytes.
fn classic_data(words: &mut Words<'_>, base: Base) -> Result<Payload, &'static str> {
    let code = words.next().and_then(|word| digits::unsigned(word, base)).filter(|code| *code <= 15);
    words.bytes(code.ok_or(EXPECTED_DATA)?.min(8) as usize, base).ok_or(EXPECTED_DATA)
}

/// The data length that a remote frame requests, where the line has it.
fn requested(word: Option<&[u8]>, base: Base) -> Payload {
    let code = word.and_then(|word| digits::unsigned(word, base)).unwrap_or(0);
    Payload::zeros(code.min(8) as usize).unwrap_or(Payload::EMPTY)
}

/// Bits of a CANFD line's flags: a remote frame, and a frame in the format of CAN FD.
const FLAG_REMOTE: u32 = 0x10;
const FLAG_FD: u32 = 0x1000;

/// An event on a bus that can carry CAN FD; it may be a classic frame all the same.
fn fd(stamp_s: f64, words: &mut Words<'_>, base: Base) -> Result<AscLine, &'static str> {
    let bus = bus_of(words.next().ok_or(EXPECTED_CHANNEL)?)?;
    let direction = match words.next() {
        Some(b"Rx") => Direction::Rx,
        Some(b"Tx") => Direction::Tx,
        _ => return Ok(AscLine::Event(stamp_s)),
    };
    let id = words.next().ok_or(EXPECTED_FD)?;
    if id.eq_ignore_ascii_case(b"ErrorFrame") {
        return Ok(AscLine::Frame(error(stamp_s, bus, direction)));
    }
    let id = identifier(id, base).ok_or(EXPECTED_ID)?;
    // A symbolic name may stand before the bit; no name begins with a digit.
    let mut switch = words.next().ok_or(EXPECTED_FD)?;
    if !switch.first().is_some_and(u8::is_ascii_digit) {
        switch = words.next().ok_or(EXPECTED_FD)?;
    }
    let bit = |word: Option<&[u8]>| match word {
        Some(b"0") => Ok(false),
        Some(b"1") => Ok(true),
        _ => Err(EXPECTED_FD),
    };
    let (bit_rate_switch, error_state_indicator) = (bit(Some(switch))?, bit(words.next())?);
    // The code is hexadecimal whatever the base is, and python-can writes it so, too.
    let code = words.next().and_then(|word| digits::unsigned(word, Base::Hexadecimal)).ok_or(EXPECTED_FD)?;
    let length = words.next().and_then(|word| digits::unsigned(word, Base::Decimal)).ok_or(EXPECTED_FD)?;
    let payload = words.bytes(length as usize, base).ok_or(EXPECTED_FD)?;
    // After the data: duration, length in bits, flags.
    let flags = words.nth(2).and_then(|word| digits::unsigned(word, Base::Hexadecimal));
    let is_plain = payload.len() <= 8 && !bit_rate_switch && !error_state_indicator;
    let (kind, payload) = match flags {
        Some(flags) if payload.is_empty() && flags & FLAG_REMOTE != 0 => {
            let length = length_of_code(code.min(8) as u8);
            (FrameKind::Remote, Payload::zeros(length).unwrap_or(Payload::EMPTY))
        }
        Some(flags) if is_plain && flags & FLAG_FD == 0 => (FrameKind::Data, payload),
        _ => (FrameKind::Fd { bit_rate_switch, error_state_indicator }, payload),
    };
    Ok(AscLine::Frame(CanFrame { time_s: stamp_s, bus, id, kind, direction, payload }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hex(line: &str) -> Result<AscLine, &'static str> {
        parse(line.as_bytes(), Base::Hexadecimal)
    }

    fn frame(line: &str) -> CanFrame {
        match hex(line) {
            Ok(AscLine::Frame(frame)) => frame,
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn classic_frames_are_read_as_canoe_writes_them() {
        let long = frame(
            "  3.098426 2  18EBFF00x       Tx d 8 01 A0 0F A6 60 3B D1 40    Length = 273910 BitCount = 141 ID = 418119424x",
        );
        assert_eq!((long.time_s, long.bus, long.direction), (3.098_426, 1, Direction::Tx));
        assert_eq!((long.id, long.kind), (CanId::extended(0x18EB_FF00).unwrap(), FrameKind::Data));
        assert_eq!(long.data(), [0x01, 0xA0, 0x0F, 0xA6, 0x60, 0x3B, 0xD1, 0x40]);
        assert_eq!(frame("0.1 1 3FF Tx d D 55 AA 01 02 03 04 05 06  Length = 1").length(), 8);
        assert_eq!(frame("0.1 1 EngineData Rx d 1 02 Length = 0 BitCount = 0 ID = 291").id.value(), 291);
        let Ok(AscLine::Frame(decimal)) = parse(b"0.1 1 291 Rx d 2 255 7", Base::Decimal) else { panic!() };
        assert_eq!((decimal.id.value(), decimal.data()), (0x123, &[255, 7][..]));
    }

    #[test]
    fn remote_and_error_frames_are_read() {
        let remote = frame("   2.584921 4 300 Rx r 8 Length = 1704000 BitCount = 145 ID = 88888888x");
        assert_eq!((remote.kind, remote.length(), remote.bus), (FrameKind::Remote, 8, 3));
        assert_eq!(frame("2.51 2 100 Rx r").length(), 0);
        assert_eq!(frame("2.52 3 200x Tx r Length = 1704000 BitCount = 145").length(), 0);
        assert_eq!(frame("4.5 2 ErrorFrame Flags = 0xe CodeExt = 0x20a2").kind, FrameKind::Error);
        assert_eq!(frame("30.8 CANFD   5 Tx ErrorFrame Not Acknowledge error").direction, Direction::Tx);
    }

    #[test]
    fn fd_lines_carry_fd_and_classic_frames() {
        let named = frame(
            "30.5 CANFD 62 Rx 167x VehicleOperatingModes 1 0 9 12 1 2 3 4 5 6 7 8 9 a b c 102187 133 323000 e000fb6c 0 0 0 0",
        );
        assert_eq!(named.kind, FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false });
        assert_eq!((named.bus, named.length(), named.id.is_extended()), (61, 12, true));
        let remote = frame("30.3 CANFD   3 Tx     50005x    0 1 5 0 140000 73 200050 7a60 46500250");
        assert_eq!((remote.kind, remote.length()), (FrameKind::Remote, 5));
        let classic = frame("30.3 CANFD 1 Rx 7d 0 0 2 2 11 22 102187 133 300000 0 0 0 0 0");
        assert_eq!((classic.kind, classic.data()), (FrameKind::Data, &[0x11, 0x22][..]));
        assert!(frame("30.3 CANFD 1 Rx 7d 0 0 0 0 102187 133 303000 0 0 0 0 0").is_fd());
        assert!(frame("30.3 CANFD 1 Rx 7d 0 0 1 1 ff").is_fd());
    }

    #[test]
    fn events_are_passed_over_and_headers_are_read() {
        for event in [
            "0.0 Start of measurement",
            "1.0 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%",
            "0.015991 CAN 1 Status:chip status error active",
            "3.297743 1  J1939TP FEE3p        6    0  0   -   Rx   d 23 A0 0F",
            "3.3 1 123 TxRq d 1 00",
        ] {
            assert!(matches!(hex(event), Ok(AscLine::Event(_))), "{event}: {:?}", hex(event));
        }
        assert_eq!(hex("no internal events logged"), Ok(AscLine::Nothing));
        assert_eq!(hex("// version 9.0.0"), Ok(AscLine::Nothing));
        assert_eq!(hex("End TriggerBlock"), Ok(AscLine::Nothing));
        assert_eq!(
            hex("base dec  timestamps relative"),
            Ok(AscLine::Base { base: Base::Decimal, stamps: Stamps::Relative })
        );
        assert_eq!(hex("date Sam Sep 30 15:06:13.191 2017"), Ok(AscLine::Date(Some(1_506_783_973.191))));
        assert_eq!(hex("Begin Triggerblock once"), Ok(AscLine::Block(None)));
    }

    #[test]
    fn broken_frames_are_not_events() {
        for line in [
            "0.1 1 123 Rx d 3 01 02",
            "0.1 1 123 Rx d",
            "0.1 1 123 Rx q 1 00",
            "0.1 1 1234 Rx d 1 00",
            "0.1 1 20000000x Rx d 1 00",
            "0.1 1 123 Rx d 1 100",
            "0.1 99999 123 Rx d 1 00",
            "0.1 CANFD 1 Rx 7d 1 0 9 12 1 2 3",
            "0.1 CANFD 1 Rx 7d 1 0 9 65 1 2 3",
            "0.1 CANFD",
            "hello",
        ] {
            assert!(hex(line).is_err(), "{line}: {:?}", hex(line));
        }
    }
}
