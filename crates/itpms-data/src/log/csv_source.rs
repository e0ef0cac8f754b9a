//! Rows from text: commas (or semicolons, tabs, bars), a header line, units under it, `#` comments, blank lines, quotes where one
//! used them.

use std::fs::File;
use std::path::Path;

use itpms_files::shortened;

use super::format::Format;
use super::header::Header;
use super::lines::Lines;
use super::selection::Selection;
use super::slot::{RawRow, SLOTS, Slot};
use super::table_format::TableFormat;
use super::text_head::TextHead;
use super::{clock_text, mapped};
use crate::error::{DataError, Place, Problem};
use crate::signals::SignalMap;

/// Message for a CAN log with the extension of a table.
const CANDUMP: &str = "it holds frames of a CAN bus as candump writes them, expected a table: rename it to end in .log and give the frames' \
                       description, --dbc";

#[derive(Debug)]
pub(super) struct CsvSource {
    lines: Lines,
    header: Header,
    head: TextHead,
    bytes: u64,
    cut_off: bool,
    /// How often the names came again, and of these in another order.
    headers_again: u64,
    reordered: u64,
    /// Whether no row has come since the names: lines without a number say something of the columns.
    is_under_names: bool,
    /// Which rows are meant, by the columns at these places, and whether there were any.
    rows: Vec<(usize, Selection)>,
    is_any_meant: bool,
}

