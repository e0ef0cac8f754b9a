//! The beginning of a text table: how it separates, its names, the lines that some loggers write before them and the row of units under them.
//!
//! Called by the reader and by the list of text tables.

use super::clock_text;
use super::dialect::Dialect;
use super::lines::Lines;
use super::vbox::{self, VboxHead};
use crate::error::Problem;
use crate::signals::is_unit;

/// Lines before the header of loggers that begin with the drive, the car and the driver: at most so many.
const MOST_BEFORE: usize = 100;
/// Lines between the names and the first row: units, and what else is stated of each column.
const MOST_BETWEEN: usize = 2;

/// Content before the first row.
#[derive(Debug, Clone)]
pub(crate) struct TextHead {
    pub(crate) dialect: Dialect,
    pub(crate) names: Vec<String>,
    /// The unit of each column, empty where none is stated; without elements where the table has no such row.
    pub(crate) units: Vec<String>,
    pub(super) line: Vec<u8>,
    /// Lines before the names that belong to no table.
    pub(super) before: usize,
}

impl TextHead {
    /// Reads it; `None` from an empty file.
    pub(crate) fn read(lines: &mut Lines) -> Result<Option<Self>, Problem> {
        if !lines.advance()? {
            return Ok(None);
        }
        let stated = Dialect::stated(lines.text());
        if stated.is_some() && !lines.advance()? {
            return Ok(None);
        }
        if let Some(VboxHead { names, units, line }) = vbox::read(lines)? {
            return Ok(Some(Self { dialect: Dialect::BLANKS, names, units, line, before: 0 }));
        }
        let mut first = vec![lines.present()];
        if let Some(names) = lines.comment().filter(|(names, _)| is_header_of(names, lines.text(), stated)) {
            first.insert(0, names);
        }
        let before = loop {
            let text = |(line, _): &(Vec<u8>, u64)| line.trim_ascii().to_vec();
            let texts: Vec<Vec<u8>> = first.iter().rev().take(MOST_BETWEEN + 2).rev().map(text).collect();
            if let Some(place) = header_before(&texts, stated) {
                break first.len() - texts.len() + place;
            }
            if first.len() > MOST_BEFORE || !lines.advance()? {
                // No row of numbers: the first line is to be the names, and what is wrong with the others shows there.
                break 0;
            }
            first.push(lines.present());
        };
        let mut rest = first.split_off(before).into_iter();
        let Some((line, _)) = rest.next() else { return Ok(None) };
        let line = line.trim_ascii().to_vec();
        let dialect = stated.unwrap_or_else(|| Dialect::of(&line));
        let names = dialect.names(&line);
        let (names, units) = in_bars(&names).unwrap_or((names, Vec::new()));
        let mut head = Self { dialect, names, units, line, before };
        let mut rest = rest.peekable();
        if let Some(units) = rest.peek().and_then(|(line, _)| head.units_in(line.trim_ascii())) {
            head.units = units;
            rest.next();
        }
        lines.put_back(rest);
        Ok(Some(head))
    }

    /// Whether a line is the names once more: a logger that was started again, files that were put together.
    pub(crate) fn is_names(&self, line: &[u8]) -> bool {
        line == self.line
    }

    /// The names come in another order from here on; units were read by the first ones.
    pub(crate) fn take_names(&mut self, line: Vec<u8>, names: Vec<String>) {
        (self.line, self.names) = (line, names);
    }

    pub(crate) fn is_without_numbers(&self, line: &[u8]) -> bool {
        self.dialect.cells(line).all(|cell| !is_value(self.dialect, cell))
    }

    /// Remarks on the lines before the names.
    pub(crate) fn remark(&self) -> Option<String> {
        match self.before {
            0 => None,
            1 => Some("1 line before the names of the columns was left out".to_owned()),
            n => Some(format!("{n} lines before the names of the columns were left out")),
        }
    }

    /// The units in the line under the names, if it holds units and no numbers.
    fn units_in(&self, line: &[u8]) -> Option<Vec<String>> {
        let units = self.dialect.names(line);
        let known = units.iter().filter(|cell| is_unit(cell)).count();
        (self.is_without_numbers(line) && known > 0 && units.len() == self.names.len()).then_some(units)
    }
}

/// Names and units of a header as RaceCapture writes it: `"Interval"|"ms"|0|0|200`, of each column between commas.
fn in_bars(cells: &[String]) -> Option<(Vec<String>, Vec<String>)> {
    let part = |cell: &String, place: usize| {
        let part = cell.split('|').nth(place)?;
        Some(part.trim().trim_matches('"').to_owned())
    };
    let named = cells.iter().map(|cell| Some((part(cell, 0)?, part(cell, 1)?)));
    named.collect::<Option<Vec<_>>>().map(|both| both.into_iter().unzip())
}

