//! Lines of PEAK's traces (PCAN-View, PCAN-Explorer, loggers; `.trc` 1.0 to 2.1, PEAK CAN TRC File Format). Called through the reader of lines.
//!
//! Stamps are milliseconds since the start that the header has. What a line has in which place follows from the version, from 2.0 on from a line of the
//! header: `;$COLUMNS=N,O,T,B,I,d,R,L,D`. Buses count from one.
//!
//! CanHacker has the same extension for lines of its own: seconds, mostly with a comma, an identifier, a length, and the bytes.

use super::digits::{self, Base};
use super::frame::{CanFrame, CanId, Direction, FrameKind, Payload, length_of_code};
use super::line_format::{LineContent, LineFormat};
use super::lines::Words;

const EXPECTED_ID: &str = "an identifier of 4 hexadecimal digits (11 bits) or 8 (29 bits)";
const EXPECTED_DATA: &str = "a length and as many bytes";

/// Days from 30 December 1899, from which the header counts, to 1970.
const DAYS_TO_1970: f64 = 25_569.0;
const DAY_S: f64 = 86_400.0;

/// The columns of a version, by the letters that the header has from 2.0 on. `T` is the type, which up to 1.3 is the direction.
const V1_0: &[u8] = b"NOIL";
const V1_1: &[u8] = b"NOTIL";
const V1_2: &[u8] = b"NOBTIL";
const V1_3: &[u8] = b"NOBTIRL";

/// Columns that a header may name.
const MOST_COLUMNS: usize = 16;

#[derive(Debug)]
pub(super) struct Trc {
    /// In s since 1970; 0 if it does not say.
    start_s: f64,
    /// The letters of the columns before the data.
    columns: Vec<u8>,
    is_canhacker: bool,
}

impl Default for Trc {
    fn default() -> Self {
        // A header without a version is one of 1.0.
        Self { start_s: 0.0, columns: V1_0.to_vec(), is_canhacker: false }
    }
}

impl LineFormat for Trc {
    const EXPECTED: &'static str =
        "a line of a PEAK trace such as 1) 1059.9 Rx 0300 8 00 00 00 00 04 00 00 00";

    fn line(&mut self, text: &[u8]) -> Result<LineContent, &'static str> {
        let text = text.trim_ascii();
        match text.first() {
            None => Ok(LineContent::Nothing),
            Some(b';') => self.header(&text[1..]),
            Some(b'T') if Words::new(text).take(3).eq([b"Time".as_slice(), b"ID", b"DLC"]) => {
                self.is_canhacker = true;
                Ok(LineContent::Nothing)
            }
            Some(_) if self.is_canhacker || has_comma(text) => {
                self.is_canhacker = true;
                canhacker(text)
            }
            Some(_) => self.message(text),
        }
    }
}

