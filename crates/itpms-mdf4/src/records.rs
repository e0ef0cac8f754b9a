//! The records of one group: cut from the stream of its data group's bytes, in which those of other groups may lie between them.
//!
//! Called by the cursor. A gap in the data loses the records in it; where records of several kinds are mixed, no one can
//! tell where the next one begins, and the gap is the end.

use super::data::{DataStream, Piece};
use super::error::{Damage, Mdf4Problem};
use super::structure::Record;

pub(super) const MOST_RECORD: u64 = 4 << 20;

/// Samples of a group whose records have no bytes.
pub(super) const MOST_EMPTY: u64 = 1 << 24;

/// How the records lie.
#[derive(Debug, Clone)]
pub(super) enum Shape {
    /// One behind the other.
    Sorted,
    /// One behind the other, each behind its length.
    Varying,
    /// Each behind its id, mixed with those of other groups.
    Mixed {
        id_bytes: usize,
        /// The id of the group that is read.
        own: u64,
        /// Whether its records stand behind their lengths.
        varies: bool,
        /// All that occur, by rising id.
        known: Vec<Record>,
    },
}

/// Why there are no more records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// All that are wanted were read; whether there are more.
    Enough { more: bool },
    /// The data end, after so many bytes of another record.
    DataEnd { partial: usize },
    /// A gap among mixed records.
    Gap,
    /// A record without an owner.
    UnknownRecord(u64),
}

/// The records of one group in their order.
#[derive(Debug)]
pub(super) struct Records {
    stream: DataStream,
    shape: Shape,
    /// Bytes of a record, without its id; of records that vary, of the current one.
    length: usize,
    /// Records wanted.
    limit: Option<u64>,
    /// Number of the next record, counting those in gaps.
    next: u64,
    pub(super) lost: u64,
    /// Bytes of the stream's piece that were used.
    used: usize,
    /// Bytes of the stream before the piece.
    before: u64,
    carry: Vec<u8>,
    current: Option<(u64, Taken)>,
    pub(super) stop: Option<Stop>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Taken {
    /// The bytes, at this place of the stream's piece.
    InPiece(usize),
    /// The bytes, in `carry`.
    Carried,
    Gap,
    /// The end, with so many bytes left.
    End(usize),
}

/// How passing over bytes ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Skipped {
    All,
    Gap,
    End,
}

impl Records {
    /// Records of `length` bytes, at most [`MOST_RECORD`]; if 0, `limit` is at most [`MOST_EMPTY`], unless they vary.
    pub(super) fn new(stream: DataStream, shape: Shape, length: usize, limit: Option<u64>) -> Self {
        Self {
            stream,
            shape,
            length,
            limit,
            next: 0,
            lost: 0,
            used: 0,
            before: 0,
            carry: Vec::new(),
            current: None,
            stop: None,
        }
    }

    /// On to the next record; its number from zero, `None` at the end, of which [`Records::stop`] tells.
    #[inline]
    pub(super) fn advance(&mut self) -> Result<Option<u64>, Mdf4Problem> {
        self.current = None;
        if self.stop.is_some() {
            return Ok(None);
        }
        if self.limit.is_some_and(|limit| self.next >= limit) {
            self.stop = Some(Stop::Enough { more: self.has_more()? });
            return Ok(None);
        }
        let taken = match &self.shape {
            Shape::Sorted if self.length == 0 => Taken::InPiece(0),
            Shape::Sorted => self.next_sorted()?,
            Shape::Varying => self.take_varying()?,
            Shape::Mixed { .. } => self.next_mixed()?,
        };
        if !matches!(taken, Taken::InPiece(_) | Taken::Carried) {
            return Ok(None);
        }
        let number = self.next;
        self.next += 1;
        self.current = Some((number, taken));
        Ok(Some(number))
    }

    /// Bytes of the record that [`Records::advance`] went to.
    #[inline]
    pub(super) fn current(&self) -> &[u8] {
        match self.current {
            Some((_, Taken::InPiece(from))) => {
                self.stream.bytes().get(from..from + self.length).unwrap_or_default()
            }
            Some((_, Taken::Carried)) => &self.carry,
            _ => &[],
        }
    }

    /// On to the record with this number, beside other records that are read in step; false if it is not there.
    pub(super) fn advance_to(&mut self, number: u64) -> Result<bool, Mdf4Problem> {
        loop {
            match self.current {
                Some((current, _)) if current >= number => return Ok(current == number),
                _ => {
                    if self.advance()?.is_none() {
                        return Ok(false);
                    }
                }
            }
        }
    }

    pub(super) fn passed(&self) -> u64 {
        self.next
    }

    /// Share of the file in front of the last read.
    pub(super) fn depth(&self) -> f64 {
        self.stream.depth()
    }

    /// Damages found since this was asked last.
    pub(super) fn take_damages(&mut self) -> Vec<Damage> {
        self.stream.take_damages()
    }

    fn next_sorted(&mut self) -> Result<Taken, Mdf4Problem> {
        loop {
            match self.take(self.length)? {
                Taken::Gap => self.pass_gap()?,
                Taken::End(partial) => {
                    self.stop = Some(Stop::DataEnd { partial });
                    return Ok(Taken::End(partial));
                }
                taken => return Ok(taken),
            }
            if self.limit.is_some_and(|limit| self.next >= limit) {
                self.stop = Some(Stop::DataEnd { partial: 0 });
                return Ok(Taken::Gap);
            }
        }
    }

