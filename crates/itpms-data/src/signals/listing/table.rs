//! The list of a CSV file: every column is a signal, one is the clock.

use std::path::Path;

use super::Listing;
use super::statistics::{Clock, Range};
use crate::error::Problem;
use crate::input;
use crate::log::{Dialect, Lines};

/// Rows between two looks around.
const ROWS_PER_STEP: usize = 1024;

#[derive(Debug)]
pub(super) struct TableLister {
    lines: Lines,
    dialect: Dialect,
    bytes: u64,
    names: Vec<String>,
    ranges: Vec<Range>,
    time: Option<(usize, f64)>,
    clock: Clock,
    /// Rows with more or fewer cells than the header.
    uneven: u64,
}

impl TableLister {
    pub(super) fn open(path: &Path) -> Result<Self, Problem> {
        let (file, about) = input::open(path)?;
        let mut lines = Lines::new(file);
        if !lines.advance()? {
            return Err(Problem::NoHeader("the names of the columns".to_owned()));
        }
        let dialect = Dialect::of(lines.text());
        let names = dialect.names(lines.text());
        let time = super::clock(&names);
        let ranges = vec![Range::default(); names.len()];
        Ok(Self {
            lines,
            dialect,
            bytes: about.len(),
            names,
            ranges,
            time,
            clock: Clock::default(),
            uneven: 0,
        })
    }

    pub(super) fn step(&mut self) -> Result<bool, Problem> {
        for _ in 0..ROWS_PER_STEP {
            if !self.lines.advance()? {
                return Ok(false);
            }
            let (mut time_s, mut found) = (f64::NAN, 0);
            for cell in self.dialect.cells(self.lines.text()) {
                let value = self.dialect.number(cell).unwrap_or(f64::NAN);
                if let Some(range) = self.ranges.get_mut(found) {
                    range.add(value);
                }
                if let Some((_, seconds)) = self.time.filter(|(place, _)| *place == found) {
                    time_s = value * seconds;
                }
                found += 1;
            }
            self.uneven += u64::from(found != self.names.len());
            self.clock.tick(time_s);
        }
        Ok(true)
    }

    pub(super) fn progress(&self) -> f64 {
        self.lines.position() as f64 / self.bytes.max(1) as f64
    }

    pub(super) fn finish(self) -> Listing {
        let mut notes = Vec::new();
        if self.uneven > 0 {
            notes.push(format!("{} rows have more or fewer cells than the header", self.uneven));
        }
        let clock = self.time.and_then(|(place, _)| self.names.get(place).cloned());
        let columns = self.names.into_iter().zip(self.ranges).enumerate();
        let columns = columns
            .filter(|(place, _)| self.time.is_none_or(|(time, _)| time != *place))
            .map(|(_, column)| column);
        Listing::of_one_table(columns.collect(), clock, &self.clock, "table", notes)
    }
}
