//! The data of a group as a stream of bytes, however they are cut into blocks: DT and DV plain, DZ compressed, in lists
//! (DL, LD, the latter also of invalidation bytes) with or without a head (HL).
//!
//! Called by the records. In memory are one piece of a plain block (256 kB) or one inflated block, and 4096 links of a
//! list. A block that cannot be read is a gap of known length, or the end.

use itpms_files::FileProblem;

use super::block::{BlockFile, FRAME, Fault, Frame, shown};
use super::error::{Damage, Mdf4Problem};
use super::identification::Unfinished;
use super::inflate::Zipped;

/// Bytes of a plain block read at a time.
const PIECE: u64 = 256 << 10;

/// Links of a list read at a time.
const LINKS: u64 = 4096;

const DAMAGES: usize = 20;

/// In the fourth byte of an LD's flags: it has links to invalidation bytes.
const APART: u8 = 0x80;

/// Which of a list's two columns of blocks is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Column {
    /// The records.
    Values,
    /// Invalidation bytes kept apart from them (MDF 4.2).
    Invalidation,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    /// Bytes, in [`DataStream::bytes`].
    Bytes,
    /// So many bytes that cannot be read.
    Gap(u64),
    /// Nothing.
    End,
}

/// The bytes of a data group, piece by piece.
#[derive(Debug)]
pub(super) struct DataStream {
    file: BlockFile,
    column: Column,
    unfinished: Unfinished,
    /// Places of blocks that are not data, rising.
    places: std::sync::Arc<[u64]>,
    bytes: Vec<u8>,
    spare: Vec<u8>,
    /// Rest of a plain block: its place and length.
    plain: (u64, u64),
    /// A gap that was found behind the bytes.
    gap: u64,
    list: List,
    /// A single block, not in a list.
    single: u64,
    /// Bytes of the file the blocks seen so far take up: together no more than the file has.
    used: u64,
    /// Where reading is.
    place: u64,
    damages: Vec<Damage>,
}

/// A list of data blocks in the middle of being read.
#[derive(Debug, Default)]
struct List {
    /// Place of the next list.
    next: u64,
    /// Place of the next link, and how many there are.
    from: u64,
    left: u64,
    /// Links read ahead, the next one last.
    links: Vec<u64>,
}

impl DataStream {
    /// Data that begin with the block at `at`; 0 is no data.
    pub(super) fn new(
        file: BlockFile,
        at: u64,
        column: Column,
        unfinished: Unfinished,
        places: std::sync::Arc<[u64]>,
    ) -> Self {
        Self {
            file,
            column,
            unfinished,
            places,
            bytes: Vec::new(),
            spare: Vec::new(),
            plain: (0, 0),
            gap: 0,
            list: List::default(),
            single: at,
            used: 0,
            place: 0,
            damages: Vec::new(),
        }
    }

    /// So many bytes from `at` on, without blocks.
    pub(super) fn without_blocks(file: BlockFile, at: u64, bytes: u64) -> Self {
        let there = bytes.min(file.length().saturating_sub(at));
        let stream = Self::new(file, 0, Column::Values, Unfinished::default(), [].into());
        Self { plain: (at, there), ..stream }
    }

    /// The bytes of the piece that was read last.
    #[inline]
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Damages found since this was asked last.
    pub(super) fn take_damages(&mut self) -> Vec<Damage> {
        std::mem::take(&mut self.damages)
    }

    /// Share of the file in front of the block that was read last.
    pub(super) fn depth(&self) -> f64 {
        (self.place as f64 / self.file.length().max(1) as f64).min(1.0)
    }

    pub(super) fn next_piece(&mut self) -> Result<Piece, Mdf4Problem> {
        self.bytes.clear();
        loop {
            if self.gap > 0 {
                return Ok(Piece::Gap(std::mem::take(&mut self.gap)));
            }
            let (from, left) = self.plain;
            if left > 0 {
                let length = left.min(PIECE);
                self.bytes.resize(length as usize, 0);
                self.file.read(from, &mut self.bytes).map_err(FileProblem::Read)?;
                self.plain = (from + length, left - length);
                self.place = from;
                return Ok(Piece::Bytes);
            }
            let Some(at) = self.next_block()? else { return Ok(Piece::End) };
            self.place = at;
            if let Err(damage) = self.open(at)? {
                // Without its length it is unknown where the next block's records begin.
                self.damaged(damage);
                self.list = List::default();
            }
            if !self.bytes.is_empty() {
                return Ok(Piece::Bytes);
            }
        }
    }

