//! Rows of a drive log from Parquet.

use std::fs::File;

use super::header::Header;
use super::row::{RawRow, SLOTS, Slot};
use crate::error::{Place, Problem};
use crate::parquet_columns::ParquetColumns;

#[derive(Debug)]
pub(super) struct ParquetSource {
    columns: ParquetColumns,
    header: Header,
    /// What the chosen columns are.
    slots: Vec<Slot>,
}

impl ParquetSource {
    pub(super) fn new(file: File) -> Result<Self, Problem> {
        let mut columns = ParquetColumns::open(file)?;
        let header = Header::from_names(columns.names())?;
        let mut slots = Vec::new();
        for (leaf, slot) in header.slots.iter().enumerate() {
            if let Some(slot) = *slot {
                columns.choose(leaf)?;
                slots.push(slot);
            }
        }
        Ok(Self { columns, header, slots })
    }

    pub(super) fn header(&self) -> &Header {
        &self.header
    }

    pub(super) fn progress(&self) -> f64 {
        self.columns.progress()
    }

    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        let Some(place) = self.columns.advance()? else { return Ok(None) };
        *row = [f64::NAN; SLOTS];
        for (slot, value) in self.slots.iter().zip(self.columns.values()) {
            row[slot.index()] = value;
        }
        Ok(Some(place))
    }
}
