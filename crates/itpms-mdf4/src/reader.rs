//! An MDF4 file open for reading: its groups, and cursors through their samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use itpms_files::{FileProblem, input};

use super::block::{BlockFile, FRAME, Fault};
use super::bytes::ByteColumn;
use super::channel::{BytesLayout, ChannelGroup, Layout};
use super::cursor::{GroupCursor, Parts};
use super::data::{Column, DataStream, has_invalidation_apart};
use super::error::{Damage, Mdf4Error, Mdf4Problem, Mdf4Repair, Repairs};
use super::identification::{self, Generation, Unfinished};
use super::records::{MOST_EMPTY, MOST_RECORD, Records, Shape};
use super::structure::{self, DataGroup, Structure};
use super::{attachment, clock_unit, mdf3};

/// An open MDF file (ASAM MDF 4.0 to 4.3, and 2 and 3).
///
/// Reads the tree of groups and channels at once, the samples through [`GroupCursor`]s.
#[derive(Debug)]
pub struct Mdf4Reader {
    path: PathBuf,
    structure: Structure,
    places: Arc<[u64]>,
    unfinished: Unfinished,
    repairs: Repairs,
}

impl Mdf4Reader {
    /// Opens a file and reads its tree.
    ///
    /// # Errors
    /// The file is not there, is not MDF 2 to 4.3, or there is not one channel group that can be read.
    pub fn open(path: &Path) -> Result<Self, Mdf4Error> {
        Self::read(path).map_err(|problem| Mdf4Error::new(path, problem))
    }

    fn read(path: &Path) -> Result<Self, Mdf4Problem> {
        let mut file = open(path)?;
        let (generation, unfinished) = identification::read(&mut file)?;
        let mut repairs = Repairs::default();
        if unfinished.anything {
            repairs.push(Mdf4Repair::Unfinalised { missing: unfinished.describe() });
        }
        let mut structure = match generation {
            Generation::Three => mdf3::read(&mut file, &mut repairs)?,
            Generation::Four => structure::read(&mut file, unfinished, &mut repairs)?,
        };
        forget_zero_counts(&mut file, &mut structure, &mut repairs)?;
        note_units_of_clocks(&structure, &mut repairs);
        let places = std::mem::take(&mut structure.places).into();
        Ok(Self { path: path.to_owned(), structure, places, unfinished, repairs })
    }

    /// The channel groups in the file's order.
    #[must_use]
    pub fn groups(&self) -> &[ChannelGroup] {
        &self.structure.groups
    }

    /// Repairs and omissions in the tree; those in the data are the cursors'.
    #[must_use]
    pub fn repairs(&self) -> &[Mdf4Repair] {
        self.repairs.list()
    }

    /// When time 0 was, in ns since 1970; UTC or local time, as the file says. 0 if it does not know.
    #[must_use]
    pub fn start_ns(&self) -> u64 {
        self.structure.start_ns
    }

    /// A way through the samples of `group`, from the first one on, for the channels with these indices. In memory it
    /// holds one data block: 256 kB of a plain one; of a compressed one its contents, once more while a transposed one
    /// is turned back (8 MB as writers are asked to write them, 128 MB at most).
    ///
    /// # Errors
    /// There is no such group or channel, the group has no time, a channel holds no numbers, or a record is longer than 4 MB.
    pub fn cursor(&self, group: usize, channels: &[usize]) -> Result<GroupCursor, Mdf4Error> {
        let fail = |problem| Mdf4Error::new(&self.path, problem);
        let parts = self.parts(group, channels).map_err(fail)?;
        let group = &self.structure.groups[group];
        Ok(GroupCursor::new(&self.path, &group.name, parts, group.samples))
    }

    /// The same with the bytes of one more channel, whose samples may lie apart.
    pub(super) fn cursor_with_bytes(
        &self,
        group: usize,
        channels: &[usize],
        bytes: usize,
    ) -> Result<GroupCursor, Mdf4Error> {
        let fail = |problem| Mdf4Error::new(&self.path, problem);
        let mut parts = self.parts(group, channels).map_err(fail)?;
        let layout = self.structure.layouts[group].bytes.get(bytes).copied().flatten();
        parts.bytes = layout.map(|layout| self.byte_column(layout)).transpose().map_err(fail)?;
        let group = &self.structure.groups[group];
        Ok(GroupCursor::new(&self.path, &group.name, parts, group.samples))
    }