    fn next_block(&mut self) -> Result<Option<u64>, Mdf4Problem> {
        if self.single != 0 {
            return Ok(Some(std::mem::take(&mut self.single)));
        }
        loop {
            if let Some(at) = self.list.links.pop() {
                // An unfinished list has places for blocks that were never written.
                if at != 0 {
                    return Ok(Some(at));
                }
            } else if self.list.left > 0 {
                self.read_links()?;
            } else if self.list.next != 0 {
                return Ok(Some(std::mem::take(&mut self.list.next)));
            } else {
                return Ok(None);
            }
        }
    }

    fn read_links(&mut self) -> Result<(), Mdf4Problem> {
        let List { from, left, .. } = self.list;
        let count = left.min(LINKS);
        let mut bytes = vec![0; 8 * count as usize];
        self.file.read(from, &mut bytes).map_err(FileProblem::Read)?;
        let links =
            bytes.rchunks_exact(8).map(|link| link.iter().rev().fold(0, |sum, b| sum << 8 | u64::from(*b)));
        self.list.links = links.collect();
        (self.list.from, self.list.left) = (from + 8 * count, left - count);
        Ok(())
    }

    /// Takes up the block at `at`, whatever it is.
    fn open(&mut self, at: u64) -> Result<Result<(), Damage>, Mdf4Problem> {
        let frame = match self.file.frame("data block", at) {
            Ok(frame) => frame,
            Err(fault) => return Ok(Err(fault.damage()?)),
        };
        match &frame.id {
            b"##DT" | b"##DV" | b"##DI" | b"##SD" => self.open_plain(at, frame)?,
            b"##DZ" => {
                self.count(frame.length.min(self.file.length() - at))?;
                match Zipped::read(&mut self.file, at, frame)? {
                    Ok(zipped) => self.inflate(&zipped)?,
                    Err(damage) => return Ok(Err(damage)),
                }
            }
            b"##DL" | b"##LD" => return self.open_list(at, frame),
            b"##HL" => {
                self.count(FRAME + 8)?;
                let head = Frame { length: FRAME + 8, links: 1, ..frame };
                match self.file.contents("list of data blocks", at, head, 0) {
                    Ok(block) => self.list = List { next: block.link(0), ..List::default() },
                    Err(fault) => return Ok(Err(fault.damage()?)),
                }
            }
            other => {
                let found = format!("found {}, expected data", shown(other));
                return Ok(Err(Damage::new("data block", at, found)));
            }
        }
        Ok(Ok(()))
    }

    fn open_plain(&mut self, at: u64, frame: Frame) -> Result<(), Mdf4Problem> {
        let there = self.file.length() - at;
        let mut length = frame.length;
        let following = self.following(at);
        if self.unfinished.last_length {
            // The last block's length was to be written at the end: it reaches to the end of the file. If other
            // blocks follow, it is not the last, unless it has no length at all.
            match following {
                None if self.is_last() => length = there,
                Some(following) if length <= FRAME => length = following - at,
                _ => {}
            }
        }
        if frame.length <= FRAME && length <= FRAME && there > FRAME && following.is_none() && self.is_last()
        {
            let found = "has no length; it is taken to reach to the end of the file";
            self.damaged(Damage::new("data block", at, found));
            length = there;
        }
        if let Some(following) = following.filter(|following| length > following - at) {
            let found = format!("{length} bytes long, but another begins after {}", following - at);
            self.damaged(Damage::new("data block", at, found));
            length = following - at;
            // Where the records of the next block begin is unknown.
            self.list = List::default();
        }
        if length > there {
            let found = format!("cut off, {} of {} bytes are there", there - FRAME, length - FRAME);
            self.damaged(Damage::new("data block", at, found));
            length = there;
        }
        self.count(length)?;
        self.plain = (at + FRAME, length.saturating_sub(FRAME));
        Ok(())
    }

    /// The next block behind `at` that is known of.
    fn following(&self, at: u64) -> Option<u64> {
        let place = self.places.get(self.places.partition_point(|place| *place <= at)).copied();
        let link = self.list.links.last().copied().filter(|link| *link > at);
        match (place, link) {
            (Some(place), Some(link)) => Some(place.min(link)),
            (place, link) => place.or(link),
        }
    }

