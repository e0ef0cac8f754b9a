//! Rows of a drive log from Parquet: a file, or a folder of part files.

use std::path::Path;

use super::format::Format;
use super::header::Header;
use super::mapped;
use super::slot::{RawRow, SLOTS, Slot};
use super::table_format::TableFormat;
use crate::error::{DataError, Place, Problem};
use crate::parquet_columns::{ParquetParts, Quantity};
use crate::signals::SignalMap;

use super::selection::Selection;

#[derive(Debug)]
pub(super) struct ParquetSource {
    columns: ParquetParts,
    header: Header,
    /// Places and meanings of the chosen columns.
    slots: Vec<(usize, Slot)>,
}

impl ParquetSource {
    pub(super) fn new(path: &Path, map: Option<&SignalMap>, rows: &[Selection]) -> Result<Self, DataError> {
        let fail = |problem| DataError::new(path, problem);
        let mut columns = ParquetParts::open(path, rows).map_err(fail)?;
        let mut header = mapped::header(path, columns.names(), &[], map)?;
        let known = header.slots.iter().enumerate();
        let slots: Vec<(usize, Slot)> = known.filter_map(|(leaf, slot)| Some((leaf, (*slot)?))).collect();
        let clock = slots.iter().find(|(_, slot)| *slot == Slot::Time).map(|(leaf, _)| *leaf);
        if let Some(leaf) = clock
            && columns.clock_meaning(leaf).map_err(fail)?.quantity == Quantity::Time
        {
            // Stamps, durations and text of times come in s, whatever a name or a map says.
            header.conversions[leaf] = None;
        }
        let leaves: Vec<usize> = slots.iter().map(|(leaf, _)| *leaf).collect();
        columns.choose(&leaves, clock).map_err(fail)?;
        Ok(Self { columns, header, slots })
    }
}

impl TableFormat for ParquetSource {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        let Some(place) = self.columns.advance()? else { return Ok(None) };
        *row = [f64::NAN; SLOTS];
        for ((leaf, slot), value) in self.slots.iter().zip(self.columns.values()) {
            row[slot.index()] = self.header.in_our_unit(*leaf, value);
        }
        Ok(Some(place))
    }

    fn progress(&self) -> f64 {
        self.columns.progress()
    }

    fn repairs(&self) -> Vec<String> {
        let say = |(column, parts): &(String, usize)| {
            let parts = if *parts == 1 { "one part".to_owned() } else { format!("{parts} parts") };
            format!(
                "column {column} is not in {parts} of the folder: its values are missing there, and a sensor that is reported to lose samples for as long is not at fault"
            )
        };
        self.columns.lacking.iter().map(say).collect()
    }

    fn overlap(&self) -> Option<&(String, String)> {
        self.columns.overlap()
    }

    fn format(&self) -> Option<Format> {
        Some(Format::Parquet)
    }
}