    pub(super) fn has_records(&self, group: usize) -> bool {
        self.structure.layouts.get(group).is_some_and(|layout| layout.value_bytes > 0)
    }

    /// Contents and name of the first file inside this one whose name is `wanted`.
    ///
    /// # Errors
    /// The file cannot be read on, or that one is damaged or has more than `most` bytes.
    pub fn attachment(
        &self,
        wanted: impl Fn(&str) -> bool,
        most: u64,
    ) -> Result<Option<(String, Vec<u8>)>, Mdf4Error> {
        open(&self.path)
            .and_then(|mut file| attachment::find(&mut file, self.structure.attachments, wanted, most))
            .map_err(|problem| Mdf4Error::new(&self.path, problem))
    }

    fn byte_column(&self, layout: BytesLayout) -> Result<ByteColumn, Mdf4Problem> {
        let BytesLayout::Apart { data, .. } = layout else { return Ok(ByteColumn::new(layout, None)) };
        // Among the records of other groups, or by themselves.
        let (data, shape) = match self.structure.varying.get(&data) {
            Some((group, id)) => {
                let group = &self.structure.data[*group];
                (group.data, mixed(group, *id))
            }
            None => (data, Shape::Varying),
        };
        Ok(ByteColumn::new(layout, Some(Records::new(self.stream(data, Column::Values)?, shape, 0, None))))
    }

    fn stream(&self, data: u64, column: Column) -> Result<DataStream, Mdf4Problem> {
        let file = open(&self.path)?;
        Ok(DataStream::new(file, data, column, self.unfinished, Arc::clone(&self.places)))
    }

    fn parts(&self, index: usize, channels: &[usize]) -> Result<Parts, Mdf4Problem> {
        let (Some(group), Some(layout)) =
            (self.structure.groups.get(index), self.structure.layouts.get(index))
        else {
            return Err(Mdf4Problem::NoSuchGroup(index));
        };
        let columns =
            channels.iter().map(|channel| self.column(index, *channel)).collect::<Result<_, _>>()?;
        // The time is the group's own, or lies in the group it names.
        let clock = if layout.time.is_some() { Some(index) } else { layout.master };
        let clock = clock.map(|group| (group, &self.structure.layouts[group]));
        let time =
            clock.and_then(|(group, layout)| Some((group, layout, layout.channels.get(layout.time?)?)));
        let Some((clock, clock_layout, Some(time))) = time else {
            return Err(Mdf4Problem::NoTime(group.name.clone()));
        };
        let named = clock_layout.time.and_then(|time| self.structure.groups.get(clock)?.channels.get(time));
        let seconds_per_unit = named.and_then(|channel| clock_unit::seconds(&channel.unit)).unwrap_or(1.0);
        let data = self.structure.data.get(layout.data_group).map_or(0, |group| group.data);
        let in_blocks = self.structure.data.get(layout.data_group).is_some_and(|group| group.plain.is_none());
        let apart =
            in_blocks && layout.invalid_bytes > 0 && has_invalidation_apart(&mut open(&self.path)?, data)?;
        let (bytes, invalid_bytes) = (u64::from(layout.value_bytes), u64::from(layout.invalid_bytes));
        let (length, invalid) = if apart {
            (bytes, Some(self.records(index, Column::Invalidation, invalid_bytes)?))
        } else {
            (bytes + invalid_bytes, None)
        };
        let master = if clock == index {
            None
        } else {
            let length = u64::from(clock_layout.value_bytes) + u64::from(clock_layout.invalid_bytes);
            Some(self.records(clock, Column::Values, length)?)
        };
        Ok(Parts {
            values: self.records(index, Column::Values, length)?,
            invalid,
            master,
            time: time.clone(),
            seconds_per_unit,
            time_value_bytes: clock_layout.value_bytes as usize,
            columns,
            bytes: None,
            value_bytes: layout.value_bytes as usize,
        })
    }

    fn column(&self, group: usize, channel: usize) -> Result<Layout, Mdf4Problem> {
        let (group, layouts) = (&self.structure.groups[group], &self.structure.layouts[group].channels);
        match (group.channels.get(channel), layouts.get(channel)) {
            (Some(_), Some(Some(layout))) => Ok(layout.clone()),
            (Some(found), _) => Err(Mdf4Problem::NotNumeric {
                group: group.name.clone(),
                channel: found.name.clone(),
                found: found.kind.describe().to_owned(),
            }),
            (None, _) => Err(Mdf4Problem::NoSuchChannel { group: group.name.clone(), channel }),
        }
    }

