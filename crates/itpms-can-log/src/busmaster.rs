//! Lines of BUSMASTER's logs. Called through the reader of lines.
//!
//! Between asterisks stands what the lines that follow mean: the date, hexadecimal or decimal numbers, and whether stamps are the time of day, the time since the
//! beginning, or since the line before. Channels count from one.

use itpms_files::Date;

use super::digits::{self, Base};
use super::frame::{CanFrame, CanId, Direction, FrameKind, Payload};
use super::line_format::{LineContent, LineFormat};
use super::lines::Words;

pub(super) const BEGINNING: &[u8] = b"***BUSMASTER";

const EXPECTED_TIME: &str = "a time such as 14:11:30:0210";
const EXPECTED_DATA: &str = "a length and as many bytes";

/// The header lines so far.
#[derive(Debug)]
pub(super) struct Busmaster {
    base: Base,
    stamps: Stamps,
    /// Beginning of the first day, and of the log, in s since 1970; 0 if it does not say.
    day_s: f64,
    start_s: f64,
    /// The stamp before, or the sum of all.
    stamp_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stamps {
    TimeOfDay,
    SinceBeginning,
    Differences,
}

impl Default for Busmaster {
    fn default() -> Self {
        Self { base: Base::Hexadecimal, stamps: Stamps::TimeOfDay, day_s: 0.0, start_s: 0.0, stamp_s: 0.0 }
    }
}

impl LineFormat for Busmaster {
    const EXPECTED: &'static str =
        "a line of a BUSMASTER log such as 14:11:30:0210 Rx 1 0x7DF s 8 02 09 02 CC CC CC CC CC";

    fn line(&mut self, text: &[u8]) -> Result<LineContent, &'static str> {
        let text = text.trim_ascii();
        if let Some(text) = text.strip_prefix(b"***") {
            return self.header(text.strip_suffix(b"***").unwrap_or(text).trim_ascii());
        }
        if text.is_empty() { Ok(LineContent::Nothing) } else { self.message(text) }
    }
}

impl Busmaster {
    fn header(&mut self, text: &[u8]) -> Result<LineContent, &'static str> {
        match text {
            b"HEX" => self.base = Base::Hexadecimal,
            b"DEC" => self.base = Base::Decimal,
            b"SYSTEM MODE" => self.stamps = Stamps::TimeOfDay,
            b"ABSOLUTE MODE" => self.stamps = Stamps::SinceBeginning,
            b"RELATIVE MODE" => self.stamps = Stamps::Differences,
            b"PROTOCOL CAN" => {}
            text if text.starts_with(b"PROTOCOL ") => return Err("PROTOCOL CAN"),
            text => {
                if let Some(date) = text.strip_prefix(b"START DATE AND TIME") {
                    (self.day_s, self.start_s) =
                        date_of(date).ok_or("a date such as 21:9:2014 14:11:29:843")?;
                    self.stamp_s = 0.0;
                }
            }
        }
        Ok(LineContent::Nothing)
    }

    fn message(&mut self, text: &[u8]) -> Result<LineContent, &'static str> {
        let mut words = Words::new(text);
        let stamp_s = words.next().and_then(|word| time_of(word, 1e4)).ok_or(EXPECTED_TIME)?;
        let direction = match words.next() {
            Some(b"Rx") => Direction::Rx,
            Some(b"Tx") => Direction::Tx,
            _ => return Ok(LineContent::Event),
        };
        let channel = words.next().and_then(|word| digits::unsigned(word, Base::Decimal));
        let bus = channel.and_then(|channel| u16::try_from(channel.saturating_sub(1)).ok());
        let bus = bus.ok_or("a channel from 1 to 65535")?;
        let number = words
            .next()
            .and_then(|word| digits::unsigned(word.strip_prefix(b"0x").unwrap_or(word), self.base));
        let kind = words.next().unwrap_or_default();
        let (is_extended, is_remote) = (kind.contains(&b'x'), kind.contains(&b'r'));
        if kind.is_empty() || !kind.iter().all(|letter| b"sxr".contains(letter)) {
            return Err("a type of message: s, x, sr or xr");
        }
        let id = number.and_then(|id| if is_extended { CanId::extended(id) } else { CanId::standard(id) });
        let id = id.ok_or("an identifier, with x behind it if it has 29 bits")?;
        let length =
            words.next().and_then(|word| digits::unsigned(word, Base::Decimal)).map(|length| length as usize);
        let length = length.filter(|length| *length <= Payload::MOST).ok_or(EXPECTED_DATA)?;
        let payload = if is_remote { Payload::zeros(length) } else { words.bytes(length, self.base) };
        let payload = payload.ok_or(EXPECTED_DATA)?;
        let kind = match is_remote {
            true => FrameKind::Remote,
            false if length > 8 => FrameKind::Fd { bit_rate_switch: false, error_state_indicator: false },
            false => FrameKind::Data,
        };
        let time_s = self.time_s(stamp_s);
        Ok(LineContent::Frame(CanFrame { time_s, bus, id, kind, direction, payload }))
    }

    fn time_s(&mut self, stamp_s: f64) -> f64 {
        /// A time of day that falls by more than this is one of the next day.
        const HALF_A_DAY_S: f64 = 43_200.0;
        match self.stamps {
            Stamps::SinceBeginning => return self.start_s + stamp_s,
            Stamps::Differences => {
                self.stamp_s += stamp_s;
                return self.start_s + self.stamp_s;
            }
            Stamps::TimeOfDay => {}
        }
        if stamp_s < self.stamp_s - HALF_A_DAY_S {
            self.day_s += 86_400.0;
        }
        self.stamp_s = stamp_s;
        self.day_s + stamp_s
    }
}

