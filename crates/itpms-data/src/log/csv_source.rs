//! Rows from CSV: commas (or semicolons, tabs, bars), a header line, `#` comments, blank lines, quotes where somebody used them.
//!
//! A line is a row, as everywhere with measurements; therefore lines are split here, and every message can name the
//! line an editor shows. (General CSV readers count records, and lose count at comments and blank lines.)

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::header::{Header, shortened};
use super::row::{RawRow, SLOTS, Slot};
use super::{clock_text, mapped};
use crate::error::{DataError, Place, Problem};
use crate::input::MOST_OF_A_LINE;
use crate::signals::SignalMap;

#[derive(Debug)]
pub(super) struct CsvSource {
    lines: Lines,
    header: Header,
    dialect: Dialect,
    bytes: u64,
    cut_off: bool,
}

impl CsvSource {
    /// `bytes`: the file's length, for the progress.
    pub(super) fn new(
        path: &Path,
        file: File,
        bytes: u64,
        map: Option<&SignalMap>,
    ) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        let mut lines = Lines::new(file);
        if !lines.advance().map_err(fail)? {
            return Err(fail(Problem::Empty));
        }
        let dialect = Dialect::of(lines.text());
        let header = mapped::header(path, &dialect.names(lines.text()), map)?;
        Ok(Self { lines, header, dialect, bytes, cut_off: false })
    }

    pub(super) fn header(&self) -> &Header {
        &self.header
    }

    /// Whether the last line has no line end: the logger lost its power, and the last number may be another one.
    pub(super) fn cut_off(&self) -> bool {
        self.cut_off
    }

    pub(super) fn progress(&self) -> f64 {
        (self.lines.position as f64 / self.bytes.max(1) as f64).min(1.0)
    }

    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        if !self.lines.advance()? {
            return Ok(None);
        }
        let place = Place::Line(self.lines.number);
        *row = [f64::NAN; SLOTS];
        let expected = self.header.slots.len();
        let mut found = 0;
        let mut bad_cell = None;
        for cell in self.dialect.cells(self.lines.text()) {
            if let Some(Some(slot)) = self.header.slots.get(found) {
                let time = || clock_text::seconds(cell).filter(|_| *slot == Slot::Time);
                let value = self.dialect.number(cell).map(|value| self.header.in_our_unit(found, value));
                match value.or_else(time) {
                    Some(value) => row[slot.index()] = value,
                    None => bad_cell = bad_cell.or(Some((*slot, cell))),
                }
            }
            found += 1;
        }
        if found <= expected && !self.lines.is_terminated() {
            self.cut_off = true;
            return Ok(None);
        }
        if found != expected {
            return Err(Problem::CellCount { place, found, expected });
        }
        match bad_cell {
            None => Ok(Some(place)),
            Some((slot, cell)) => Err(Problem::NotANumber {
                place,
                column: slot.name(),
                found: shortened(&String::from_utf8_lossy(cell)),
            }),
        }
    }
}

/// How a file separates cells and decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    separator: u8,
}

impl Dialect {
    /// That of a file with this header: commas, or, where it has none between its names, `;`, tabs or `|`. Where commas
    /// separate nothing, they may be decimal ones.
    pub(crate) fn of(header: &[u8]) -> Self {
        let one = cells_by(header, b',').nth(1).is_none();
        let other = *b";\t|".iter().find(|separator| header.contains(separator)).unwrap_or(&b',');
        Self { separator: if one { other } else { b',' } }
    }

    /// The names in the header.
    pub(crate) fn names(self, header: &[u8]) -> Vec<String> {
        self.cells(header).map(|name| String::from_utf8_lossy(name).into_owned()).collect()
    }

    /// The cells of a line.
    pub(crate) fn cells(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        cells_by(line, self.separator)
    }

    /// The number in a cell, as [`number`] has it.
    pub(crate) fn number(self, cell: &[u8]) -> Option<f64> {
        let decimal = || {
            let text = std::str::from_utf8(cell).ok()?;
            let (whole, fraction) = text.split_once(',').filter(|_| self.separator != b',')?;
            number(format!("{whole}.{fraction}").as_bytes())
        };
        number(cell).or_else(decimal)
    }
}

/// The lines that say something.
#[derive(Debug)]
pub(crate) struct Lines {
    input: BufReader<File>,
    line: Vec<u8>,
    number: u64,
    position: u64,
}

impl Lines {
    pub(crate) fn new(file: File) -> Self {
        let input = BufReader::with_capacity(1 << 16, file);
        Self { input, line: Vec::new(), number: 0, position: 0 }
    }