    /// The records of a group, of `length` bytes each.
    fn records(&self, index: usize, column: Column, length: u64) -> Result<Records, Mdf4Problem> {
        let (group, layout) = (&self.structure.groups[index], &self.structure.layouts[index]);
        let data = &self.structure.data[layout.data_group];
        if length > MOST_RECORD {
            let (group, most) = (group.name.clone(), MOST_RECORD);
            return Err(Mdf4Problem::RecordLength { group, found: length, most });
        }
        let limit = group.samples;
        if length == 0 && limit.is_none_or(|found| found > MOST_EMPTY) {
            let (group, found) = (group.name.clone(), limit.unwrap_or(u64::MAX));
            return Err(Mdf4Problem::EmptyRecords { group, found, most: MOST_EMPTY });
        }
        let shape = if data.id_bytes > 0 {
            mixed(data, layout.record_id)
        } else if data.records.len() > 1 {
            let found = "several kinds of records without record ids";
            return Err(Mdf4Problem::Unreadable(Damage::new("data group", data.data, found)));
        } else {
            Shape::Sorted
        };
        let stream = match data.plain {
            Some(bytes) => DataStream::without_blocks(open(&self.path)?, data.data, bytes),
            None => self.stream(data.data, column)?,
        };
        Ok(Records::new(stream, shape, length as usize, limit))
    }
}

/// Records of one kind among all that occur in a data group.
fn mixed(data: &DataGroup, own: u64) -> Shape {
    let mut known = data.records.clone();
    known.sort_by_key(|record| record.id);
    let varies = known.iter().any(|record| record.id == own && record.bytes.is_none());
    Shape::Mixed { id_bytes: data.id_bytes, own, varies, known }
}

fn open(path: &Path) -> Result<BlockFile, Mdf4Problem> {
    Ok(BlockFile::new(input::open_regular(path, "MDF4")?.0).map_err(FileProblem::Read)?)
}

/// Programs that were killed leave data behind whose samples were not counted, not always with a word of it in the
/// identification: a group of no samples that has data is read to its end.
fn forget_zero_counts(
    file: &mut BlockFile,
    structure: &mut Structure,
    repairs: &mut Repairs,
) -> Result<(), Mdf4Problem> {
    let mut groups_of = vec![Vec::new(); structure.data.len()];
    for (group, layout) in structure.layouts.iter().enumerate() {
        groups_of[layout.data_group].push(group);
    }
    for (data, groups) in structure.data.iter().zip(groups_of) {
        let counted = groups.iter().any(|group| structure.groups[*group].samples != Some(0));
        if counted || data.data == 0 || data.plain.is_some() || !has_data(file, data.data, &structure.places)?
        {
            continue;
        }
        for group in groups {
            let group = &mut structure.groups[group];
            group.samples = None;
            repairs.push(Mdf4Repair::CountZero { group: group.name.clone() });
        }
    }
    Ok(())
}

/// The standard has masters in s; those that say another unit are read in it.
fn note_units_of_clocks(structure: &Structure, repairs: &mut Repairs) {
    for (group, layout) in structure.groups.iter().zip(&structure.layouts) {
        let Some(clock) = layout.time.and_then(|time| group.channels.get(time)) else { continue };
        if clock_unit::seconds(&clock.unit).is_some_and(|seconds| seconds != 1.0) {
            repairs.push(Mdf4Repair::ClockUnit { group: group.name.clone(), unit: clock.unit.clone() });
        }
    }
}

/// Whether a data block has data; the last of a file may have them without a length.
fn has_data(file: &mut BlockFile, at: u64, places: &[u64]) -> Result<bool, Mdf4Problem> {
    match file.frame("data block", at) {
        Ok(frame) => {
            let last = places.last().is_none_or(|place| *place <= at);
            Ok(frame.length > FRAME || (last && at + FRAME < file.length()))
        }
        Err(Fault::Damaged(_)) => Ok(false),
        Err(Fault::System(error)) => Err(FileProblem::Read(error).into()),
    }
}
