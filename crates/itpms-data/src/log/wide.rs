//! Text of two bytes per character (UTF-16), as Excel's "Unicode text" and some loggers on Windows write it, as UTF-8.
//!
//! Called by the lines of text tables, which look at the first bytes.

use std::io::{self, BufRead, Read};

const CHUNK: usize = 1 << 13;
const HIGH: std::ops::Range<u16> = 0xd800..0xdc00;

/// Which of a character's two bytes comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    LowFirst,
    HighFirst,
}

impl Order {
    /// Of a text with these first bytes: its byte order mark says so, or zeros beside each of two plain characters.
    pub(super) fn of(first: &[u8]) -> Option<Self> {
        match first {
            [0xff, 0xfe, ..] => Some(Self::LowFirst),
            [0xfe, 0xff, ..] => Some(Self::HighFirst),
            [1..=0x7f, 0, 1..=0x7f, 0, ..] => Some(Self::LowFirst),
            [0, 1..=0x7f, 0, 1..=0x7f, ..] => Some(Self::HighFirst),
            _ => None,
        }
    }
}

#[derive(Debug)]
pub(super) struct Wide<R> {
    input: R,
    order: Order,
    text: Vec<u8>,
    handed_out: usize,
    /// Half a character, and the first of the two that stand for a rare one.
    half: Option<u8>,
    high: Option<u16>,
    is_at_begin: bool,
}

impl<R: BufRead> Wide<R> {
    pub(super) fn new(input: R, order: Order) -> Self {
        Self { input, order, text: Vec::new(), handed_out: 0, half: None, high: None, is_at_begin: true }
    }

    /// Takes the next bytes; false at the end.
    fn refill(&mut self) -> io::Result<bool> {
        self.text.clear();
        self.handed_out = 0;
        let bytes = self.input.fill_buf()?;
        let bytes = bytes[..bytes.len().min(CHUNK)].to_vec();
        self.input.consume(bytes.len());
        for byte in &bytes {
            let Some(first) = self.half.take() else {
                self.half = Some(*byte);
                continue;
            };
            let unit = match self.order {
                Order::LowFirst => u16::from_le_bytes([first, *byte]),
                Order::HighFirst => u16::from_be_bytes([first, *byte]),
            };
            self.take(unit);
        }
        Ok(!bytes.is_empty())
    }

    fn take(&mut self, unit: u16) {
        if std::mem::take(&mut self.is_at_begin) && unit == 0xfeff {
            return;
        }
        let before = self.high.take();
        let is_first = HIGH.contains(&unit);
        self.high = is_first.then_some(unit);
        let units = before.into_iter().chain((!is_first).then_some(unit));
        for character in char::decode_utf16(units) {
            let mut bytes = [0; 4];
            let character = character.unwrap_or(char::REPLACEMENT_CHARACTER);
            self.text.extend_from_slice(character.encode_utf8(&mut bytes).as_bytes());
        }
    }
}

impl<R: BufRead> Read for Wide<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while self.handed_out == self.text.len() {
            if !self.refill()? {
                return Ok(0);
            }
        }
        let left = &self.text[self.handed_out..];
        let count = left.len().min(bytes.len());
        bytes[..count].copy_from_slice(&left[..count]);
        self.handed_out += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8], capacity: usize) -> Option<String> {
        let order = Order::of(bytes)?;
        let mut text = String::new();
        Wide::new(io::BufReader::with_capacity(capacity, bytes), order).read_to_string(&mut text).ok()?;
        Some(text)
    }

    #[test]
    fn both_orders_with_and_without_a_mark() {
        let text = "time_s\tBeschl. [m/s\u{b2}]\t\u{2212}1\t\u{1f697}\r\n0,5\t1\r\n";
        let units: Vec<u16> = text.encode_utf16().collect();
        let low: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let high: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        let marked = |mark: &[u8], bytes: &[u8]| [mark, bytes].concat();
        for bytes in [marked(b"\xff\xfe", &low), marked(b"\xfe\xff", &high), low, high] {
            for capacity in [1, 3, 1 << 16] {
                assert_eq!(decoded(&bytes, capacity).as_deref(), Some(text));
            }
        }
        assert_eq!(decoded(b"time_s,v\n", 8), None);
        // Halves of a pair, and of a character at the end.
        assert_eq!(decoded(b"\xff\xfea\0\x00\xd8b\0\x00\xdcc", 8).as_deref(), Some("a\u{fffd}b\u{fffd}"));
    }
}
