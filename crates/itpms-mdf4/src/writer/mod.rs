//! MDF4 written as a stream: several groups at their own rates, whole or compressed, in bounded memory.
//!
//! Called by whoever converts or simulates logs. The tree stands in front of the data, lists of blocks behind every
//! sixteen blocks, so that of a file that is cut later the part before the cut can be read; links and counts are filled
//! in when they are known. Each group has up to 1 MB of samples in memory, compressing takes three times that.

mod blocks;
mod spec;

use std::io;
use std::path::Path;

use flate2::{Compress, FlushCompress, Status};
use itpms_files::{AtomicFile, FileProblem};

pub use self::spec::{ChannelSpec, Compression, GroupSpec, SampleFormat};

use self::blocks::{Places, block, frame};
use super::block::FRAME;
use super::error::{Mdf4Error, Mdf4Problem};
use super::records::MOST_RECORD;

/// Bytes of samples in a data block, if a record is not longer.
const BLOCK: usize = 1 << 20;

const LISTED: usize = 16;

/// Of 9. More costs three times the time for a few percent on measured accelerations.
const LEVEL: u32 = 2;

/// An MDF4 file (4.10) in the making.
#[derive(Debug)]
pub struct Mdf4Writer {
    file: AtomicFile,
    compression: Compression,
    groups: Vec<Group>,
    end: u64,
    start_ns: u64,
    /// Memory for turning and compressing a block.
    turned: Vec<u8>,
    packed: Vec<u8>,
}

#[derive(Debug)]
struct Group {
    spec: GroupSpec,
    places: Places,
    record: usize,
    invalid: Vec<u8>,
    count: u64,
    /// Samples that are not written yet.
    waiting: Vec<u8>,
    /// Places of the data blocks that are in no list yet.
    blocks: Vec<u64>,
    /// Where the place of the next list goes, once there is a list before it.
    link: Option<u64>,
}

impl Mdf4Writer {
    /// Begins a file with these groups.
    ///
    /// # Errors
    /// The file cannot be written, or is a pipe; a record would be longer than 4 MB.
    pub fn create(path: &Path, groups: &[GroupSpec], compression: Compression) -> Result<Self, Mdf4Error> {
        let fail = |problem| Err(Mdf4Error::new(path, problem));
        for group in groups {
            let (values, invalid) = blocks::widths(group);
            let (found, most) = ((values + invalid) as u64, MOST_RECORD);
            if found > most {
                return fail(Mdf4Problem::RecordLength { group: group.name.clone(), found, most });
            }
        }
        let mut file = AtomicFile::create(path)?;
        if file.is_device() {
            return fail(Mdf4Problem::Device);
        }
        let head = blocks::head(groups);
        file.append(&head.bytes)?;
        let groups = groups.iter().zip(head.places).map(|(spec, places)| Group::new(spec, places)).collect();
        let end = head.bytes.len() as u64;
        Ok(Self { file, compression, groups, end, start_ns: 0, turned: Vec::new(), packed: Vec::new() })
    }

    /// When time 0 was, in ns since 1970; 1970 unless this is called.
    pub fn set_start_ns(&mut self, start_ns: u64) {
        self.start_ns = start_ns;
    }

    /// Adds a sample to `group`: its time in s and one value per channel, NaN where it is missing. Within a group time
    /// should increase; groups may be written in any order.
    ///
    /// # Errors
    /// There is no such group, not one value per channel, no finite time, a number its integer channel cannot hold, or the disk is full.
    pub fn write(&mut self, group: usize, time_s: f64, values: &[f64]) -> Result<(), Mdf4Error> {
        let found = self.groups.get_mut(group).ok_or(Mdf4Problem::NoSuchGroup(group));
        let added = found.and_then(|group| group.add(time_s, values));
        let full = added.map_err(|problem| Mdf4Error::new(self.file.target(), problem))?;
        if !full {
            return Ok(());
        }
        self.write_block(group)?;
        if self.groups[group].blocks.len() < LISTED { Ok(()) } else { self.write_list(group) }
    }

    /// Completes the file, which the caller commits.
    ///
    /// # Errors
    /// The disk is full.
    pub fn finish(mut self) -> Result<AtomicFile, Mdf4Error> {
        for group in 0..self.groups.len() {
            if !self.groups[group].waiting.is_empty() {
                self.write_block(group)?;
            }
            let Group { places, count, link, blocks, .. } = &self.groups[group];
            self.file.replace(places.count, &count.to_le_bytes())?;
            match (link, blocks.as_slice()) {
                (_, []) => {}
                // One block needs no list.
                (None, [block]) => self.file.replace(places.data, &block.to_le_bytes())?,
                _ => self.write_list(group)?,
            }
        }
        if self.start_ns != 0 {
            self.file.replace(blocks::START, &self.start_ns.to_le_bytes())?;
        }
        Ok(self.file)
    }

