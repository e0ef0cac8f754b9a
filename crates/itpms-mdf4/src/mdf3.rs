//! The tree of an MDF file of version 2 or 3 (`.dat` of INCA and others, ASAM MDF 3.3): read into the same groups, layouts and records that MDF4 has.
//!
//! Called by the reader once it knows the version. Blocks have two letters, a length of two bytes, and links of four bytes at fixed places; the data of a group lie in
//! one stretch without a frame. Every block is visited once.

use std::collections::HashSet;
use std::sync::Arc;

use itpms_files::{Date, FileProblem, decoded};

use super::block::{BlockFile, IDENTIFICATION};
use super::channel::{Channel, ChannelGroup, ChannelKind, Layout, Validity};
use super::conversion::{Between, Conversion, Raw, table};
use super::error::{Damage, Mdf4Problem, Mdf4Repair, Repairs};
use super::field::{ByteOrder, Field, Number};
use super::formula::Formula;
use super::structure::{DataGroup, GroupLayout, MOST_CHANNELS, MOST_GROUPS, Record, Structure, too_many};

/// Numbers of all tables of a file.
const MOST_NUMBERS: usize = 1 << 21;

/// A block and the order of its bytes.
struct Block {
    bytes: Vec<u8>,
    order: ByteOrder,
}

impl Block {
    fn array<const N: usize>(&self, at: usize) -> [u8; N] {
        let found = at.checked_add(N).and_then(|end| self.bytes.get(at..end));
        let mut bytes = found.and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; N]);
        if self.order == ByteOrder::BigEndian {
            bytes.reverse();
        }
        bytes
    }

    fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.array(at))
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.array(at))
    }

    fn link(&self, at: usize) -> u64 {
        u64::from(self.u32(at))
    }

    fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.array(at))
    }

    /// Text of so many bytes at most, up to the first zero.
    fn text(&self, at: usize, length: usize) -> String {
        let bytes = self.bytes.get(at..).unwrap_or_default();
        let bytes = bytes.get(..length).unwrap_or(bytes);
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        decoded(&bytes[..end]).trim().to_owned()
    }
}

pub(super) fn read(file: &mut BlockFile, repairs: &mut Repairs) -> Result<Structure, Mdf4Problem> {
    let mut head = [0; IDENTIFICATION as usize];
    file.read(0, &mut head).map_err(FileProblem::Read)?;
    let values = if head[24..26] == [0, 0] { ByteOrder::LittleEndian } else { ByteOrder::BigEndian };
    // Writers that say Motorola mean the samples, some of them the blocks as well: the length of the header, a few hundred bytes, tells.
    let mut length = [0; 4];
    file.read(IDENTIFICATION, &mut length).map_err(FileProblem::Read)?;
    let order = if length[3] < 4 { ByteOrder::LittleEndian } else { ByteOrder::BigEndian };
    let mut walk = Walk {
        file,
        repairs,
        order,
        values,
        visited: HashSet::new(),
        channels: 0,
        numbers: 0,
        structure: Structure::default(),
        cut: None,
    };
    let Some(header) = walk.block("header", b"HD", IDENTIFICATION)? else {
        let cut = walk.cut.unwrap_or_else(|| Damage::new("header", IDENTIFICATION, "none"));
        return Err(Mdf4Problem::Unreadable(cut));
    };
    walk.structure.start_ns = start_ns(&header);
    walk.data_groups(header.link(4))?;
    let Walk { structure, cut, .. } = walk;
    if structure.groups.is_empty() {
        return Err(Mdf4Problem::NoGroup(cut));
    }
    Ok(structure)
}

