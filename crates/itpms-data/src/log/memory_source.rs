//! Rows of a drive log from columns in memory: what another program has read already.

use std::path::Path;

use super::header::Header;
use super::mapped;
use super::row::{RawRow, SLOTS, Slot};
use crate::error::{DataError, Place, Problem};
use crate::signals::{Conversion, SignalMap};

#[derive(Debug)]
pub(super) struct MemorySource {
    header: Header,
    /// The columns that mean something, as long as each other.
    columns: Vec<(Slot, Option<Conversion>, Vec<f64>)>,
    rows: usize,
    next: usize,
}

impl MemorySource {
    /// Columns with their names; those that mean nothing to us are left out.
    pub(super) fn new(
        path: &Path,
        columns: Vec<(String, Vec<f64>)>,
        map: Option<&SignalMap>,
    ) -> Result<Self, DataError> {
        let rows = columns.first().map_or(0, |(_, values)| values.len());
        if let Some((name, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
            let first = &columns[0].0;
            let why = format!("column {name} has {} values, expected {rows} as in {first}", values.len());
            return Err(DataError::new(path, Problem::UnusableSignals(why)));
        }
        let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
        let header = mapped::header(path, &names, map)?;
        let known = header.slots.iter().zip(&header.conversions).zip(columns);
        let columns =
            known.filter_map(|((slot, conversion), (_, values))| Some(((*slot)?, *conversion, values)));
        let columns = columns.collect();
        Ok(Self { header, columns, rows, next: 0 })
    }

    pub(super) fn header(&self) -> &Header {
        &self.header
    }

    pub(super) fn progress(&self) -> f64 {
        self.next as f64 / self.rows.max(1) as f64
    }

    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Option<Place> {
        if self.next >= self.rows {
            return None;
        }
        *row = [f64::NAN; SLOTS];
        for (slot, conversion, values) in &self.columns {
            let value = values[self.next];
            row[slot.index()] = conversion.map_or(value, |conversion| conversion.apply(value));
        }
        self.next += 1;
        Some(Place::Row(self.next as u64))
    }
}
