//! The list of a CSV file: every column is a signal, one is the clock.

use std::path::Path;

use itpms_files::input;

use super::statistics::{Clock, Range};
use super::{FormatLister, Listing};
use crate::error::Problem;
use crate::log::{Clock as Counter, Lines, Selection, TextHead, clock_seconds};

/// Rows between two looks around.
const ROWS_PER_STEP: usize = 1024;

#[derive(Debug)]
pub(super) struct TableLister {
    lines: Lines,
    head: TextHead,
    bytes: u64,
    ranges: Vec<Range>,
    time: Option<(usize, f64)>,
    clock: Clock,
    counter: Counter,
    /// Which rows are meant, by the columns at these places.
    rows: Vec<(usize, Selection)>,
    /// Where each column of the present header was in the first one.
    places: Vec<Option<usize>>,
    /// Rows with more or fewer cells than the header.
    uneven: u64,
}

impl TableLister {
    pub(super) fn open(path: &Path, rows: &[Selection]) -> Result<Self, Problem> {
        let (file, about) = input::open(path)?;
        let mut lines = Lines::new(file);
        let nothing =
            || Problem::from("the file is empty, expected a header line with the names of the columns");
        let head = TextHead::read(&mut lines)?.ok_or_else(nothing)?;
        let time = super::clock(&head.names, &head.units);
        let ranges = vec![Range::default(); head.names.len()];
        let rows = rows
            .iter()
            .map(|row| Ok((row.place(&head.names)?, row.clone())))
            .collect::<Result<_, Problem>>()?;
        let places = (0..head.names.len()).map(Some).collect();
        let (clock, counter) = Default::default();
        Ok(Self { lines, head, bytes: about.len(), ranges, time, clock, counter, rows, places, uneven: 0 })
    }

    /// Whether the present line is the names once more, in any order, or says something of the columns.
    fn is_of_the_names(&mut self) -> bool {
        let text = self.lines.text();
        if self.head.is_names(text) {
            return true;
        }
        let is_text = self.clock.samples() == 0 || !text.first().is_some_and(u8::is_ascii_digit);
        if !is_text || !self.head.is_without_numbers(text) {
            return false;
        }
        let names = self.head.dialect.names(text);
        let places: Vec<_> =
            names.iter().map(|name| self.head.names.iter().position(|own| own == name)).collect();
        let is_header = self.time.is_some_and(|(time, _)| places.contains(&Some(time)));
        if is_header {
            self.places = places;
        }
        is_header || self.clock.samples() == 0 && !self.head.units.is_empty()
    }

    fn is_meant(&self) -> bool {
        let is = |(place, row): &(usize, Selection)| {
            let now = self.places.iter().position(|of| *of == Some(*place));
            let cell = now.and_then(|place| self.head.dialect.cells(self.lines.text()).nth(place));
            cell.is_some_and(|cell| row.takes(&String::from_utf8_lossy(cell)))
        };
        self.rows.iter().all(is)
    }
}

impl FormatLister for TableLister {
    fn step(&mut self) -> Result<bool, Problem> {
        for _ in 0..ROWS_PER_STEP {
            if !self.lines.advance()? {
                return Ok(false);
            }
            if self.is_of_the_names() || !self.is_meant() {
                continue;
            }
            let (mut time_s, mut found) = (f64::NAN, 0);
            for cell in self.head.dialect.cells(self.lines.text()) {
                let value = self.head.dialect.number(cell).unwrap_or(f64::NAN);
                let place = self.places.get(found).copied().flatten();
                if let Some(range) = place.and_then(|place| self.ranges.get_mut(place)) {
                    range.add(value);
                }
                if let Some((_, seconds)) = self.time.filter(|(time, _)| Some(*time) == place) {
                    time_s = if value.is_nan() {
                        clock_seconds(cell).unwrap_or(f64::NAN)
                    } else {
                        value * seconds
                    };
                }
                found += 1;
            }
            self.uneven += u64::from(found != self.places.len());
            self.clock.tick(self.counter.take(time_s));
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        self.lines.position() as f64 / self.bytes.max(1) as f64
    }

    fn finish(self: Box<Self>) -> Listing {
        let mut notes: Vec<String> = self.head.remark().into_iter().chain(self.counter.remarks()).collect();
        if self.uneven > 0 {
            notes.push(format!("{} rows have more or fewer cells than the header", self.uneven));
        }
        if self.lines.lacks_its_end() {
            notes.push("the file is cut off; what is whole is listed".to_owned());
        }
        let TextHead { names, units, .. } = self.head;
        let clock = self.time.and_then(|(place, _)| names.get(place).cloned());
        let columns = names.into_iter().zip(self.ranges).enumerate();
        let columns = columns
            .filter(|(place, _)| self.time.is_none_or(|(time, _)| time != *place))
            .map(|(_, column)| column);
        let place = self.time.map(|(place, _)| place);
        let units =
            units.into_iter().enumerate().filter(|(unit, _)| Some(*unit) != place).map(|(_, unit)| unit);
        Listing::of_one_table(columns.collect(), &units.collect::<Vec<_>>(), clock, &self.clock, notes)
    }
}