/// `DD:MM:YYYY` and `HH:MM:SS`, local time; 0 where they are none.
fn start_ns(header: &Block) -> u64 {
    let numbers = |at, length| {
        let text = header.text(at, length);
        let mut numbers = text.split([':', '.']).map(|part| part.parse::<u32>().ok());
        Some((numbers.next()??, numbers.next()??, numbers.next()??))
    };
    let date = numbers(18, 10).zip(numbers(28, 8)).map(|((day, month, year), (hour, minute, second))| Date {
        year: i64::from(year),
        month,
        day,
        hour,
        minute,
        second,
    });
    let seconds = date.and_then(Date::seconds).and_then(|seconds| u64::try_from(seconds).ok());
    seconds.unwrap_or(0).saturating_mul(1_000_000_000)
}

struct Walk<'a> {
    file: &'a mut BlockFile,
    repairs: &'a mut Repairs,
    /// Of the blocks, and of samples that do not say.
    order: ByteOrder,
    values: ByteOrder,
    visited: HashSet<u64>,
    channels: usize,
    /// Numbers of all tables so far.
    numbers: usize,
    structure: Structure,
    /// The first break of a list.
    cut: Option<Damage>,
}

impl Walk<'_> {
    /// The block of this kind at `at`; `None`, and a repair, where there is none.
    fn block(&mut self, name: &'static str, id: &[u8; 2], at: u64) -> Result<Option<Block>, Mdf4Problem> {
        let found = self.block_or_damage(name, id, at)?;
        Ok(found
            .map_err(|damage| {
                self.repairs.push(Mdf4Repair::ListCut {
                    list: format!("{name}s"),
                    read: 0,
                    damage: damage.clone(),
                });
                self.cut.get_or_insert(damage);
            })
            .ok())
    }

    fn block_or_damage(
        &mut self,
        name: &'static str,
        id: &[u8; 2],
        at: u64,
    ) -> Result<Result<Block, Damage>, Mdf4Problem> {
        let damaged = |found: String| Ok(Err(Damage::new(name, at, found)));
        if at < IDENTIFICATION || at + 4 > self.file.length() {
            return damaged(format!("a link beyond the file's {} bytes", self.file.length()));
        }
        let mut block = Block { bytes: vec![0; 4], order: self.order };
        self.file.read(at, &mut block.bytes).map_err(FileProblem::Read)?;
        if block.bytes[..2] != *id {
            let found = String::from_utf8_lossy(&block.bytes[..2]).into_owned();
            return damaged(format!("found {found:?}, expected {:?}", String::from_utf8_lossy(id)));
        }
        let length = block.u16(2).max(4);
        if at + u64::from(length) > self.file.length() {
            return damaged(format!("{length} bytes long, the file ends at byte {}", self.file.length()));
        }
        block.bytes.resize(usize::from(length), 0);
        self.file.read(at, &mut block.bytes).map_err(FileProblem::Read)?;
        Ok(Ok(block))
    }

    /// The next block of a list that is not walked in a ring.
    fn next(&mut self, name: &'static str, id: &[u8; 2], at: u64) -> Result<Option<Block>, Mdf4Problem> {
        if at == 0 {
            return Ok(None);
        }
        if !self.visited.insert(at) {
            let damage = Damage::new(name, at, "a link back to a block that was read before");
            self.repairs.push(Mdf4Repair::ListCut { list: format!("{name}s"), read: 0, damage });
            return Ok(None);
        }
        self.block(name, id, at)
    }

    fn data_groups(&mut self, first: u64) -> Result<(), Mdf4Problem> {
        let mut at = first;
        while let Some(block) = self.next("data group", b"DG", at)? {
            let index = self.structure.data.len();
            if index == MOST_GROUPS {
                return Err(too_many("data groups", MOST_GROUPS));
            }
            // Two: the record's id stands behind it as well.
            let id_bytes = block.u16(22).min(2);
            self.structure.data.push(DataGroup {
                data: block.link(16),
                id_bytes: usize::from(id_bytes.min(1)),
                records: Vec::new(),
                plain: Some(0),
            });
            let bytes = self.channel_groups(block.link(8), index, id_bytes)?;
            if let Some(data) = self.structure.data.get_mut(index) {
                let there = self.file.length().saturating_sub(data.data);
                data.plain = Some(bytes.min(there));
            }
            at = block.link(4);
        }
        Ok(())
    }

    fn channel_groups(&mut self, first: u64, data_group: usize, id_bytes: u16) -> Result<u64, Mdf4Problem> {
        let (mut at, mut bytes) = (first, 0u64);
        while let Some(block) = self.next("channel group", b"CG", at)? {
            if self.structure.groups.len() == MOST_GROUPS {
                return Err(too_many("channel groups", MOST_GROUPS));
            }
            let (record, samples) = (block.u16(20), u64::from(block.u32(22)));
            let behind = u64::from(id_bytes == 2);
            let length = u64::from(record) + behind;
            bytes = bytes.saturating_add(samples.saturating_mul(length + u64::from(id_bytes.min(1))));
            let id = u64::from(block.u16(16));
            if let Some(data) = self.structure.data.get_mut(data_group) {
                data.records.push(Record { id, bytes: Some(length) });
            }
            let mut name = self.text(block.link(12))?;
            if name.is_empty() {
                name = format!("group {}", self.structure.groups.len() + 1);
            }
            let (channels, layouts) = self.channels(block.link(8), u32::from(record))?;
            let time = (0..channels.len()).find(|i| channels[*i].is_time && layouts[*i].is_some());
            self.structure.groups.push(ChannelGroup {
                name,
                samples: Some(samples),
                has_time: time.is_some(),
                channels,
            });
            let mut layout = GroupLayout::plain(data_group, id, u32::from(record), behind as u32);
            (layout.bytes, layout.channels, layout.time) = (vec![None; layouts.len()], layouts, time);
            self.structure.layouts.push(layout);
            at = block.link(4);
        }
        Ok(bytes)
    }

    fn channels(
        &mut self,
        first: u64,
        record: u32,
    ) -> Result<(Vec<Channel>, Vec<Option<Layout>>), Mdf4Problem> {
        let (mut channels, mut layouts) = (Vec::new(), Vec::new());
        let mut at = first;
        while let Some(block) = self.next("channel", b"CN", at)? {
            if self.channels == MOST_CHANNELS {
                return Err(too_many("channels", MOST_CHANNELS));
            }
            self.channels += 1;
            let long = self.text(block.link(218))?;
            let name = if long.is_empty() { block.text(26, 32) } else { long };
            let is_time = block.u16(24) == 1;
            let conversion = match block.link(8) {
                0 => None,
                at => self.block("conversion", b"CC", at)?,
            };
            let unit = conversion.as_ref().map_or(String::new(), |conversion| conversion.text(22, 20));
            let (kind, layout) = match field(&block, self.values, record) {
                Err(kind) => (kind, None),
                Ok((field, raw)) => match conversion.map(|block| self.conversion(&block)) {
                    Some(Conversion::Unreadable(why)) => (ChannelKind::Unreadable(why), None),
                    conversion => {
                        let conversion = Arc::new(conversion.unwrap_or(Conversion::Identity));
                        (
                            ChannelKind::Number,
                            Some(Layout { field, raw, conversion, validity: Validity::All }),
                        )
                    }
                },
            };
            channels.push(Channel { name, unit, comment: block.text(58, 128), is_time, element: None, kind });
            layouts.push(layout);
            at = block.link(4);
        }
        Ok((channels, layouts))
    }

    fn text(&mut self, at: u64) -> Result<String, Mdf4Problem> {
        if at == 0 {
            return Ok(String::new());
        }
        let block = self.block("text", b"TX", at)?;
        Ok(block.map_or(String::new(), |block| block.text(4, super::text::LONGEST)))
    }

    /// Conversion to a physical value (CCBLOCK).
    fn conversion(&mut self, block: &Block) -> Conversion {
        let count = usize::from(block.u16(44));
        let p = |i: usize| block.f64(46 + 8 * i);
        let stored = block.bytes.len().saturating_sub(46) / 8;
        match block.u16(42) {
            0 if stored >= 2 => Conversion::Linear { offset: p(0), factor: p(1) },
            kind @ (1 | 2) if stored >= 2 => {
                let pairs: Vec<f64> = (0..(2 * count).min(stored)).map(p).collect();
                self.numbers += pairs.len();
                if self.numbers > MOST_NUMBERS {
                    let why = format!(
                        "converted by a table beyond the {MOST_NUMBERS} numbers that all tables may have"
                    );
                    return Conversion::Unreadable(why);
                }
                table(&pairs, if kind == 1 { Between::Interpolated } else { Between::Nearest })
            }
            6 if stored >= 6 => {
                // (P2 - P4 (x - c)) / (P3 (x - c) - P1) with c = P5 + P6, ordered by powers of x.
                let c = p(4) + p(5);
                Conversion::Rational([0.0, -p(3), p(1) + p(3) * c, 0.0, p(2), -(p(0) + p(2) * c)])
            }
            kind @ (7 | 8) if stored >= 7 => {
                // The logarithm undoes an exponential, and the other way round.
                let inverse = if kind == 7 { "log" } else { "exp" };
                let [a, b, c, d, e, f, g] = std::array::from_fn(p);
                computed(&if d == 0.0 {
                    format!("{inverse}(((X-({g:?}))*({f:?})-({c:?}))/({a:?}))/({b:?})")
                } else {
                    format!("{inverse}((({c:?})/(X-({g:?}))-({f:?}))/({d:?}))/({e:?})")
                })
            }
            9 if stored >= 6 => Conversion::Rational(std::array::from_fn(p)),
            10 => computed(&block.text(46, 256)),
            // Words for numbers: the number stays.
            11 | 12 | 65_535 => Conversion::Identity,
            132 | 133 => Conversion::Unreadable("a date".to_owned()),
            0..=2 | 6..=9 => Conversion::Unreadable(format!("converted by a table of {stored} numbers")),
            other => Conversion::Unreadable(format!("converted by a conversion of unknown type {other}")),
        }
    }
}