impl CsvSource {
    /// `bytes`: the file's length, for the progress.
    pub(super) fn new(
        path: &Path,
        file: File,
        bytes: u64,
        map: Option<&SignalMap>,
        rows: &[Selection],
    ) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        let mut lines = Lines::new(file);
        let head = TextHead::read(&mut lines).map_err(fail)?.ok_or_else(|| fail(Problem::Empty))?;
        let header = mapped::header(path, &head.names, &head.units, map)
            .map_err(|error| if is_candump(&head.names) { DataError::new(path, CANDUMP) } else { error })?;
        let place = |selection: &Selection| Ok((selection.place(&head.names)?, selection.clone()));
        let rows = rows.iter().map(place).collect::<Result<_, Problem>>().map_err(fail)?;
        let is_under_names = !head.units.is_empty();
        Ok(Self {
            lines,
            header,
            head,
            bytes,
            cut_off: false,
            headers_again: 0,
            reordered: 0,
            is_under_names,
            rows,
            is_any_meant: false,
        })
    }

    /// Whether the present line is of the rows that are asked for.
    fn is_meant(&self) -> bool {
        let cells: Vec<&[u8]> = self.head.dialect.cells(self.lines.text()).collect();
        let is = |(place, row): &(usize, Selection)| {
            cells.get(*place).is_some_and(|cell| row.takes(&String::from_utf8_lossy(cell)))
        };
        self.rows.iter().all(is)
    }

    /// Whether the present line stands between the names and the rows: units, or where each column comes from.
    fn is_of_the_names(&self) -> bool {
        self.is_under_names && self.head.is_without_numbers(self.lines.text())
    }

    /// Whether the present line is a header in another order, by which the rows under it are read.
    fn take_names(&mut self) -> Result<bool, Problem> {
        let text = self.lines.text().to_vec();
        let names = self.head.dialect.names(&text);
        let mut free: Vec<bool> = vec![true; self.head.names.len()];
        let known: Vec<Option<usize>> = names
            .iter()
            .map(|name| {
                let before = |place: &usize| free[*place] && self.head.names[*place] == *name;
                let place = (0..free.len()).find(before)?;
                free[place] = false;
                Some(place)
            })
            .collect();
        let is_time = |place: &usize| self.header.slots[*place] == Some(Slot::Time);
        if names.len() < 2 || !known.iter().flatten().any(is_time) {
            return Ok(false);
        }
        let used = |place: usize| {
            self.header.slots[place].is_some() || self.rows.iter().any(|(row, _)| *row == place)
        };
        let lost = (0..free.len()).find(|place| free[*place] && used(*place));
        let new = names
            .iter()
            .zip(&known)
            .find(|(name, known)| known.is_none() && Slot::all().any(|slot| slot.name() == **name));
        if let Some(column) = lost.map(|place| &self.head.names[place]).or(new.map(|(name, _)| name)) {
            let place = Place::Line(self.lines.number());
            let column = shortened(column);
            return Err(format!(
                "{place}: the header comes again with other columns (column {column} is in one of the two alone), expected the same: cut the \
                 file there, each of its parts has a header then"
            )
            .into());
        }
        let of = |place: &Option<usize>| place.and_then(|place| self.header.slots[place]);
        let slots = known.iter().map(of).collect();
        let of = |place: &Option<usize>| place.and_then(|place| self.header.conversions[place]);
        let conversions = known.iter().map(of).collect();
        for (row, _) in &mut self.rows {
            *row = known.iter().position(|place| *place == Some(*row)).unwrap_or(*row);
        }
        (self.header.slots, self.header.conversions) = (slots, conversions);
        self.head.take_names(text, names);
        (self.reordered, self.is_under_names) = (self.reordered + 1, true);
        Ok(true)
    }

    fn cells(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        let place = Place::Line(self.lines.number());
        *row = [f64::NAN; SLOTS];
        let expected = self.header.slots.len();
        let mut found = 0;
        let mut bad_cell = None;
        let mut last_is_empty = false;
        for cell in self.head.dialect.cells(self.lines.text()) {
            last_is_empty = cell.is_empty();
            if let Some(Some(slot)) = self.header.slots.get(found) {
                let time = || clock_text::seconds(cell).filter(|_| *slot == Slot::Time);
                let value = self.head.dialect.number(cell).map(|value| self.header.in_our_unit(found, value));
                match value.or_else(time) {
                    // A date of digits alone has more of them than a number holds.
                    Some(value) if *slot == Slot::Time && cell.len() > 13 => {
                        row[slot.index()] = time().unwrap_or(value);
                    }
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
        // A separator at the end of the rows, or of the header, that the other has not.
        let trailing = (found == expected + 1 && last_is_empty)
            || (found + 1 == expected && self.head.names.last().is_some_and(String::is_empty));
        if found != expected && !trailing {
            return Err(Problem::CellCount { place, found, expected });
        }
        match bad_cell {
            None => Ok(Some(place)),
            Some((slot, cell)) => Err(Problem::NotANumber {
                place,
                column: slot.name(),
                found: shortened(&String::from_utf8_lossy(cell)),
                hint: hint(slot, cell),
            }),
        }
    }
}

impl TableFormat for CsvSource {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        loop {
            if !self.lines.advance()? {
                self.cut_off |= self.lines.lacks_its_end();
                if !self.rows.is_empty() && !self.is_any_meant && !self.is_under_names {
                    let rows: Vec<Selection> = self.rows.iter().map(|(_, row)| row.clone()).collect();
                    return Err(Selection::nowhere(&rows));
                }
                return Ok(None);
            }
            if self.head.is_names(self.lines.text()) {
                (self.headers_again, self.is_under_names) = (self.headers_again + 1, true);
                continue;
            }
            if !self.rows.is_empty() && !self.is_meant() {
                self.is_under_names &= self.head.is_without_numbers(self.lines.text());
                continue;
            }
            match self.cells(row) {
                Err(problem) => {
                    if !self.take_names()? && !self.is_of_the_names() {
                        return Err(problem);
                    }
                }
                read => {
                    (self.is_under_names, self.is_any_meant) = (false, true);
                    return read;
                }
            }
        }
    }

    fn progress(&self) -> f64 {
        (self.lines.position() as f64 / self.bytes.max(1) as f64).min(1.0)
    }

    fn cut_off(&self) -> bool {
        self.cut_off
    }

    fn repairs(&self) -> Vec<String> {
        let again = match self.headers_again {
            0 => None,
            1 => Some("the header comes once more and was left out".to_owned()),
            n => Some(format!("the header comes {n} times more and was left out")),
        };
        let reordered = (self.reordered > 0).then(|| {
            let times =
                if self.reordered == 1 { "once".to_owned() } else { format!("{} times", self.reordered) };
            format!("the header comes {times} more in another order: the rows under it were read by it")
        });
        self.head.remark().into_iter().chain(again).chain(reordered).collect()
    }

    fn format(&self) -> Option<Format> {
        Some(Format::Csv)
    }
}

/// Whether the first line is a frame: `(1436509052.249713) can0 123#DEADBEEF`.
fn is_candump(names: &[String]) -> bool {
    let Some((stamp, frame)) = names.first().and_then(|line| line.strip_prefix('(')?.split_once(')')) else {
        return false;
    };
    stamp.parse::<f64>().is_ok() && frame.contains('#')
}

/// Hint for a cell that is no number.
fn hint(slot: Slot, cell: &[u8]) -> &'static str {
    let separators = cell.iter().filter(|byte| matches!(byte, b'.' | b',' | b'\'')).count();
    match slot {
        _ if separators > 1 && !cell.contains(&b':') => " (without separators between thousands)",
        Slot::Time if cell.first().is_some_and(u8::is_ascii_alphabetic) => {
            " (a line of text, as of averages or remarks, is no sample: delete it)"
        }
        Slot::Time => {
            " (or as 2026-03-01 08:00:00.002, 01.03.2026 08:00:00.002 or 03/01/2026 08:00:00.002 AM; 03/01/2026 alone could be two days)"
        }
        _ => "",
    }
}
