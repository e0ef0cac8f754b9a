//! The tree of a file: data groups, channel groups, channels.
//!
//! Called by the reader once; knows where data begin, not what is in them. A list that breaks off is kept up to there,
//! and that is reported. Every block is visited once, so that no ring of links is walked twice.

use std::collections::{HashMap, HashSet};

use super::block::{Block, BlockFile, Fault, IDENTIFICATION, Kind};
use super::channel::{BytesLayout, Channel, ChannelGroup, Layout};
use super::conversion::Conversions;
use super::error::{Damage, Mdf4Problem, Mdf4Repair, Repairs};
use super::identification::Unfinished;
use super::text::Texts;

const HEADER: Kind = Kind { name: "header", id: b"##HD", links: 6, data: 8, most: 64 };
const DATA_GROUP: Kind = Kind { name: "data group", id: b"##DG", links: 4, data: 1, most: 64 };
const CHANNEL_GROUP: Kind = Kind { name: "channel group", id: b"##CG", links: 6, data: 32, most: 64 };
const SOURCE: Kind = Kind { name: "source", id: b"##SI", links: 3, data: 0, most: 64 };

/// Channel groups of a file.
pub(super) const MOST_GROUPS: usize = 1 << 16;

pub(super) const MOST_CHANNELS: usize = 1 << 17;

/// Channels whose samples have a length of their own lie in groups of their own, which are not shown.
const VARIABLE_LENGTH: u16 = 1;

/// The time is in another group (MDF 4.2).
const REMOTE_MASTER: u16 = 1 << 3;

#[derive(Debug, Default)]
pub(super) struct Structure {
    pub(super) groups: Vec<ChannelGroup>,
    pub(super) layouts: Vec<GroupLayout>,
    pub(super) data: Vec<DataGroup>,
    /// Places of all blocks that were read, rising: data of unknown length end before the next.
    pub(super) places: Vec<u64>,
    /// Start of the measurement in ns since 1970 (UTC or local time, as the file says).
    pub(super) start_ns: u64,
    /// Data group and record id of samples of varying length among other records, by the place of their group.
    pub(super) varying: HashMap<u64, (usize, u64)>,
    /// Place of the first attachment; 0 for none.
    pub(super) attachments: u64,
}

/// Data that one or several channel groups share.
#[derive(Debug, Default)]
pub(super) struct DataGroup {
    /// Where the data are; 0 for nowhere.
    pub(super) data: u64,
    pub(super) id_bytes: usize,
    pub(super) records: Vec<Record>,
    /// Bytes of data that have no blocks around them (MDF 3).
    pub(super) plain: Option<u64>,
}

/// One kind of record of a data group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Record {
    pub(super) id: u64,
    /// Bytes behind the id; `None` if each record says so itself.
    pub(super) bytes: Option<u64>,
}

/// How the samples of a group lie in the data.
#[derive(Debug)]
pub(super) struct GroupLayout {
    pub(super) data_group: usize,
    pub(super) record_id: u64,
    pub(super) value_bytes: u32,
    /// Bytes of invalidation bits behind them.
    pub(super) invalid_bytes: u32,
    /// One per channel; `None` for those that are no numbers.
    pub(super) channels: Vec<Option<Layout>>,
    /// One per channel; `None` for those that are no whole bytes.
    pub(super) bytes: Vec<Option<BytesLayout>>,
    /// Index of the time channel.
    pub(super) time: Option<usize>,
    /// Place of the group whose time this one has.
    remote_master: u64,
    pub(super) master: Option<usize>,
    /// Its own place.
    place: u64,
}

impl GroupLayout {
    /// Of a group without channels, all of whose values are valid; `rest` are bytes behind the values.
    pub(super) fn plain(data_group: usize, record_id: u64, value_bytes: u32, rest: u32) -> Self {
        Self {
            data_group,
            record_id,
            value_bytes,
            invalid_bytes: rest,
            channels: Vec::new(),
            bytes: Vec::new(),
            time: None,
            remote_master: 0,
            master: None,
            place: 0,
        }
    }
}

pub(super) fn read(
    file: &mut BlockFile,
    unfinished: Unfinished,
    repairs: &mut Repairs,
) -> Result<Structure, Mdf4Problem> {
    let header = file.block(&HEADER, IDENTIFICATION).map_err(Fault::into_problem)?;
    let mut walk = Walk {
        file,
        repairs,
        unfinished,
        visited: HashSet::from([IDENTIFICATION]),
        texts: Texts::default(),
        conversions: Conversions::default(),
        channels: 0,
        kinds_of_records: 0,
        structure: Structure { start_ns: header.u64(0), attachments: header.link(3), ..Structure::default() },
        cut: None,
    };
    walk.data_groups(header.link(0))?;
    let Walk { mut structure, visited, cut, .. } = walk;
    if structure.groups.is_empty() {
        return Err(Mdf4Problem::NoGroup(cut));
    }
    structure.places = visited.into_iter().collect();
    structure.places.extend(structure.data.iter().map(|group| group.data));
    structure.places.sort_unstable();
    find_masters(&mut structure);
    Ok(structure)
}

pub(super) struct Walk<'a> {
    pub(super) file: &'a mut BlockFile,
    pub(super) repairs: &'a mut Repairs,
    unfinished: Unfinished,
    visited: HashSet<u64>,
    pub(super) texts: Texts,
    pub(super) conversions: Conversions,
    pub(super) channels: usize,
    /// Channel groups so far, those of variable length as well.
    kinds_of_records: usize,
    structure: Structure,
    /// The first break of a list.
    cut: Option<Damage>,
}