/// Beginning of the day and moment of `21:9:2014 14:11:29:843`, in s since 1970.
fn date_of(text: &[u8]) -> Option<(f64, f64)> {
    let mut words = Words::new(text);
    let mut parts =
        words.next()?.split(|byte| *byte == b':').map(|part| digits::unsigned(part, Base::Decimal));
    let (day, month, year) = (parts.next()??, parts.next()??, parts.next()??);
    let date = Date { year: i64::from(year), month, day, hour: 0, minute: 0, second: 0 };
    let day_s = date.seconds()? as f64;
    Some((day_s, day_s + time_of(words.next()?, 1e3)?))
}

/// Seconds of `14:11:30:0210`, whose last part counts so many to a second; fewer than three parts are none.
fn time_of(text: &[u8], per_second: f64) -> Option<f64> {
    let mut parts =
        text.split(|byte| *byte == b':').map(|part| digits::unsigned(part, Base::Decimal).map(f64::from));
    let (hours, minutes, seconds, rest) = (parts.next()??, parts.next()??, parts.next()??, parts.next()??);
    let whole = parts.next().is_none() && minutes < 60.0 && seconds < 61.0 && rest < per_second;
    whole.then_some(hours * 3600.0 + minutes * 60.0 + seconds + rest / per_second)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "***BUSMASTER Ver 2.4.0***\n***PROTOCOL CAN***\n***[START LOGGING SESSION]***\n***START DATE AND TIME 21:9:2014 23:59:59:500***\n";

    fn frames(text: &str) -> Vec<CanFrame> {
        crate::line_format::frames(Busmaster::default(), text)
    }

    #[test]
    fn each_clock_and_base_is_read() {
        // 21 September 2014, 00:00.
        let day_s = 1_411_257_600.0;
        let text = format!(
            "{HEAD}***HEX***\n***SYSTEM MODE***\n23:59:59:9990 Rx 1 0x7DF s 2 02 CC\n00:00:00:0010 Tx 2 0x18DAF110 x 1 FF"
        );
        let found = frames(&text);
        assert!(
            (found[0].time_s - day_s - 86_399.999).abs() < 1e-6
                && (found[1].time_s - day_s - 86_400.001).abs() < 1e-6
        );
        assert_eq!((found[0].id, found[0].data()), (CanId::standard(0x7DF).unwrap(), &[0x02, 0xCC][..]));
        assert_eq!((found[1].bus, found[1].direction, found[1].id.is_extended()), (1, Direction::Tx, true));
        let text = format!(
            "{HEAD}***DEC***\n***RELATIVE MODE***\n0:0:0:5000 Rx 1 291 s 1 200\n0:0:0:5000 Rx 1 291 sr 8"
        );
        let found = frames(&text);
        assert_eq!(
            (found[0].id.value(), found[0].data(), found[1].kind),
            (291, &[200][..], FrameKind::Remote)
        );
        assert_eq!([found[0].time_s, found[1].time_s], [day_s + 86_400.0, day_s + 86_400.5]);
        let found = frames(&format!("{HEAD}***ABSOLUTE MODE***\n0:0:1:0000 Rx 1 0x1 s 0"));
        assert_eq!(found[0].time_s, day_s + 86_400.5);
    }

    #[test]
    fn what_is_no_message_is_named() {
        for line in [
            "14:11:30 Rx 1 0x1 s 0",
            "14:11:30:0210 Rx 1 0x800 s 0",
            "14:11:30:0210 Rx 1 0x1 s 2 00",
            "14:11:30:0210 Rx 1 0x1 q 0",
            "***PROTOCOL LIN***",
        ] {
            assert!(Busmaster::default().line(line.as_bytes()).is_err(), "{line}");
        }
    }
}
