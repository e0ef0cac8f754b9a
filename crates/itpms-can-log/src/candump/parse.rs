//! One line of text to one frame. Called by the reader beside it and from outside; keeps nothing between lines.

use itpms_files::Date;
use thiserror::Error;

use crate::digits::{self, Base, nibble};
use crate::frame::{CanFrame, CanId, Direction, FrameKind, Payload};
use crate::lines::Words;

/// A frame and what else its line says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// The frame. Its bus is the number at the end of the interface's name, 0 if there is none.
    pub frame: CanFrame,
    /// The interface's name.
    pub interface: &'a str,
    /// The origin of the time.
    pub clock: Clock,
}

/// The origin of a time stamp.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// 1970.
    Epoch,
    /// The first frame or the frame before: candump writes both alike, with at least three digits before the point
    /// where [`Clock::Epoch`] has ten.
    Relative,
}

/// Why a line is no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LineProblem {
    #[error("the line is blank")]
    Blank,
    #[error("the frame has no time stamp; log with candump -L, or with candump -ta on the screen")]
    NoTimeStamp,
    #[error("{0} frames were lost by the logger")]
    Lost(u64),
    #[error("expected {0}")]
    NotUnderstood(&'static str),
}

pub(crate) const EXPECTED: &str = "a line of candump such as (1436509052.249713) can0 123#DEADBEEF";
const EXPECTED_STAMP: &str = "a time such as (1436509052.249713) or (2015-07-10 06:17:32.249713)";
const EXPECTED_ID: &str = "an identifier of 3 or 8 hexadecimal digits";
const EXPECTED_DATA: &str = "pairs of hexadecimal digits, at most 8 or with ## 64";
const EXPECTED_BYTES: &str = "as many bytes as the brackets say";
const EXPECTED_FLAG: &str = "R or T or nothing after the data";

/// Flag of an error frame in the number before `#`, as in SocketCAN.
pub(super) const ERROR_FLAG: u32 = 0x2000_0000;

/// Stamps of [`Clock::Epoch`] are written with ten digits or more before the point.
const EPOCH_DIGITS: usize = 10;

/// The frame on a line of candump, in either form.
///
/// # Errors
/// There is none, or it has no time.
pub fn parse_line(line: &str) -> Result<Line<'_>, LineProblem> {
    parse(line.as_bytes())
}

/// [`parse_line`] for text that need not be UTF-8.
pub(super) fn parse(line: &[u8]) -> Result<Line<'_>, LineProblem> {
    let text = line.trim_ascii();
    if text.is_empty() || line.starts_with(b"\t") || text.starts_with(b"//") || matches!(text[0], b'#' | b';')
    {
        return Err(LineProblem::Blank);
    }
    if let Some(rest) = text.strip_prefix(b"DROPCOUNT: dropped ") {
        let count = Words::new(rest).next().and_then(|word| digits::unsigned(word, Base::Decimal));
        return Err(
            count.map_or(LineProblem::NotUnderstood(EXPECTED), |count| LineProblem::Lost(count.into()))
        );
    }
    let (stamp, rest) = split_stamp(text)?;
    let mut words = Words::new(rest);
    let (Some(interface), Some(word)) = (words.next(), words.next()) else {
        return Err(LineProblem::NotUnderstood(EXPECTED));
    };
    let Ok(interface) = std::str::from_utf8(interface) else {
        return Err(LineProblem::NotUnderstood(EXPECTED));
    };
    let mut frame = match word.iter().position(|byte| *byte == b'#') {
        Some(end) => log_form(&word[..end], &word[end + 1..], &mut words),
        None => screen_form(word, &mut words),
    }?;
    let (time_s, clock) = stamp.ok_or(LineProblem::NoTimeStamp)?;
    frame.time_s = time_s;
    frame.bus = bus_of(interface);
    Ok(Line { frame, interface, clock })
}

/// A time and what it counts from, where there is one.
type Stamp = Option<(f64, Clock)>;

