//! Rows of a drive log from Parquet.

use std::fs::File;
use std::path::Path;

use super::header::Header;
use super::mapped;
use super::row::{RawRow, SLOTS, Slot};
use crate::error::{DataError, Place, Problem};
use crate::parquet_columns::ParquetColumns;
use crate::signals::{Conversion, SignalMap};

#[derive(Debug)]
pub(super) struct ParquetSource {
    columns: ParquetColumns,
    header: Header,
    /// Places and meanings of the chosen columns.
    slots: Vec<(usize, Slot)>,
}

impl ParquetSource {
    pub(super) fn new(path: &Path, file: File, map: Option<&SignalMap>) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        let mut columns = ParquetColumns::open(file).map_err(fail)?;
        let mut header = mapped::header(path, columns.names(), map)?;
        let mut slots = Vec::new();
        for (leaf, slot) in header.slots.clone().iter().enumerate() {
            let Some(slot) = *slot else { continue };
            match columns.clock_s(leaf).filter(|_| slot == Slot::Time) {
                Some(factor) => {
                    header.conversions[leaf] = Some(Conversion { factor, offset: 0.0 });
                    columns.choose_clock(leaf);
                }
                None => columns.choose(leaf).map_err(fail)?,
            }
            slots.push((leaf, slot));
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
        for ((leaf, slot), value) in self.slots.iter().zip(self.columns.values()) {
            row[slot.index()] = self.header.in_our_unit(*leaf, value);
        }
        Ok(Some(place))
    }
}
