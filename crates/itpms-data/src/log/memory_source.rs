//! Rows of a drive log from columns in memory: what another program has read already, whole or in pieces.

use std::fmt;
use std::path::Path;

use super::header::Header;
use super::mapped;
use super::row::{RawRow, SLOTS, Slot};
use crate::error::{DataError, Place, Problem};
use crate::signals::{Conversion, SignalMap};

/// Gives the next piece of a drive: its columns in the order of their names, as long as each other; `None` at the end.
pub type Pieces = Box<dyn FnMut() -> Result<Option<Vec<Vec<f64>>>, Problem> + Send>;

pub(super) struct MemorySource {
    header: Header,
    /// The columns that mean something, as long as each other.
    columns: Vec<(Slot, Option<Conversion>, Vec<f64>)>,
    rows: usize,
    next: usize,
    /// Rows of the pieces before this one.
    before: usize,
    more: Option<Pieces>,
}

impl fmt::Debug for MemorySource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MemorySource")
            .field("header", &self.header)
            .field("rows", &self.rows)
            .finish_non_exhaustive()
    }
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
        Ok(Self { header, columns, rows, next: 0, before: 0, more: None })
    }

    /// The same in pieces, of which one at a time is held.
    pub(super) fn pieces(
        path: &Path,
        names: Vec<String>,
        more: Pieces,
        map: Option<&SignalMap>,
    ) -> Result<Self, DataError> {
        let nothing = names.into_iter().map(|name| (name, Vec::new())).collect();
        Ok(Self { more: Some(more), ..Self::new(path, nothing, map)? })
    }

    pub(super) fn header(&self) -> &Header {
        &self.header
    }

    pub(super) fn progress(&self) -> f64 {
        self.next as f64 / self.rows.max(1) as f64
    }

    pub(super) fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        while self.next >= self.rows {
            if !self.take_piece()? {
                return Ok(None);
            }
        }
        *row = [f64::NAN; SLOTS];
        for (slot, conversion, values) in &self.columns {
            let value = values[self.next];
            row[slot.index()] = conversion.map_or(value, |conversion| conversion.apply(value));
        }
        self.next += 1;
        Ok(Some(Place::Row((self.before + self.next) as u64)))
    }

    /// Replaces what was read by the next piece; whether there was one.
    fn take_piece(&mut self) -> Result<bool, Problem> {
        let Some(more) = &mut self.more else { return Ok(false) };
        let Some(mut piece) = more()? else {
            self.more = None;
            return Ok(false);
        };
        let (rows, expected) = (piece.first().map_or(0, Vec::len), self.header.slots.len());
        if piece.len() != expected || piece.iter().any(|values| values.len() != rows) {
            let why =
                format!("a piece of the drive has columns of different lengths, or not {expected} of them");
            return Err(Problem::UnusableSignals(why));
        }
        let known = self.header.slots.iter().zip(&mut piece).filter(|(slot, _)| slot.is_some());
        for ((_, _, values), (_, new)) in self.columns.iter_mut().zip(known) {
            *values = std::mem::take(new);
        }
        self.before += self.rows;
        (self.rows, self.next) = (rows, 0);
        Ok(true)
    }
}