/// The stamp in parentheses, if there is one, and what follows.
fn split_stamp(text: &[u8]) -> Result<(Stamp, &[u8]), LineProblem> {
    let Some(inner) = text.strip_prefix(b"(") else { return Ok((None, text)) };
    let wrong = LineProblem::NotUnderstood(EXPECTED_STAMP);
    let end = inner.iter().position(|byte| *byte == b')').ok_or(wrong)?;
    let stamp = inner[..end].trim_ascii();
    let stamp = match digits::seconds(stamp) {
        Some(time_s) => {
            let whole = stamp.iter().position(|byte| *byte == b'.').unwrap_or(stamp.len());
            (time_s, if whole >= EPOCH_DIGITS { Clock::Epoch } else { Clock::Relative })
        }
        None => (date_and_time(stamp).ok_or(wrong)?, Clock::Epoch),
    };
    Ok((Some(stamp), &inner[end + 1..]))
}

/// Seconds since 1970 of `2015-07-10 06:17:32.249713`, taken as UTC.
fn date_and_time(text: &[u8]) -> Option<f64> {
    let mut fields = text.splitn(6, |byte| matches!(byte, b'-' | b' ' | b':'));
    let mut number = || digits::unsigned(fields.next()?, Base::Decimal);
    let (year, month, day) = (number()?, number()?, number()?);
    let (hour, minute) = (number()?, number()?);
    let last = fields.next()?;
    let whole = last.iter().position(|byte| *byte == b'.').unwrap_or(last.len());
    let second = digits::unsigned(&last[..whole], Base::Decimal)?;
    let fraction_s = if whole < last.len() { digits::seconds(&last[whole..])? } else { 0.0 };
    let date = Date { year: year.into(), month, day, hour, minute, second };
    Some(date.seconds()? as f64 + fraction_s)
}

fn bus_of(interface: &str) -> u16 {
    let start = interface.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    interface[start..].parse().unwrap_or(0)
}

/// `123#DEADBEEF`, `123#R8`, `123##1DEADBEEF`, with `R` or `T` after it.
fn log_form(id: &[u8], data: &[u8], words: &mut Words<'_>) -> Result<CanFrame, LineProblem> {
    let (id, is_error) = identifier(id)?;
    let (kind, payload) = match data {
        _ if is_error => (FrameKind::Error, pairs(data, 8)?),
        [b'R' | b'r', length @ ..] => (FrameKind::Remote, requested(length)?),
        [b'#', flags, data @ ..] => {
            let flags = nibble(*flags).ok_or(LineProblem::NotUnderstood(EXPECTED_DATA))?;
            (fd(flags & 1 != 0, flags & 2 != 0), pairs(data, Payload::MOST)?)
        }
        _ => (FrameKind::Data, pairs(data, 8)?),
    };
    let direction = match words.next() {
        None | Some(b"R" | b"r") => Direction::Rx,
        Some(b"T" | b"t") => Direction::Tx,
        Some(_) => return Err(LineProblem::NotUnderstood(EXPECTED_FLAG)),
    };
    if !words.rest().is_empty() {
        return Err(LineProblem::NotUnderstood(EXPECTED_FLAG));
    }
    Ok(CanFrame { time_s: 0.0, bus: 0, id, kind, direction, payload })
}

fn fd(bit_rate_switch: bool, error_state_indicator: bool) -> FrameKind {
    FrameKind::Fd { bit_rate_switch, error_state_indicator }
}

/// The identifier, and whether it is that of an error frame.
fn identifier(text: &[u8]) -> Result<(CanId, bool), LineProblem> {
    let wrong = LineProblem::NotUnderstood(EXPECTED_ID);
    let number = digits::unsigned(text, Base::Hexadecimal).ok_or(wrong)?;
    let id = match text.len() {
        ..=3 => CanId::standard(number),
        8 if number & ERROR_FLAG != 0 => return Ok((CanId::extended_of(number), true)),
        4..=8 => CanId::extended(number),
        _ => None,
    };
    Ok((id.ok_or(wrong)?, false))
}

/// The data length that a remote frame requests: nothing, a digit, and perhaps the raw code after `_`.
fn requested(text: &[u8]) -> Result<Payload, LineProblem> {
    let wrong = LineProblem::NotUnderstood("a length of 0 to 8 after R");
    match without_raw_code(text) {
        [] => Ok(Payload::EMPTY),
        [digit @ b'0'..=b'8'] => Payload::zeros(usize::from(digit - b'0')).ok_or(wrong),
        _ => Err(wrong),
    }
}