    /// Number of the present line, from one.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Bytes read so far.
    pub(crate) fn position(&self) -> u64 {
        self.position
    }

    /// Goes to the next line that is neither blank nor a comment; false at the end.
    pub(crate) fn advance(&mut self) -> Result<bool, Problem> {
        loop {
            self.line.clear();
            let mut limited = (&mut self.input).take(MOST_OF_A_LINE);
            let length = limited.read_until(b'\n', &mut self.line).map_err(Problem::Read)? as u64;
            if length == 0 {
                return Ok(false);
            }
            self.number += 1;
            self.position += length;
            if length == MOST_OF_A_LINE {
                return Err(Problem::LongLine { line: self.number, most: MOST_OF_A_LINE });
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                // The byte order mark with which some programs begin a text file.
                self.line.drain(..3);
            }
            if self.number == 1 && (self.line.starts_with(b"\xff\xfe") || self.line.starts_with(b"\xfe\xff"))
            {
                return Err(Problem::Utf16);
            }
            if !self.text().is_empty() && self.text()[0] != b'#' {
                return Ok(true);
            }
        }
    }

    pub(crate) fn text(&self) -> &[u8] {
        self.line.trim_ascii()
    }

    fn is_terminated(&self) -> bool {
        self.line.ends_with(b"\n")
    }
}

/// The cells of a line, trimmed and out of their quotes. A comma inside quotes separates nothing.
pub(crate) fn cells(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    cells_by(line, b',')
}

fn cells_by(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    let mut quoted = false;
    line.split(move |byte| {
        quoted ^= *byte == b'"';
        *byte == separator && !quoted
    })
    .map(|cell| {
        let cell = cell.trim_ascii();
        cell.strip_prefix(b"\"").and_then(|cell| cell.strip_suffix(b"\"")).unwrap_or(cell).trim_ascii()
    })
}

/// The number in a cell: NaN for what is missing or infinite, `None` for what is no number.
pub(crate) fn number(cell: &[u8]) -> Option<f64> {
    if cell.is_empty() || cell.eq_ignore_ascii_case(b"null") {
        return Some(f64::NAN);
    }
    let value: f64 = std::str::from_utf8(cell).ok()?.parse().ok()?;
    Some(if value.is_finite() { value } else { f64::NAN })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_has_many_spellings_and_text_is_not_one_of_them() {
        for missing in ["", "NaN", "nan", "null", "NULL", "inf", "-inf"] {
            assert!(number(missing.as_bytes()).unwrap().is_nan(), "{missing}");
        }
        assert_eq!(number(b"-1.5e-3"), Some(-1.5e-3));
        for text in ["fast", "1,5", "0x10", "12 m", "--"] {
            assert!(number(text.as_bytes()).is_none(), "{text}");
        }
    }

    #[test]
    fn where_commas_separate_nothing_they_are_decimal() {
        let semicolons = Dialect::of(b"time_s;fl_body_accel_m_s2;v");
        assert_eq!(semicolons.names(b"time_s; \"a;b\" ;v"), ["time_s", "a;b", "v"]);
        assert_eq!(semicolons.cells(b"0,5;-1,25e1;").count(), 3);
        for (text, value) in [("0,5", 0.5), ("-1,25e1", -12.5), ("1.5", 1.5), ("7", 7.0)] {
            assert_eq!(semicolons.number(text.as_bytes()), Some(value), "{text}");
        }
        assert!(semicolons.number(b"").unwrap().is_nan());
        for text in ["1.000,5", "1,000,5", ",", "a,b"] {
            assert_eq!(semicolons.number(text.as_bytes()), None, "{text}");
        }
        let commas = Dialect::of(b"time_s,a;b");
        assert_eq!((commas.cells(b"1,2;3").count(), commas.number(b"1,5")), (2, None));
        assert_eq!(Dialect::of(b"time_s\tv").names(b"time_s\tv"), ["time_s", "v"]);
        assert_eq!(Dialect::of(b"time_s").names(b"time_s"), ["time_s"]);
    }

    #[test]
    fn cells_come_out_of_blanks_and_quotes() {
        let split = |line: &'static str| {
            cells(line.as_bytes()).map(|cell| std::str::from_utf8(cell).unwrap()).collect::<Vec<_>>()
        };
        assert_eq!(split("1, 2 ,3"), ["1", "2", "3"]);
        assert_eq!(split("\"time_s\",\"a, b\",,"), ["time_s", "a, b", "", ""]);
    }
}