    /// Behind a gap: on to the next whole record. The counting goes on over what is lost.
    fn pass_gap(&mut self) -> Result<(), Mdf4Problem> {
        let length = self.length as u64;
        loop {
            let position = self.before + self.used as u64;
            let number = position.div_ceil(length);
            // Another gap right behind moves on further; at the end `take` says so.
            if self.skip(number * length - position)? != Skipped::Gap {
                let number = self.limit.map_or(number, |limit| number.min(limit));
                self.lost += number.saturating_sub(self.next);
                self.next = self.next.max(number);
                return Ok(());
            }
        }
    }

    fn next_mixed(&mut self) -> Result<Taken, Mdf4Problem> {
        let Shape::Mixed { id_bytes, own, varies, .. } = self.shape else { return Ok(Taken::End(0)) };
        loop {
            let Some(id) = self.take_number(id_bytes)? else { return Ok(Taken::End(0)) };
            if id == own && varies {
                return self.take_varying();
            }
            if id == own {
                let taken = self.take(self.length)?;
                return Ok(self.stopped(taken));
            }
            let Shape::Mixed { known, .. } = &self.shape else { return Ok(Taken::End(0)) };
            let record = known.binary_search_by_key(&id, |record| record.id).ok().map(|i| known[i]);
            let Some(record) = record else {
                self.stop = Some(Stop::UnknownRecord(id));
                return Ok(Taken::End(0));
            };
            let bytes = match record.bytes {
                Some(bytes) => bytes,
                None => match self.take_number(4)? {
                    Some(bytes) => bytes,
                    None => return Ok(Taken::End(0)),
                },
            };
            self.stop = match self.skip(bytes)? {
                Skipped::All => continue,
                Skipped::Gap => Some(Stop::Gap),
                Skipped::End => Some(Stop::DataEnd { partial: 0 }),
            };
            return Ok(Taken::End(0));
        }
    }

    fn take_varying(&mut self) -> Result<Taken, Mdf4Problem> {
        let Some(length) = self.take_number(4)? else { return Ok(Taken::End(0)) };
        if length > MOST_RECORD {
            self.stop = Some(Stop::DataEnd { partial: 4 });
            return Ok(Taken::End(4));
        }
        self.length = length as usize;
        let taken = self.take(self.length)?;
        Ok(self.stopped(taken))
    }

    /// A little-endian number among mixed records.
    fn take_number(&mut self, bytes: usize) -> Result<Option<u64>, Mdf4Problem> {
        let taken = self.take(bytes)?;
        let number = match self.stopped(taken) {
            Taken::InPiece(from) => &self.stream.bytes()[from..from + bytes],
            Taken::Carried => self.carry.as_slice(),
            Taken::Gap | Taken::End(_) => return Ok(None),
        };
        Ok(Some(number.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte))))
    }

    fn stopped(&mut self, taken: Taken) -> Taken {
        match taken {
            Taken::Gap => self.stop = Some(Stop::Gap),
            Taken::End(partial) => self.stop = Some(Stop::DataEnd { partial }),
            Taken::InPiece(_) | Taken::Carried => {}
        }
        taken
    }

    #[inline]
    fn take(&mut self, count: usize) -> Result<Taken, Mdf4Problem> {
        let from = self.used;
        if self.stream.bytes().len() - from >= count {
            self.used = from + count;
            return Ok(Taken::InPiece(from));
        }
        self.take_across(count)
    }

    /// The next `count` bytes, which do not lie in one piece.
    fn take_across(&mut self, count: usize) -> Result<Taken, Mdf4Problem> {
        self.carry.clear();
        loop {
            let missing = count - self.carry.len();
            let rest = self.stream.bytes().get(self.used..).unwrap_or_default();
            let some = &rest[..rest.len().min(missing)];
            self.carry.extend_from_slice(some);
            self.used += some.len();
            if self.carry.len() == count {
                return Ok(Taken::Carried);
            }
            match self.next_piece()? {
                Piece::Bytes => {}
                Piece::Gap(bytes) => {
                    self.before += bytes;
                    return Ok(Taken::Gap);
                }
                Piece::End => return Ok(Taken::End(self.carry.len())),
            }
        }
    }

    fn skip(&mut self, mut count: u64) -> Result<Skipped, Mdf4Problem> {
        loop {
            let rest = (self.stream.bytes().len() - self.used) as u64;
            let some = rest.min(count);
            self.used += some as usize;
            count -= some;
            if count == 0 {
                return Ok(Skipped::All);
            }
            match self.next_piece()? {
                Piece::Bytes => {}
                Piece::Gap(bytes) => {
                    self.before += bytes;
                    return Ok(Skipped::Gap);
                }
                Piece::End => return Ok(Skipped::End),
            }
        }
    }

    fn next_piece(&mut self) -> Result<Piece, Mdf4Problem> {
        self.before += self.stream.bytes().len() as u64;
        self.used = 0;
        self.stream.next_piece()
    }

    fn has_more(&mut self) -> Result<bool, Mdf4Problem> {
        if self.length == 0 {
            return Ok(false);
        }
        match self.shape {
            Shape::Sorted => Ok(matches!(self.take(self.length)?, Taken::InPiece(_) | Taken::Carried)),
            // To look for one more would mean to read all the others.
            Shape::Mixed { .. } | Shape::Varying => Ok(false),
        }
    }
}