/// Pairs of digits, with or without points between them.
fn pairs(text: &[u8], most: usize) -> Result<Payload, LineProblem> {
    let wrong = LineProblem::NotUnderstood(EXPECTED_DATA);
    let mut rest = without_raw_code(text);
    let mut payload = Payload::EMPTY;
    while let [high, low, after @ ..] = rest {
        if *high == b'.' {
            rest = &rest[1..];
            continue;
        }
        let byte = digits::byte(&[*high, *low]).ok_or(wrong)?;
        if payload.len() >= most || !payload.push(byte) {
            return Err(wrong);
        }
        rest = after;
    }
    if rest.is_empty() { Ok(payload) } else { Err(wrong) }
}

/// Classic frames of 8 bytes may have been sent with a length code of 9 to 15; it follows as `_9` to `_F` and says nothing about the data.
fn without_raw_code(text: &[u8]) -> &[u8] {
    match text {
        [data @ .., b'_', code] if matches!(nibble(*code), Some(9..)) => data,
        _ => text,
    }
}

/// `123   [3]  DE AD BE`, before it perhaps `RX B -`, after it perhaps text.
fn screen_form(first: &[u8], words: &mut Words<'_>) -> Result<CanFrame, LineProblem> {
    let wrong = LineProblem::NotUnderstood(EXPECTED);
    let mut id = first;
    let mut direction = Direction::Rx;
    let mut switches = (false, false);
    if let b"RX" | b"TX" = first {
        direction = if first == b"TX" { Direction::Tx } else { Direction::Rx };
        switches = match (words.next(), words.next()) {
            (Some(rate @ (b"B" | b"-")), Some(state @ (b"E" | b"-"))) => (rate == b"B", state == b"E"),
            _ => return Err(LineProblem::NotUnderstood("the columns B or -, E or - after RX or TX")),
        };
        id = words.next().ok_or(wrong)?;
    }
    let (id, is_error) = identifier(id)?;
    let (length, is_fd) = bracketed(words.next().ok_or(wrong)?)?;
    let (kind, payload) = if words.rest().starts_with(b"remote request") && !is_fd {
        (FrameKind::Remote, Payload::zeros(length).ok_or(wrong)?)
    } else {
        let kind = match (is_error, is_fd) {
            (true, _) => FrameKind::Error,
            (false, true) => fd(switches.0, switches.1),
            (false, false) => FrameKind::Data,
        };
        (kind, spaced(length, words)?)
    };
    Ok(CanFrame { time_s: 0.0, bus: 0, id, kind, direction, payload })
}

/// The length, and whether it is that of a CAN FD frame: `[8]` and `[08]`; `{9}` is 8 bytes with a raw code of 9.
fn bracketed(word: &[u8]) -> Result<(usize, bool), LineProblem> {
    let wrong = LineProblem::NotUnderstood("a length in brackets, [0] to [8] or [00] to [64]");
    match word {
        [b'[', digit @ b'0'..=b'8', b']'] => Ok((usize::from(digit - b'0'), false)),
        [b'{', code, b'}'] if matches!(nibble(*code), Some(9..)) => Ok((8, false)),
        [b'[', tens @ b'0'..=b'6', ones @ b'0'..=b'9', b']'] => {
            let length = usize::from(tens - b'0') * 10 + usize::from(ones - b'0');
            if length <= Payload::MOST { Ok((length, true)) } else { Err(wrong) }
        }
        _ => Err(wrong),
    }
}

