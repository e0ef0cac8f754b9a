//! Rows of a drive log from columns in memory: what another program has read already.

use super::header::Header;
use super::row::{RawRow, SLOTS, Slot};
use crate::error::{Place, Problem};

#[derive(Debug)]
pub(super) struct MemorySource {
    header: Header,
    /// The columns that mean something, as long as each other.
    columns: Vec<(Slot, Vec<f64>)>,
    rows: usize,
    next: usize,
}

impl MemorySource {
    /// Columns with their names; those that mean nothing to us are left out.
    pub(super) fn new(columns: Vec<(String, Vec<f64>)>) -> Result<Self, Problem> {
        let rows = columns.first().map_or(0, |(_, values)| values.len());
        if let Some((name, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
            let first = &columns[0].0;
            return Err(Problem::UnusableSignals(format!(
                "column {name} has {} values, expected {rows} as in {first}",
                values.len()
            )));
        }
        let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
        let header = Header::from_names(&names)?;
        let known = header.slots.iter().zip(columns);
        let columns = known.filter_map(|(slot, (_, values))| Some(((*slot)?, values))).collect();
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
        for (slot, values) in &self.columns {
            row[slot.index()] = values[self.next];
        }
        self.next += 1;
        Some(Place::Row(self.next as u64))
    }
}
