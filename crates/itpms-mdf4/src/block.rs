//! Blocks of an MDF4 file: read at their places, never believed before they are held against the file's length.
//!
//! Called by the readers of structure and data; knows the frame every block has (identifier, length, links), not what is inside.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use itpms_files::FileProblem;

use super::error::{Damage, Mdf4Problem};

/// Identifier, reserved bytes, length and number of links (ASAM MDF 4.1, section "block structure").
pub(super) const FRAME: u64 = 24;

/// Links of a block that is read whole: a text table has up to 65 535 of them. (Data lists are read in parts.)
const MOST_LINKS: u64 = 1 << 17;

/// Bytes of the identification block, which has no frame.
pub(super) const IDENTIFICATION: u64 = 64;

/// Why something could not be read: the file is damaged there, or the system refused.
#[derive(Debug)]
pub(super) enum Fault {
    Damaged(Damage),
    System(io::Error),
}

impl Fault {
    pub(super) fn into_problem(self) -> Mdf4Problem {
        match self {
            Fault::Damaged(damage) => Mdf4Problem::Unreadable(damage),
            Fault::System(error) => FileProblem::Read(error).into(),
        }
    }

    /// The damage, where one can go on without the block.
    pub(super) fn damage(self) -> Result<Damage, Mdf4Problem> {
        match self {
            Fault::Damaged(damage) => Ok(damage),
            Fault::System(error) => Err(FileProblem::Read(error).into()),
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) id: [u8; 4],
    /// Length of the whole block in bytes, at least [`FRAME`]; it may reach beyond the end of the file.
    pub(super) length: u64,
    /// Number of links; they may reach beyond the end of the block.
    pub(super) links: u64,
}

/// A kind of block: what it is called, and what it has at least.
#[derive(Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) id: &'static [u8; 4],
    pub(super) links: usize,
    /// Bytes behind the links it has at least.
    pub(super) data: usize,
    /// Bytes behind the links that are read at most.
    pub(super) most: u64,
}

/// A small block, read whole or up to a bound.
#[derive(Debug, Default)]
pub(super) struct Block {
    links: Vec<u64>,
    pub(super) data: Vec<u8>,
}

impl Block {
    /// The n-th link; 0, which means nowhere, if there are not so many.
    pub(super) fn link(&self, n: usize) -> u64 {
        self.links.get(n).copied().unwrap_or(0)
    }

    pub(super) fn links(&self) -> usize {
        self.links.len()
    }

    /// `N` bytes of the data from `offset`; zeros if the block is shorter.
    pub(super) fn bytes<const N: usize>(&self, offset: usize) -> [u8; N] {
        let found = offset.checked_add(N).and_then(|end| self.data.get(offset..end));
        found.and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; N])
    }

    pub(super) fn u8(&self, offset: usize) -> u8 {
        u8::from_le_bytes(self.bytes(offset))
    }

    pub(super) fn u16(&self, offset: usize) -> u16 {
        u16::from_le_bytes(self.bytes(offset))
    }

    pub(super) fn u32(&self, offset: usize) -> u32 {
        u32::from_le_bytes(self.bytes(offset))
    }

    pub(super) fn u64(&self, offset: usize) -> u64 {
        u64::from_le_bytes(self.bytes(offset))
    }

    pub(super) fn f64(&self, offset: usize) -> f64 {
        f64::from_le_bytes(self.bytes(offset))
    }
}

#[derive(Debug)]
pub(super) struct BlockFile {
    file: File,
    length: u64,
    /// Bytes that may still be read through [`BlockFile::block`]. Blocks do not overlap, so that all of them together
    /// are no longer than the file; damaged ones that do would be read again and again.
    budget: u64,
}

impl BlockFile {
    pub(super) fn new(file: File) -> io::Result<Self> {
        let length = file.metadata()?.len();
        Ok(Self { file, length, budget: length.saturating_mul(2).saturating_add(1 << 16) })
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Fills `bytes` from `at`, which the caller has held against [`BlockFile::length`].
    pub(super) fn read(&mut self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(at))?;
        self.file.read_exact(bytes)
    }

    /// The frame of the block at `at`, called `name` in messages.
    pub(super) fn frame(&mut self, name: &'static str, at: u64) -> Result<Frame, Fault> {
        let damaged = |found: String| Fault::Damaged(Damage::new(name, at, found));
        if at < IDENTIFICATION {
            return Err(damaged("a link into the identification".to_owned()));
        }
        if at.checked_add(FRAME).is_none_or(|end| end > self.length) {
            return Err(damaged(format!("the file ends at byte {}", self.length)));
        }
        let mut bytes = Block { links: Vec::new(), data: vec![0; FRAME as usize] };
        self.read(at, &mut bytes.data).map_err(Fault::System)?;
        let frame = Frame { id: bytes.bytes(0), length: bytes.u64(8), links: bytes.u64(16) };
        if frame.id[..2] != *b"##" {
            return Err(damaged(format!("found {}, expected a block", shown(&frame.id))));
        }
        if frame.length < FRAME {
            // A data block that was being written has no length yet; its reader knows what to do.
            return Ok(Frame { length: FRAME, ..frame });
        }
        Ok(frame)
    }

    /// The block of this kind at `at`.
    pub(super) fn block(&mut self, kind: &Kind, at: u64) -> Result<Block, Fault> {
        let frame = self.frame(kind.name, at)?;
        let damaged = |found: String| Fault::Damaged(Damage::new(kind.name, at, found));
        if frame.id != *kind.id {
            return Err(damaged(format!("found {}, expected {}", shown(&frame.id), shown(kind.id))));
        }
        let block = self.contents(kind.name, at, frame, kind.most)?;
        if block.links.len() < kind.links || block.data.len() < kind.data {
            return Err(damaged(format!(
                "{} bytes and {} links are too few for it",
                frame.length, frame.links
            )));
        }
        Ok(block)
    }

    /// The content behind a frame; of its data at most `most` bytes.
    pub(super) fn contents(
        &mut self,
        name: &'static str,
        at: u64,
        frame: Frame,
        most: u64,
    ) -> Result<Block, Fault> {
        let damaged = |found: String| Fault::Damaged(Damage::new(name, at, found));
        let inside = frame.length - FRAME;
        if at.checked_add(frame.length).is_none_or(|end| end > self.length) {
            return Err(damaged(format!(
                "{} bytes long, the file ends at byte {}",
                frame.length, self.length
            )));
        }
        let linked = frame.links.checked_mul(8).filter(|bytes| *bytes <= inside.min(8 * MOST_LINKS));
        let Some(linked) = linked else {
            return Err(damaged(format!("{} links in {} bytes", frame.links, frame.length)));
        };
        let wanted = linked + (inside - linked).min(most);
        let Some(budget) = self.budget.checked_sub(FRAME + wanted) else {
            return Err(damaged("blocks overlap: together they are longer than the file".to_owned()));
        };
        self.budget = budget;
        // Bounded by the file's length, by MOST_LINKS and by `most`.
        let mut bytes = vec![0; usize::try_from(wanted).map_err(|_| damaged("too long".to_owned()))?];
        self.read(at + FRAME, &mut bytes).map_err(Fault::System)?;
        let data = bytes.split_off(linked as usize);
        let links =
            bytes.chunks_exact(8).map(|link| link.iter().rev().fold(0, |sum, b| sum << 8 | u64::from(*b)));
        Ok(Block { links: links.collect(), data })
    }
}

pub(super) fn shown(bytes: &[u8]) -> String {
    format!("{:?}", String::from_utf8_lossy(bytes))
}