/// So many bytes, each a word of two digits; then the end, the same as text (`candump -a`), or `ERRORFRAME`.
fn spaced(length: usize, words: &mut Words<'_>) -> Result<Payload, LineProblem> {
    let wrong = LineProblem::NotUnderstood(EXPECTED_BYTES);
    let mut payload = Payload::EMPTY;
    for _ in 0..length {
        let byte = words.next().and_then(digits::byte).ok_or(wrong)?;
        if !payload.push(byte) {
            return Err(wrong);
        }
    }
    match words.rest() {
        [] | [b'\'', ..] => Ok(payload),
        rest if rest.starts_with(b"ERRORFRAME") => Ok(payload),
        _ => Err(wrong),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(line: &str) -> CanFrame {
        parse_line(line).unwrap_or_else(|problem| panic!("{line}: {problem}")).frame
    }

    fn standard(value: u32) -> CanId {
        CanId::standard(value).unwrap()
    }

    #[test]
    fn the_log_form_is_read_as_can_utils_describes_it() {
        let line = parse_line("(1436509052.249713) can3 123#DEADBEEF").unwrap();
        assert_eq!((line.interface, line.clock), ("can3", Clock::Epoch));
        assert_eq!(line.frame.time_s, 1_436_509_052.249_713);
        assert_eq!((line.frame.bus, line.frame.id, line.frame.kind), (3, standard(0x123), FrameKind::Data));
        assert_eq!(line.frame.data(), [0xDE, 0xAD, 0xBE, 0xEF]);
        assert_eq!(line.frame.direction, Direction::Rx);

        assert_eq!(frame("(0.0) can0 123#").data(), [0_u8; 0]);
        assert_eq!(frame("(0.0) can0 12345678#00 T").id, CanId::extended(0x1234_5678).unwrap());
        assert_eq!(frame("(0.0) can0 00000123#00 T").direction, Direction::Tx);
        assert_eq!(frame("(0.0) can0 123#11.22.33 R").data(), [0x11, 0x22, 0x33]);
        assert_eq!(frame("(0.0) can0 123#1122334455667788_B").length(), 8);
    }

    #[test]
    fn remote_fd_and_error_frames_are_distinguished() {
        let remote = frame("(0.0) can0 123#R8");
        assert_eq!((remote.kind, remote.length(), remote.data().len()), (FrameKind::Remote, 8, 0));
        assert_eq!(frame("(0.0) can0 123#R").length(), 0);
        let fast = frame("(0.0) can0 123##1112233445566778899AABBCC");
        assert_eq!(fast.kind, FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false });
        assert_eq!(fast.length(), 12);
        assert_eq!(frame("(0.0) can0 123##2").kind, fd(false, true));
        let error = frame("(0.0) can0 20000080#0000000000000000");
        assert_eq!((error.kind, error.id.value(), error.length()), (FrameKind::Error, 0x80, 8));
    }

    #[test]
    fn the_screen_form_is_read_with_and_without_its_columns() {
        let plain = frame(" (1436509052.249713)  can0  123   [4]  DE AD BE EF");
        assert_eq!(plain, frame("(1436509052.249713) can0 123#DEADBEEF"));
        let short = frame("  (000.250000)  vcan2  TX - -  12345678   [2]  01 02   '..'");
        assert_eq!((short.time_s, short.bus, short.direction), (0.25, 2, Direction::Tx));
        assert_eq!(frame(" (000.000000)  can0  123  [08]  01 02 03 04 05 06 07 08").kind, fd(false, false));
        assert_eq!(frame(" (0.0)  can0  RX B E  123  [01]  01").kind, fd(true, true));
        let remote = frame(" (0.0)  can0  123   [3]  remote request");
        assert_eq!((remote.kind, remote.length()), (FrameKind::Remote, 3));
        let error = frame(" (0.0)  can0  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME");
        assert_eq!((error.kind, error.id.value()), (FrameKind::Error, 4));
        let dated = frame(" (2015-07-10 06:17:32.250000)  can0  123   [0] ");
        assert_eq!(dated.time_s, 1_436_509_052.25);
    }

    #[test]
    fn what_is_no_frame_says_why() {
        let problem = |line| parse_line(line).unwrap_err();
        assert_eq!(problem("   "), LineProblem::Blank);
        assert_eq!(problem("# written by hand"), LineProblem::Blank);
        assert_eq!(problem("\tbus-error"), LineProblem::Blank);
        assert_eq!(problem("  can0  123   [4]  DE AD BE EF"), LineProblem::NoTimeStamp);
        assert_eq!(problem("can0 123#DEADBEEF"), LineProblem::NoTimeStamp);
        assert_eq!(
            problem("DROPCOUNT: dropped 5 CAN frames on 'can0' socket (total drops 5)"),
            LineProblem::Lost(5)
        );
        for line in [
            "(0.0) can0",
            "(0.0) can0 FFF#00",
            "(0.0) can0 80000123#00",
            "(0.0) can0 123#112",
            "(0.0) can0 123#112233445566778899",
            "(0.0) can0 123#11 X",
            "(0.0) can0 123#11 R more",
            "(0.0) can0 123#R9",
            "(soon) can0 123#11",
            "(0.0 can0 123#11",
            " (0.0)  can0  123   [4]  DE AD BE",
            " (0.0)  can0  123   [2]  DE AD BE",
            " (0.0)  can0  123   [65]  DE",
            "time,id,data",
        ] {
            assert!(matches!(problem(line), LineProblem::NotUnderstood(_)), "{line}: {:?}", parse_line(line));
        }
    }
}