fn computed(text: &str) -> Conversion {
    match Formula::parse(text) {
        Ok(formula) => Conversion::Formula(formula),
        Err(rest) => {
            let (text, rest): (String, String) =
                (text.chars().take(60).collect(), rest.chars().take(20).collect());
            Conversion::Unreadable(format!(
                "converted by the formula {text:?}, of which {rest:?} is not understood"
            ))
        }
    }
}

/// Where a channel's number lies, or what the channel is instead.
fn field(block: &Block, order: ByteOrder, record: u32) -> Result<(Field, Raw), ChannelKind> {
    use ByteOrder::{BigEndian, LittleEndian};
    let (number, order) = match block.u16(190) {
        0 => (Number::Unsigned, order),
        1 => (Number::Signed, order),
        2 | 3 => (Number::Float, order),
        9 => (Number::Unsigned, BigEndian),
        10 => (Number::Signed, BigEndian),
        11 | 12 => (Number::Float, BigEndian),
        13 => (Number::Unsigned, LittleEndian),
        14 => (Number::Signed, LittleEndian),
        15 | 16 => (Number::Float, LittleEndian),
        7 => return Err(ChannelKind::Text),
        8 => return Err(ChannelKind::Bytes),
        4..=6 => return Err(ChannelKind::Unreadable("floating-point numbers of a VAX".to_owned())),
        other => return Err(ChannelKind::Unreadable(format!("data of unknown type {other}"))),
    };
    let (offset, bits) = (u32::from(block.u16(186)), u32::from(block.u16(188)));
    let byte = offset / 8 + u32::from(block.u16(226));
    let raw = if number == Number::Float { Raw::Float } else { Raw::Integer };
    Field::new(number, order, byte, (offset % 8) as u8, bits, record)
        .map(|field| (field, raw))
        .map_err(ChannelKind::Unreadable)
}