    /// Writes the waiting samples of a group as a data block.
    fn write_block(&mut self, group: usize) -> Result<(), Mdf4Error> {
        let failed = |error| Mdf4Error::new(self.file.target(), FileProblem::Write(error));
        let group = &mut self.groups[group];
        let (columns, length) = (group.record as u32, group.waiting.len() as u64);
        let method = match self.compression {
            Compression::None => {
                let frame = frame(b"DT", FRAME + length, 0);
                group.blocks.push(self.end);
                self.end += append(&mut self.file, &[&frame, &group.waiting])?;
                group.waiting.clear();
                return Ok(());
            }
            Compression::Deflate => {
                compress(&group.waiting, &mut self.packed).map_err(failed)?;
                0
            }
            Compression::Transposed => {
                transpose(&group.waiting, group.record, &mut self.turned);
                compress(&self.turned, &mut self.packed).map_err(failed)?;
                1
            }
        };
        // DZBLOCK: what was compressed and how, the length of a row, the lengths before and after.
        let mut about = [0; 24];
        about[..2].copy_from_slice(b"DT");
        about[2] = method;
        about[4..8].copy_from_slice(&(if method == 1 { columns } else { 0 }).to_le_bytes());
        about[8..16].copy_from_slice(&length.to_le_bytes());
        about[16..].copy_from_slice(&(self.packed.len() as u64).to_le_bytes());
        let frame = frame(b"DZ", FRAME + about.len() as u64 + self.packed.len() as u64, 0);
        group.blocks.push(self.end);
        self.end += append(&mut self.file, &[&frame, &about, &self.packed])?;
        group.waiting.clear();
        Ok(())
    }

    /// Writes a list of the blocks that are in none, and links to it from the one before or from the tree.
    fn write_list(&mut self, group: usize) -> Result<(), Mdf4Error> {
        let group = &mut self.groups[group];
        let links: Vec<u64> = std::iter::once(0).chain(group.blocks.drain(..)).collect();
        // Flag 1: all blocks but the very last have the same length.
        let mut data = vec![1, 0, 0, 0];
        data.extend((links.len() as u32 - 1).to_le_bytes());
        data.extend((group.block_bytes() as u64).to_le_bytes());
        let list = self.end;
        self.end += append(&mut self.file, &[&block(b"DL", &links, &data)])?;
        let method = match self.compression {
            Compression::None => None,
            Compression::Deflate => Some(0),
            Compression::Transposed => Some(1),
        };
        match (group.link.replace(list + FRAME), method) {
            (Some(before), _) => self.file.replace(before, &list.to_le_bytes())?,
            (None, None) => self.file.replace(group.places.data, &list.to_le_bytes())?,
            // Compressed blocks have a head before their first list.
            (None, Some(method)) => {
                let head = self.end;
                self.end +=
                    append(&mut self.file, &[&block(b"HL", &[list], &[1, 0, method, 0, 0, 0, 0, 0])])?;
                self.file.replace(group.places.data, &head.to_le_bytes())?;
            }
        }
        Ok(())
    }
}

impl Group {
    fn new(spec: &GroupSpec, places: Places) -> Self {
        let (values, invalid) = blocks::widths(spec);
        Self {
            spec: spec.clone(),
            places,
            record: values + invalid,
            invalid: vec![0; invalid],
            count: 0,
            waiting: Vec::new(),
            blocks: Vec::new(),
            link: None,
        }
    }

    /// Bytes of a full block: whole records.
    fn block_bytes(&self) -> usize {
        (BLOCK / self.record).max(1) * self.record
    }

    /// Adds a sample; whether the block is full. Of a sample that cannot be stored nothing is.
    fn add(&mut self, time_s: f64, values: &[f64]) -> Result<bool, Mdf4Problem> {
        let (found, expected) = (values.len(), self.spec.channels.len());
        if found != expected {
            return Err(Mdf4Problem::SampleWidth { group: self.spec.name.clone(), found, expected });
        }
        if !time_s.is_finite() {
            return Err(Mdf4Problem::SampleTime { group: self.spec.name.clone(), found: time_s });
        }
        let begun = self.waiting.len();
        self.waiting.extend(time_s.to_le_bytes());
        self.invalid.fill(0);
        let mut integers = 0;
        for (channel, value) in self.spec.channels.iter().zip(values) {
            let mut value = *value;
            if channel.format.is_integer() {
                let (byte, bit) = (integers / 8, integers % 8);
                integers += 1;
                let (least, most) = channel.format.range();
                if value.is_nan() {
                    self.invalid[byte] |= 1 << bit;
                    value = 0.0;
                }
                value = value.round();
                if !(least..=most).contains(&value) {
                    self.waiting.truncate(begun);
                    return Err(Mdf4Problem::IntegerRange {
                        channel: channel.name.clone(),
                        found: value,
                        least,
                        most,
                    });
                }
            }
            channel.format.store(value, &mut self.waiting);
        }
        self.waiting.extend(&self.invalid);
        self.count += 1;
        Ok(self.waiting.len() >= self.block_bytes())
    }
}

/// Appends the parts of a block and fills up to a multiple of eight bytes; how many bytes that were.
fn append(file: &mut AtomicFile, parts: &[&[u8]]) -> Result<u64, Mdf4Error> {
    let mut length = 0;
    for part in parts {
        file.append(part)?;
        length += part.len();
    }
    let padding = length.next_multiple_of(8) - length;
    file.append(&[0; 8][..padding])?;
    Ok((length + padding) as u64)
}

/// Bytes column by column; `bytes` are whole rows of `columns` bytes.
fn transpose(bytes: &[u8], columns: usize, turned: &mut Vec<u8>) {
    turned.clear();
    for column in 0..columns {
        turned.extend(bytes.iter().skip(column).step_by(columns));
    }
}

/// Deflates `bytes` into `packed`, with zlib's head and check sum.
fn compress(bytes: &[u8], packed: &mut Vec<u8>) -> io::Result<()> {
    let mut deflate = Compress::new(flate2::Compression::new(LEVEL), true);
    packed.clear();
    // Deflate never grows by more than five bytes in 16 kB: with this much room it ends in one step.
    packed.reserve(bytes.len() + bytes.len() / 1000 + 256);
    match deflate.compress_vec(bytes, packed, FlushCompress::Finish)? {
        Status::StreamEnd => Ok(()),
        _ => Err(io::Error::other("deflate came to no end")),
    }
}