    /// Whether no further block is in the list.
    fn is_last(&self) -> bool {
        self.list.left == 0 && self.list.next == 0 && self.list.links.iter().all(|link| *link == 0)
    }

    fn inflate(&mut self, zipped: &Zipped) -> Result<(), Mdf4Problem> {
        let inflated = zipped.inflate(&mut self.file, &mut self.bytes, &mut self.spare)?;
        self.gap = inflated.lost;
        if let Some(damage) = inflated.damage {
            self.damaged(damage);
        }
        Ok(())
    }

    /// DL: link to the next list, then the blocks. LD: behind them as many links to invalidation bytes.
    fn open_list(&mut self, at: u64, frame: Frame) -> Result<Result<(), Damage>, Mdf4Problem> {
        let damage = |found: String| Damage::new("list of data blocks", at, found);
        let there = self.file.length() - at - FRAME;
        if frame.links == 0 || there < 8 {
            return Ok(Err(damage(format!("{} links, {there} bytes behind them", frame.links))));
        }
        let mut bytes = [0; 8];
        self.file.read(at + FRAME, &mut bytes).map_err(FileProblem::Read)?;
        let next = u64::from_le_bytes(bytes);
        let linked = frame.links.saturating_mul(8);
        let whole = linked.saturating_add(8) <= there;
        if whole {
            self.file.read(at + FRAME + linked, &mut bytes).map_err(FileProblem::Read)?;
        } else if frame.id == *b"##DL" {
            self.damaged(damage("cut off; its first links are used".to_owned()));
            bytes[4..].copy_from_slice(&u32::MAX.to_le_bytes());
        } else {
            return Ok(Err(damage("cut off".to_owned())));
        }
        self.count(FRAME + linked.min(there))?;
        let mut count = u64::from(u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]));
        if self.unfinished.last_list && count == 0 {
            count = frame.links - 1;
        }
        let skipped = match self.column {
            Column::Values => 0,
            Column::Invalidation if bytes[3] & APART != 0 => count,
            Column::Invalidation => return Ok(Err(damage("has no invalidation bytes".to_owned()))),
        };
        let linked = (frame.links - 1).min(there / 8 - 1);
        let left = count.min(linked.saturating_sub(skipped));
        self.list = List { next, from: at + FRAME + 8 + 8 * skipped, left, links: Vec::new() };
        Ok(Ok(()))
    }

    /// Keeps the first damages; what is wrong with the others is likely the same.
    fn damaged(&mut self, damage: Damage) {
        if self.damages.len() < DAMAGES {
            self.damages.push(damage);
        }
    }

    /// Adds up what the blocks take in the file; more than the file has is a ring.
    fn count(&mut self, bytes: u64) -> Result<(), Mdf4Problem> {
        self.used = self.used.saturating_add(bytes);
        if self.used > self.file.length() {
            return Err(Mdf4Problem::Overlap);
        }
        Ok(())
    }
}

/// Whether the data at `at` keep their invalidation bytes apart from the values.
pub(super) fn has_invalidation_apart(file: &mut BlockFile, at: u64) -> Result<bool, Mdf4Problem> {
    let mut at = at;
    for _ in 0..2 {
        if at == 0 {
            return Ok(false);
        }
        let frame = match file.frame("data block", at) {
            Ok(frame) => frame,
            Err(Fault::System(error)) => return Err(FileProblem::Read(error).into()),
            Err(Fault::Damaged(_)) => return Ok(false),
        };
        let end = frame.links.checked_mul(8).and_then(|links| links.checked_add(at + FRAME));
        match &frame.id {
            b"##HL" if at + FRAME + 8 <= file.length() => {
                let mut link = [0; 8];
                file.read(at + FRAME, &mut link).map_err(FileProblem::Read)?;
                at = u64::from_le_bytes(link);
            }
            b"##LD" if end.is_some_and(|end| end.saturating_add(8) <= file.length()) => {
                let mut flags = [0; 8];
                file.read(end.unwrap_or(0), &mut flags).map_err(FileProblem::Read)?;
                return Ok(flags[3] & APART != 0);
            }
            _ => return Ok(false),
        }
    }
    Ok(false)
}
