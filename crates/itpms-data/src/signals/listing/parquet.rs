//! The list of a Parquet table: every column of numbers is a signal, one is the clock.

use std::path::Path;

use super::statistics::{Clock, Range};
use super::{FormatLister, Listing};
use crate::error::Problem;
use crate::log::{Clock as Counter, Selection};
use crate::parquet_columns::{ParquetParts, Quantity};

/// Rows between two looks around.
const ROWS_PER_STEP: usize = 1024;

#[derive(Debug)]
pub(super) struct ParquetLister {
    columns: ParquetParts,
    /// The columns that are read: their names and what they hold.
    names: Vec<String>,
    ranges: Vec<Range>,
    /// Which of them is the clock, and seconds per its unit.
    time: Option<(usize, f64)>,
    clock: Clock,
    counter: Counter,
    others: Vec<String>,
}

impl ParquetLister {
    pub(super) fn open(path: &Path, rows: &[Selection]) -> Result<Self, Problem> {
        let mut columns = ParquetParts::open(path, rows)?;
        let clock = super::clock(columns.names(), &[]);
        let (mut leaves, mut names, mut others) = (Vec::new(), Vec::new(), Vec::new());
        let mut time = None;
        for (leaf, name) in columns.names().iter().enumerate() {
            let is_clock = clock.filter(|(place, _)| *place == leaf);
            let meaning =
                if is_clock.is_some() { columns.clock_meaning(leaf) } else { columns.meaning(leaf) };
            match meaning {
                Ok(meaning) if meaning.quantity == Quantity::Number || is_clock.is_some() => {
                    let per_unit =
                        |(_, seconds)| if meaning.quantity == Quantity::Time { 1.0 } else { seconds };
                    time = time.or(is_clock.map(|clock| (leaves.len(), per_unit(clock))));
                    leaves.push(leaf);
                    names.push(name.clone());
                }
                Ok(_) => others.push(format!("{name} (times)")),
                Err(Problem::ColumnType { found, .. }) => others.push(format!("{name} ({found})")),
                Err(problem) => return Err(problem),
            }
        }
        columns.choose(&leaves, time.and_then(|(place, _)| leaves.get(place).copied()))?;
        let ranges = vec![Range::default(); names.len()];
        Ok(Self {
            columns,
            names,
            ranges,
            time,
            clock: Clock::default(),
            counter: Counter::default(),
            others,
        })
    }
}

impl FormatLister for ParquetLister {
    fn step(&mut self) -> Result<bool, Problem> {
        for _ in 0..ROWS_PER_STEP {
            if self.columns.advance()?.is_none() {
                return Ok(false);
            }
            let mut time_s = f64::NAN;
            for (place, (value, range)) in self.columns.values().zip(&mut self.ranges).enumerate() {
                range.add(value);
                if let Some((_, seconds)) = self.time.filter(|(time, _)| *time == place) {
                    time_s = value * seconds;
                }
            }
            self.clock.tick(self.counter.take(time_s));
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        self.columns.progress()
    }

    fn finish(self: Box<Self>) -> Listing {
        let clock = self.time.and_then(|(place, _)| self.names.get(place).cloned());
        let columns = self.names.into_iter().zip(self.ranges).enumerate();
        let columns = columns
            .filter(|(place, _)| self.time.is_none_or(|(time, _)| time != *place))
            .map(|(_, column)| column);
        let notes = match self.others.len() {
            0 => Vec::new(),
            1 => vec![format!("1 column holds no numbers: {}", self.others[0])],
            n => vec![format!("{n} columns hold no numbers: {}", super::some(&self.others))],
        };
        Listing::of_one_table(columns.collect(), &[], clock, &self.clock, notes)
    }
}