impl Trc {
    fn header(&mut self, text: &[u8]) -> Result<LineContent, &'static str> {
        let text = text.trim_ascii();
        let (key, value) = match text.iter().position(|byte| *byte == b'=') {
            Some(place) => (&text[..place], text[place + 1..].trim_ascii()),
            None => return Ok(LineContent::Nothing),
        };
        match key {
            b"$FILEVERSION" => {
                self.columns = match value {
                    b"1.0" => V1_0,
                    b"1.1" => V1_1,
                    b"1.2" => V1_2,
                    b"1.3" => V1_3,
                    // The line of columns follows.
                    b"2.0" | b"2.1" => b"",
                    _ => return Err("a version of traces from 1.0 to 2.1"),
                }
                .to_vec();
            }
            b"$STARTTIME" => {
                let days = std::str::from_utf8(value).ok().and_then(|text| text.parse::<f64>().ok());
                let start_s = days.map(|days| ((days - DAYS_TO_1970) * DAY_S * 1e6).round() / 1e6);
                self.start_s =
                    start_s.filter(|start_s| (0.0..1e11).contains(start_s)).ok_or("days since 1899")?;
            }
            b"$COLUMNS" => {
                let letters: Vec<u8> = value
                    .split(|byte| *byte == b',')
                    .filter_map(|name| name.trim_ascii().first().copied())
                    .filter(|letter| *letter != b'D')
                    .collect();
                let needed = letters.contains(&b'O') && letters.contains(&b'T') && letters.contains(&b'I');
                if !needed || letters.len() > MOST_COLUMNS {
                    return Err("columns such as N,O,T,B,I,d,R,L,D");
                }
                self.columns = letters;
            }
            _ => {}
        }
        Ok(LineContent::Nothing)
    }

    fn message(&self, text: &[u8]) -> Result<LineContent, &'static str> {
        if self.columns.is_empty() {
            return Err("a line ;$COLUMNS= before the first message");
        }
        let mut words = Words::new(text);
        let mut cells = [None; MOST_COLUMNS];
        for cell in cells.iter_mut().take(self.columns.len()) {
            *cell = words.next();
        }
        let cell =
            |letter| self.columns.iter().position(|column| *column == letter).and_then(|place| cells[place]);
        let time_s = cell(b'O').and_then(digits::seconds).ok_or(Self::EXPECTED)? / 1e3 + self.start_s;
        let mut direction = cell(b'd');
        let kind = match cell(b'T') {
            // Up to 1.3: warnings and errors have a word of their own, their identifier is none.
            None => FrameKind::Data,
            Some(word @ (b"Rx" | b"Tx")) => {
                direction = Some(word);
                FrameKind::Data
            }
            Some(b"DT") => FrameKind::Data,
            Some(b"FD") => FrameKind::Fd { bit_rate_switch: false, error_state_indicator: false },
            Some(b"FB") => FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false },
            Some(b"FE") => FrameKind::Fd { bit_rate_switch: true, error_state_indicator: true },
            Some(b"BI") => FrameKind::Fd { bit_rate_switch: false, error_state_indicator: true },
            Some(b"RR") => FrameKind::Remote,
            Some(word) if word.iter().all(u8::is_ascii_alphabetic) => return Ok(LineContent::Event),
            Some(_) => return Err("a type of message such as Rx, Tx or DT"),
        };
        let id = cell(b'I').filter(|id| *id != b"FFFFFFFF");
        let Some(id) = id else { return Ok(LineContent::Event) };
        let number = digits::unsigned(id, Base::Hexadecimal).ok_or(EXPECTED_ID)?;
        let id = if id.len() > 4 { CanId::extended(number) } else { CanId::standard(number) };
        let bus = cell(b'B').map_or(Some(1), |bus| digits::unsigned(bus, Base::Decimal));
        let bus =
            bus.and_then(|bus| u16::try_from(bus.saturating_sub(1)).ok()).ok_or("a bus from 1 to 65535")?;
        let direction = if direction == Some(b"Tx") { Direction::Tx } else { Direction::Rx };
        let number = |letter| cell(letter).and_then(|cell| digits::unsigned(cell, Base::Decimal));
        let most = if matches!(kind, FrameKind::Fd { .. }) { 64 } else { 8 };
        let length = match (number(b'l'), number(b'L')) {
            (Some(length), _) => Some(length as usize),
            (None, Some(code)) if code <= 15 => Some(length_of_code(code as u8).min(most)),
            _ => None,
        };
        let length = length.filter(|length| *length <= most).ok_or(EXPECTED_DATA)?;
        let (kind, payload) = match words.clone().next() {
            Some(b"RTR") => (FrameKind::Remote, Payload::zeros(length)),
            _ if kind == FrameKind::Remote => (kind, Payload::zeros(length)),
            _ => (kind, words.bytes(length, Base::Hexadecimal)),
        };
        let (id, payload) = (id.ok_or(EXPECTED_ID)?, payload.ok_or(EXPECTED_DATA)?);
        Ok(LineContent::Frame(CanFrame { time_s, bus, id, kind, direction, payload }))
    }
}

/// Whether the first word is a number with a decimal comma, which PEAK's lines never have.
fn has_comma(text: &[u8]) -> bool {
    Words::new(text).next().is_some_and(|word| word.contains(&b','))
}

