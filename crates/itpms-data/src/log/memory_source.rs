//! Rows of a drive log from columns in memory: what another program has read already, in pieces.

use std::fmt;
use std::path::Path;

use super::header::Header;
use super::mapped;
use super::selection::Selection;
use super::slot::{RawRow, SLOTS, Slot};
use super::table_format::TableFormat;
use crate::error::{DataError, Place, Problem};
use crate::signals::{Conversion, SignalMap};

/// A piece of a drive: its columns in the order of their names, as long as each other, or why one holds no numbers, which matters only
/// where the column means something.
pub type Piece = Vec<Result<Vec<f64>, String>>;

/// Gives the next piece of a drive, `None` at the end.
pub type Pieces = Box<dyn FnMut() -> Result<Option<Piece>, Problem> + Send>;

pub(super) struct MemorySource {
    header: Header,
    /// The columns that mean something: their places in a piece, and the numbers of this piece, as long as each other.
    columns: Vec<(usize, Slot, Option<Conversion>, Vec<f64>)>,
    /// Which rows are meant, by the columns at these places.
    selections: Vec<(usize, Selection)>,
    rows: usize,
    next: usize,
    before: usize,
    /// Rows of all pieces, where that is known.
    total: Option<usize>,
    /// Source of the next piece, until there is none.
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
    /// Pieces with columns of these names, of which one piece at a time is held; columns that mean nothing to us are left out.
    pub(super) fn new(
        path: &Path,
        names: &[String],
        total: Option<usize>,
        more: Pieces,
        map: Option<&SignalMap>,
        rows: &[Selection],
    ) -> Result<Self, DataError> {
        let header = mapped::header(path, names, &[], map)?;
        let place = |selection: &Selection| Ok((selection.place(names)?, selection.clone()));
        let selections = rows
            .iter()
            .map(place)
            .collect::<Result<_, Problem>>()
            .map_err(|problem| DataError::new(path, problem))?;
        let known = header.slots.iter().zip(&header.conversions).enumerate();
        let columns = known
            .filter_map(|(place, (slot, conversion))| Some((place, (*slot)?, *conversion, Vec::new())))
            .collect();
        Ok(Self { header, columns, selections, rows: 0, next: 0, before: 0, total, more: Some(more) })
    }

    /// Replaces what was read by the next piece; whether there was one.
    fn take_piece(&mut self) -> Result<bool, Problem> {
        let Some(more) = &mut self.more else { return Ok(false) };
        let Some(mut piece) = more()? else {
            self.more = None;
            return Ok(false);
        };
        let expected = self.header.slots.len();
        let unusable = |why: String| Err(Problem::Refused(why));
        if piece.len() != expected {
            return unusable(format!(
                "a piece of the drive has {} columns, expected {expected}",
                piece.len()
            ));
        }
        for (place, selection) in &self.selections {
            let meant: Vec<bool> = match &piece[*place] {
                Ok(values) => values.iter().map(|value| selection.takes_number(*value)).collect(),
                Err(_) => {
                    let column = selection.column();
                    return unusable(format!(
                        "column {column} holds no numbers: give the rows alone, drive[drive[{column:?}] == ...], instead of {selection}"
                    ));
                }
            };
            for values in piece.iter_mut().flatten() {
                let mut meant = meant.iter();
                values.retain(|_| meant.next().copied().unwrap_or(true));
            }
        }
        let mut rows = None;
        for (place, slot, _, values) in &mut self.columns {
            match std::mem::replace(&mut piece[*place], Ok(Vec::new())) {
                Ok(new) if *rows.get_or_insert(new.len()) == new.len() => *values = new,
                Ok(new) => {
                    let (name, found, rows) = (slot.name(), new.len(), rows.unwrap_or_default());
                    return unusable(format!(
                        "column {name} has {found} values, expected {rows} as in the others"
                    ));
                }
                Err(why) => return unusable(why),
            }
        }
        self.before += self.rows;
        (self.rows, self.next) = (rows.unwrap_or_default(), 0);
        Ok(true)
    }
}

impl TableFormat for MemorySource {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_row(&mut self, row: &mut RawRow) -> Result<Option<Place>, Problem> {
        while self.next >= self.rows {
            if !self.take_piece()? {
                return Ok(None);
            }
        }
        *row = [f64::NAN; SLOTS];
        for (_, slot, conversion, values) in &self.columns {
            let value = values[self.next];
            row[slot.index()] = conversion.map_or(value, |conversion| conversion.apply(value));
        }
        self.next += 1;
        Ok(Some(Place::Row((self.before + self.next) as u64)))
    }

    fn progress(&self) -> f64 {
        let passed = (self.before + self.next) as f64;
        self.total.map_or(0.0, |total| (passed / total.max(1) as f64).min(1.0))
    }
}
