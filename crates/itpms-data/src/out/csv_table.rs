//! The table as CSV: commas, `\n`, numbers in the shortest form that reads back as the same bits.
//!
//! Our names contain neither commas nor quotes and are never quoted; text is where it has to be (RFC 4180).

use std::io::Write as _;

use itpms_files::AtomicFile;

use super::cell::{Cell, Kind};
use crate::error::{DataError, FileProblem};

#[derive(Debug)]
pub(super) struct CsvTable {
    file: AtomicFile,
    line: Vec<u8>,
}

impl CsvTable {
    pub(super) fn new(mut file: AtomicFile, columns: &[(String, Kind)]) -> Result<Self, DataError> {
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        file.append(names.join(",").as_bytes())?;
        file.append(b"\n")?;
        Ok(Self { file, line: Vec::new() })
    }

    pub(super) fn write(&mut self, cells: &[Cell<'_>]) -> Result<(), DataError> {
        self.line.clear();
        for (i, cell) in cells.iter().enumerate() {
            if i > 0 {
                self.line.push(b',');
            }
            match cell {
                Cell::Number(value) => number(&mut self.line, *value)
                    .map_err(|error| DataError::new(self.file.target(), FileProblem::Write(error)))?,
                Cell::Flag(true) => self.line.extend_from_slice(b"true"),
                Cell::Flag(false) => self.line.extend_from_slice(b"false"),
                Cell::Label(text) => label(&mut self.line, text),
            }
        }
        self.line.push(b'\n');
        Ok(self.file.append(&self.line)?)
    }

    pub(super) fn finish(mut self) -> Result<AtomicFile, DataError> {
        self.file.settle()?;
        Ok(self.file)
    }
}

/// Text, in quotes where it would be read otherwise, and behind an apostrophe where a spreadsheet would compute it.
fn label(out: &mut Vec<u8>, text: &str) {
    let inert =
        if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text.to_owned() };
    let text = inert.as_str();
    if text.contains([',', '"', '\n', '\r']) {
        out.push(b'"');
        out.extend_from_slice(text.replace('"', "\"\"").as_bytes());
        out.push(b'"');
    } else {
        out.extend_from_slice(text.as_bytes());
    }
}

/// Shortest digits that round-trip; an exponent only where positions would need many zeros.
fn number(out: &mut Vec<u8>, value: f64) -> std::io::Result<()> {
    let size = value.abs();
    if value.is_nan() {
        Ok(())
    } else if size == 0.0 || (1e-5..1e16).contains(&size) {
        write!(out, "{value}")
    } else {
        write!(out, "{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_quoted_where_it_has_to_be() {
        let text = |value| {
            let mut out = Vec::new();
            label(&mut out, value);
            String::from_utf8(out).unwrap()
        };
        assert_eq!(text("low"), "low");
        assert_eq!(text("a, b"), "\"a, b\"");
        assert_eq!(text("the \"sedan\""), "\"the \"\"sedan\"\"\"");
        assert_eq!(text("two\nlines"), "\"two\nlines\"");
        // No formula in any spreadsheet.
        assert_eq!(text("=cmd|x.csv"), "'=cmd|x.csv");
        assert_eq!(text("@sum(a,b)"), "\"'@sum(a,b)\"");
    }

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        let text = |value| {
            let mut out = Vec::new();
            number(&mut out, value).unwrap();
            String::from_utf8(out).unwrap()
        };
        assert_eq!(text(0.1), "0.1");
        assert_eq!(text(220_000.0), "220000");
        assert_eq!(text(f64::NAN), "");
        for value in [-0.0, 1.0 / 3.0, 1e-5, 9.9e-6, 5e-324, f64::MAX, 1e16, -123_456.789_012_345_67] {
            assert_eq!(text(value).parse::<f64>().unwrap().to_bits(), value.to_bits(), "{value:e}");
            assert!(text(value).len() <= 24);
        }
    }
}