/// `0,005   110      8           04 00 17 00 00 00 00 00`.
fn canhacker(text: &[u8]) -> Result<LineContent, &'static str> {
    const EXPECTED: &str = "a line of CanHacker such as 0,005   110   2   04 00";
    let mut words = Words::new(text);
    let stamp = words.next().ok_or(EXPECTED)?;
    let stamp: Vec<u8> = stamp.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect();
    let time_s = digits::seconds(&stamp).ok_or(EXPECTED)?;
    let id = words.next().ok_or(EXPECTED)?;
    let number = digits::unsigned(id, Base::Hexadecimal).ok_or(EXPECTED_ID)?;
    let id = if id.len() > 4 { CanId::extended(number) } else { CanId::standard(number) };
    let length = words.next().and_then(|word| digits::unsigned(word, Base::Decimal));
    let length = length.filter(|length| *length <= 8).ok_or(EXPECTED_DATA)? as usize;
    let is_remote = words.clone().next() == Some(b"RTR");
    let kind = if is_remote { FrameKind::Remote } else { FrameKind::Data };
    let payload = if is_remote { Payload::zeros(length) } else { words.bytes(length, Base::Hexadecimal) };
    let (id, payload) = (id.ok_or(EXPECTED_ID)?, payload.ok_or(EXPECTED_DATA)?);
    Ok(LineContent::Frame(CanFrame { time_s, bus: 0, id, kind, direction: Direction::Rx, payload }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canhackers_lines_are_read_with_a_comma_or_a_point() {
        let head = "Time     ID        DLC       Data                    Comment\n";
        let comma = frames(&format!(
            "{head}0,005   110      2           04 FF \n12,250  18FEF100  1   0A\n13,000 111 8 RTR"
        ));
        assert_eq!((comma[0].time_s, comma[0].id), (0.005, CanId::standard(0x110).unwrap()));
        assert_eq!(comma[0].data(), [0x04, 0xFF]);
        assert_eq!((comma[1].time_s, comma[1].id), (12.25, CanId::extended(0x18FE_F100).unwrap()));
        assert_eq!((comma[2].kind, comma[2].length()), (FrameKind::Remote, 8));
        assert_eq!(frames(&format!("{head}0.005 110 2 04 FF")), comma[..1]);
        assert_eq!(frames("0,005 110 2 04 FF"), comma[..1], "without its header");
        for line in ["0,005 110 9 04", "0,005 800 0", "0,0,5 110 0", "0,005 110 2 04"] {
            assert!(Trc::default().line(line.as_bytes()).is_err(), "{line}");
        }
    }

    fn frames(text: &str) -> Vec<CanFrame> {
        crate::line_format::frames(Trc::default(), text)
    }

    // The examples of PEAK's description of the format.
    #[test]
    fn each_version_has_its_columns() {
        let data = [0x00, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00];
        let v1_0 = ";##########\n;   Start time: 11.09.2002\n     1)      1841 0001 8 00 00 00 00 04 00 00 00 \n     2)      1842 FFFFFFFF 4 00 00 00 08 -- -- -- -- BUSHEAVY";
        let v1_1 = ";$FILEVERSION=1.1\n;$STARTTIME=37704.5364870833\n     1)      1841.0  Rx         0001  8  00 00 00 00 04 00 00 00 \n     2)      1842.6  Warng  FFFFFFFF  4  00 00 00 08  BUSHEAVY";
        let v1_3 = ";$FILEVERSION=1.3\n;$STARTTIME=37704.5364870833\n     1)      1841.0 1  Rx        0001 -  8    00 00 00 00 04 00 00 00 ";
        let v2_0 = ";$FILEVERSION=2.0\n;$STARTTIME=37704.5364870833\n;$COLUMNS=N,O,T,I,d,l,D\n      1      1841.000 DT     0001 Rx 8  00 00 00 00 04 00 00 00 \n      2      1842.598 ST          Rx    00 00 00 08";
        let v2_1 = ";$FILEVERSION=2.1\n;$STARTTIME=37704.5364870833\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n      1      1841.000 DT 1      0001 Rx -  8    00 00 00 00 04 00 00 00 ";
        // 24 March 2003, 12:52:32.484.
        let start_s = 1_048_510_352.484;
        for (text, start_s) in
            [(v1_0, 0.0), (v1_1, start_s), (v1_3, start_s), (v2_0, start_s), (v2_1, start_s)]
        {
            let found = frames(text);
            assert_eq!(found.len(), 1, "{text}");
            // Half of the tenth decimal of a day is 4.3 us.
            let late_s = found[0].time_s - start_s - 1.841;
            assert!(late_s.abs() < 5e-6, "{late_s} {text}");
            assert_eq!((found[0].id, found[0].data()), (CanId::standard(1).unwrap(), &data[..]), "{text}");
            assert_eq!((found[0].bus, found[0].direction), (0, Direction::Rx));
        }
    }

    #[test]
    fn remote_extended_and_fd_messages_are_distinguished() {
        let head = ";$FILEVERSION=2.1\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n";
        let text = format!(
            "{head}1 1.0 RR 2 18FEF100 Tx - 8\n2 2.0 FB 1 0500 Rx - 9 00 01 02 03 04 05 06 07 08 09 0A 0B\n3 3.0 ER 1 0000 Rx - 5 04 00 02 00 00\n4 4 DT 1 07FF Rx - 0"
        );
        let found = frames(&text);
        assert_eq!(found.len(), 3);
        assert_eq!((found[0].kind, found[0].length(), found[0].bus), (FrameKind::Remote, 8, 1));
        assert_eq!((found[0].id, found[0].direction), (CanId::extended(0x18FE_F100).unwrap(), Direction::Tx));
        assert_eq!(found[1].kind, FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false });
        assert_eq!((found[1].length(), found[2].length()), (12, 0));
        assert_eq!(frames("5) 1 0123 2 RTR")[0].kind, FrameKind::Remote);
    }

    #[test]
    fn what_is_no_message_is_named() {
        for line in [
            "1) 1841 0001 8 00",
            "1) x 0001 8 00",
            "1) 1841 0001 9 00",
            "1) 1841 20000000 0",
            "1) 1841 0800 0",
            "hello",
        ] {
            assert!(Trc::default().line(line.as_bytes()).is_err(), "{line}");
        }
        let mut trc = Trc::default();
        assert!(trc.line(b";$FILEVERSION=3.0").is_err());
        trc.line(b";$FILEVERSION=2.1").unwrap();
        assert!(trc.line(b"1 1.0 DT 1 0001 Rx - 0").is_err());
    }
}