impl Walk<'_> {
    /// The next block of a list; `None`, and a repair, where the list breaks off.
    pub(super) fn next_in_list(
        &mut self,
        kind: &Kind,
        at: u64,
        read: usize,
        list: impl FnOnce() -> String,
    ) -> Result<Option<Block>, Mdf4Problem> {
        let found = if self.visited.insert(at) {
            self.file.block(kind, at)
        } else {
            Err(Fault::Damaged(Damage::new(kind.name, at, "a link back to a block that was read before")))
        };
        match found {
            Ok(block) => Ok(Some(block)),
            Err(fault) => {
                let damage = fault.damage()?;
                self.cut.get_or_insert_with(|| damage.clone());
                self.repairs.push(Mdf4Repair::ListCut { list: list(), read, damage });
                Ok(None)
            }
        }
    }

    fn data_groups(&mut self, first: u64) -> Result<(), Mdf4Problem> {
        let (mut at, mut read) = (first, 0);
        while at != 0 {
            let Some(block) = self.next_in_list(&DATA_GROUP, at, read, || "data groups".to_owned())? else {
                break;
            };
            if read == MOST_GROUPS {
                return Err(too_many("data groups", MOST_GROUPS));
            }
            let data = DataGroup {
                data: block.link(2),
                id_bytes: usize::from(block.u8(0)).min(8),
                records: Vec::new(),
                plain: None,
            };
            self.structure.data.push(data);
            self.channel_groups(block.link(1), read)?;
            (at, read) = (block.link(0), read + 1);
        }
        Ok(())
    }

    fn channel_groups(&mut self, first: u64, data_group: usize) -> Result<(), Mdf4Problem> {
        let (mut at, mut read) = (first, 0);
        while at != 0 {
            let list = || format!("channel groups of data group {}", data_group + 1);
            let Some(block) = self.next_in_list(&CHANNEL_GROUP, at, read, list)? else { break };
            if self.kinds_of_records == MOST_GROUPS {
                return Err(too_many("channel groups", MOST_GROUPS));
            }
            self.kinds_of_records += 1;
            self.channel_group(&block, at, data_group)?;
            (at, read) = (block.link(0), read + 1);
        }
        Ok(())
    }

    fn channel_group(&mut self, block: &Block, place: u64, data_group: usize) -> Result<(), Mdf4Problem> {
        let (record_id, flags) = (block.u64(0), block.u16(16));
        let (value_bytes, invalid_bytes) = (block.u32(24), block.u32(28));
        let variable = flags & VARIABLE_LENGTH != 0;
        let bytes = (!variable).then(|| u64::from(value_bytes) + u64::from(invalid_bytes));
        if let Some(data) = self.structure.data.get_mut(data_group) {
            data.records.push(Record { id: record_id, bytes });
        }
        if variable {
            self.structure.varying.insert(place, (data_group, record_id));
            return Ok(());
        }
        let name = self.group_name(block)?;
        let (channels, (layouts, bytes)): (Vec<Channel>, (Vec<_>, Vec<_>)) =
            self.channel_list(block.link(1), &name, value_bytes, invalid_bytes)?.into_iter().unzip();
        self.structure.groups.push(ChannelGroup {
            name,
            samples: (!self.unfinished.counts).then_some(block.u64(8)),
            has_time: false,
            channels: Vec::new(),
        });
        let time = (0..channels.len()).find(|i| channels[*i].is_time && layouts[*i].is_some());
        self.structure.layouts.push(GroupLayout {
            data_group,
            record_id,
            value_bytes,
            invalid_bytes,
            channels: layouts,
            bytes,
            time,
            remote_master: if flags & REMOTE_MASTER != 0 { block.link(6) } else { 0 },
            master: None,
            place,
        });
        if let Some(group) = self.structure.groups.last_mut() {
            group.channels = channels;
        }
        Ok(())
    }

    fn group_name(&mut self, block: &Block) -> Result<String, Mdf4Problem> {
        let mut name = self.text(block.link(2))?;
        if name.is_empty() {
            name = self.text(block.link(5))?;
        }
        let source = block.link(3);
        if name.is_empty() && source != 0 {
            // Who measured is only a name here: one that is lost is none.
            match self.file.block(&SOURCE, source) {
                Ok(source) => name = self.text(source.link(0))?,
                Err(fault) => drop(fault.damage()?),
            }
        }
        if name.is_empty() {
            name = format!("group {}", self.structure.groups.len() + 1);
        }
        Ok(name)
    }

    pub(super) fn text(&mut self, at: u64) -> Result<String, Mdf4Problem> {
        self.texts.read(self.file, at, self.repairs)
    }
}

pub(super) fn too_many(what: &'static str, most: usize) -> Mdf4Problem {
    Mdf4Problem::TooMany { what, most }
}

/// Says of every group whether it has a time, its own or another's.
fn find_masters(structure: &mut Structure) {
    let with_time = structure.layouts.iter().enumerate().filter(|(_, layout)| layout.time.is_some());
    let clocks: HashMap<u64, usize> = with_time.map(|(i, layout)| (layout.place, i)).collect();
    for (group, layout) in structure.groups.iter_mut().zip(&mut structure.layouts) {
        if layout.time.is_none() {
            layout.master = clocks.get(&layout.remote_master).copied();
        }
        group.has_time = layout.time.is_some() || layout.master.is_some();
    }
}
