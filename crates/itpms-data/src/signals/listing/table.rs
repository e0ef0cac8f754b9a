//! The list of a CSV file: every column is a signal, one is the clock.

use std::path::Path;

use itpms_files::input;

use super::Listing;
use super::statistics::{Clock, Range};
use crate::error::Problem;
use crate::log::{Lines, TextHead, clock_seconds};

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
    /// Rows with more or fewer cells than the header.
    uneven: u64,
}

impl TableLister {
    pub(super) fn open(path: &Path) -> Result<Self, Problem> {
        let (file, about) = input::open(path)?;
        let mut lines = Lines::new(file);
        let nothing = || Problem::NoHeader("the names of the columns".to_owned());
        let head = TextHead::read(&mut lines)?.ok_or_else(nothing)?;
        let time = super::clock(&head.names, &head.units);
        let ranges = vec![Range::default(); head.names.len()];
        Ok(Self { lines, head, bytes: about.len(), ranges, time, clock: Clock::default(), uneven: 0 })
    }

    pub(super) fn step(&mut self) -> Result<bool, Problem> {
        for _ in 0..ROWS_PER_STEP {
            if !self.lines.advance()? {
                return Ok(false);
            }
            if self.head.is_names(self.lines.text()) {
                continue;
            }
            let (mut time_s, mut found) = (f64::NAN, 0);
            for cell in self.head.dialect.cells(self.lines.text()) {
                let value = self.head.dialect.number(cell).unwrap_or(f64::NAN);
                if let Some(range) = self.ranges.get_mut(found) {
                    range.add(value);
                }
                if let Some((_, seconds)) = self.time.filter(|(place, _)| *place == found) {
                    time_s = if value.is_nan() {
                        clock_seconds(cell).unwrap_or(f64::NAN)
                    } else {
                        value * seconds
                    };
                }
                found += 1;
            }
            self.uneven += u64::from(found != self.head.names.len());
            self.clock.tick(time_s);
        }
        Ok(true)
    }

    pub(super) fn progress(&self) -> f64 {
        self.lines.position() as f64 / self.bytes.max(1) as f64
    }

    pub(super) fn finish(self) -> Listing {
        let mut notes: Vec<String> = self.head.remark().into_iter().collect();
        if self.uneven > 0 {
            notes.push(format!("{} rows have more or fewer cells than the header", self.uneven));
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