/// Whether a cell holds a number, and not that it is missing.
fn is_value(dialect: Dialect, cell: &[u8]) -> bool {
    dialect.number(cell).is_some_and(|value| !value.is_nan())
}

/// Whether a comment holds the names of the columns, as NumPy writes them: the first line under it is a row of numbers.
fn is_header_of(comment: &[u8], row: &[u8], stated: Option<Dialect>) -> bool {
    header_before(&[comment.trim_ascii().to_vec(), row.to_vec()], stated).is_some()
}

/// The place of the names if the last line is a row of numbers: the first line of as many cells that begins with none, or of one more or less,
/// as a separator at the end makes it.
fn header_before(texts: &[Vec<u8>], stated: Option<Dialect>) -> Option<usize> {
    let (row, above) = texts.split_last()?;
    let place = |trailing: usize| {
        above.iter().enumerate().position(|(place, names)| {
            let dialect = stated.unwrap_or_else(|| Dialect::of(names));
            let count = |line: &[u8]| dialect.cells(line).count();
            let fits = |line: &Vec<u8>| count(line).abs_diff(count(names)) <= trailing;
            let numeric = |line: &[u8]| {
                let first = dialect.cells(line).next();
                first.is_some_and(|cell| is_value(dialect, cell) || clock_text::seconds(cell).is_some())
            };
            let no_rows = above[place..].iter().all(|line| fits(line) && !numeric(line));
            // `1:10`, `2024-06-03`: what is stated of the drive, and no name.
            let is_name =
                |cell: &[u8]| !is_value(dialect, cell) && !cell.first().is_some_and(u8::is_ascii_digit);
            count(names) > 1 && dialect.cells(names).all(is_name) && no_rows && fits(row) && numeric(row)
        })
    };
    place(0).or_else(|| place(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The head of a text, and its first row.
    fn head(text: &str) -> (TextHead, String) {
        let mut file = tempfile::tempfile().unwrap();
        std::io::Write::write_all(&mut file, text.as_bytes()).unwrap();
        std::io::Seek::rewind(&mut file).unwrap();
        let mut lines = Lines::new(file);
        let head = TextHead::read(&mut lines).unwrap().unwrap();
        assert!(lines.advance().unwrap());
        (head, format!("{}: {}", lines.number(), String::from_utf8_lossy(lines.text())))
    }

    #[test]
    fn the_lines_that_a_logger_writes_before_the_names_are_left_out() {
        let text = "\"Format\",\"AiM CSV File\"\n\"Sample Rate\",\"20\"\n\"Segment Times\",\"0:54.0\",\"1:10\"\n\n\
                    \"Time\",\"GPS Speed\",\"Brake\"\n\"s\",\"km/h\",\"%\"\n\n\"0.000\",\"61.2\",\"0\"\n\"0.050\",\"61.3\",\"0\"\n";
        let (found, row) = head(text);
        assert_eq!(found.names, ["Time", "GPS Speed", "Brake"]);
        assert_eq!(found.units, ["s", "km/h", "%"]);
        assert_eq!(row, "8: \"0.000\",\"61.2\",\"0\"");
        assert_eq!(found.remark().unwrap(), "3 lines before the names of the columns were left out");
        // One before names with a separator at their end.
        let (found, row) = head("Drive of Monday\nt;v;\n0,5;61,2\n");
        assert_eq!((found.names.len(), row.as_str()), (3, "3: 0,5;61,2"));
        assert_eq!(found.remark().unwrap(), "1 line before the names of the columns was left out");
    }

    #[test]
    fn names_in_a_comment_are_names_where_numbers_follow() {
        for text in ["# time_s,v\n0,1\n0.1,2\n", "# drive 3\n#time_s,v\n0,1\n"] {
            let (found, row) = head(text);
            assert_eq!(found.names, ["time_s", "v"], "{text}");
            assert!(row.ends_with(": 0,1") && found.remark().is_none(), "{row}");
        }
        for text in ["# old,names\ntime_s,v\n0,1\n", "# one name\n0,1\n0.1,2\n", "# 1,2\ntime_s,v\n0,1\n"] {
            assert!(!head(text).0.names[0].contains(['o', '#']), "{text}");
        }
    }

    #[test]
    fn a_table_begins_with_its_names_where_no_row_says_otherwise() {
        for (text, first) in [
            ("time_s,v\n0,1\n0.1,2\n", "2: 0,1"),
            // A first row without a time, names that are no units, a table of words.
            ("time_s,v\n,1\n0.1,2\n", "2: ,1"),
            ("time_s,v\nfirst,second\n0.1,2\n", "2: first,second"),
            ("name,v\na,1\nb,2\n", "2: a,1"),
            ("0.1,1\n0.2,2\n", "2: 0.2,2"),
        ] {
            let (found, row) = head(text);
            assert_eq!((row.as_str(), found.remark()), (first, None), "{text}");
        }
    }
}
