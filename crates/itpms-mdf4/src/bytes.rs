//! The bytes of a channel, such as the data of a bus's frame: in the record, or apart from it.
//!
//! Called by the cursor. Samples of varying length lie in data of their own (SD blocks, or records among those of other groups), each behind its length;
//! the record has the place, counted from the beginning of these data. They are read once, onwards: a place behind which reading is already is not found.

use super::channel::BytesLayout;
use super::error::Mdf4Problem;
use super::records::Records;

/// Bytes of one channel, record by record.
#[derive(Debug)]
pub(super) struct ByteColumn {
    layout: BytesLayout,
    apart: Option<Apart>,
}

#[derive(Debug)]
struct Apart {
    records: Records,
    /// Place of the current sample, and of the next one.
    current: Option<u64>,
    next: u64,
}

impl ByteColumn {
    /// `apart`: the data of a layout that has them there.
    pub(super) fn new(layout: BytesLayout, apart: Option<Records>) -> Self {
        Self { layout, apart: apart.map(|records| Apart { records, current: None, next: 0 }) }
    }

    /// The bytes that belong to `record`; `None` where they cannot be found.
    pub(super) fn of<'a>(&'a mut self, record: &'a [u8]) -> Result<Option<&'a [u8]>, Mdf4Problem> {
        let field =
            |offset: usize, length| offset.checked_add(length).and_then(|end| record.get(offset..end));
        match self.layout {
            BytesLayout::Inside { offset, length } => Ok(field(offset, length)),
            BytesLayout::Apart { offset, length, .. } => match (field(offset, length), &mut self.apart) {
                (Some(place), Some(apart)) => {
                    apart.at(place.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
                }
                _ => Ok(None),
            },
        }
    }

    /// The data that lie apart.
    pub(super) fn records(&mut self) -> Option<&mut Records> {
        self.apart.as_mut().map(|apart| &mut apart.records)
    }
}

impl Apart {
    fn at(&mut self, place: u64) -> Result<Option<&[u8]>, Mdf4Problem> {
        while self.current.is_none_or(|current| current < place) && self.next <= place {
            if self.records.advance()?.is_none() {
                return Ok(None);
            }
            self.current = Some(self.next);
            self.next += 4 + self.records.current().len() as u64;
        }
        Ok((self.current == Some(place)).then(|| self.records.current()))
    }
}
