//! An MDF4 file open for reading: its groups, and cursors through their samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::block::{BlockFile, FRAME, Fault};
use super::channel::{ChannelGroup, Layout};
use super::cursor::{GroupCursor, Parts};
use super::data::{Column, DataStream, has_invalidation_apart};
use super::error::{Damage, Mdf4Problem, Mdf4Repair, Repairs};
use super::identification::{self, Unfinished};
use super::records::{MOST_EMPTY, MOST_RECORD, Records, Shape};
use super::structure::{self, Structure};
use crate::error::{DataError, Problem};
use crate::input;
use crate::signals::column_unit;

/// An open MDF4 file (ASAM MDF 4.0 to 4.2).
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
    /// The file is not there, is not MDF 4.0 to 4.2, or there is not one channel group that can be read.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        Self::read(path).map_err(|problem| DataError::new(path, problem))
    }

    fn read(path: &Path) -> Result<Self, Problem> {
        let mut file = open(path)?;
        let unfinished = identification::read(&mut file)?;
        let mut repairs = Repairs::default();
        if unfinished.anything {
            repairs.push(Mdf4Repair::Unfinalised { missing: unfinished.describe() });
        }
        let mut structure = structure::read(&mut file, unfinished, &mut repairs)?;
        forget_zero_counts(&mut file, &mut structure, &mut repairs)?;
        say_units_of_clocks(&structure, &mut repairs);
        let places = std::mem::take(&mut structure.places).into();
        Ok(Self { path: path.to_owned(), structure, places, unfinished, repairs })
    }

    /// The channel groups in the file's order.
    #[must_use]
    pub fn groups(&self) -> &[ChannelGroup] {
        &self.structure.groups
    }

    /// What was mended or left out of the tree. What was of the data, the cursors say.
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
    /// There is no such group or channel, the group has no time, a channel holds no numbers, or a record is longer than
    /// 4 MB.
    pub fn cursor(&self, group: usize, channels: &[usize]) -> Result<GroupCursor, DataError> {
        let fail = |problem| DataError::new(&self.path, problem);
        let parts = self.parts(group, channels).map_err(fail)?;
        let group = &self.structure.groups[group];
        Ok(GroupCursor::new(&self.path, &group.name, parts, group.samples))
    }

    fn parts(&self, index: usize, channels: &[usize]) -> Result<Parts, Problem> {
        let fail = Problem::Mdf4;
        let (Some(group), Some(layout)) =
            (self.structure.groups.get(index), self.structure.layouts.get(index))
        else {
            return Err(fail(Mdf4Problem::NoSuchGroup(index)));
        };
        let columns =
            channels.iter().map(|channel| self.column(index, *channel)).collect::<Result<_, _>>()?;
        // The time is the group's own, or lies in the group it names.
        let clock = if layout.time.is_some() { Some(index) } else { layout.master };
        let clock = clock.map(|group| (group, &self.structure.layouts[group]));
        let time =
            clock.and_then(|(group, layout)| Some((group, layout, layout.channels.get(layout.time?)?)));
        let Some((clock, clock_layout, Some(time))) = time else {
            return Err(fail(Mdf4Problem::NoTime(group.name.clone())));
        };
        let named = clock_layout.time.and_then(|time| self.structure.groups.get(clock)?.channels.get(time));
        let seconds_per_unit = named.and_then(|channel| column_unit::seconds(&channel.unit)).unwrap_or(1.0);
        let data = self.structure.data.get(layout.data_group).map_or(0, |group| group.data);
        let apart = layout.invalid_bytes > 0 && has_invalidation_apart(&mut open(&self.path)?, data)?;
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
            value_bytes: layout.value_bytes as usize,
        })
    }

    fn column(&self, group: usize, channel: usize) -> Result<Layout, Problem> {
        let (group, layouts) = (&self.structure.groups[group], &self.structure.layouts[group].channels);
        match (group.channels.get(channel), layouts.get(channel)) {
            (Some(_), Some(Some(layout))) => Ok(layout.clone()),
            (Some(found), _) => Err(Problem::Mdf4(Mdf4Problem::NotNumeric {
                group: group.name.clone(),
                channel: found.name.clone(),
                found: found.kind.describe().to_owned(),
            })),
            (None, _) => {
                Err(Problem::Mdf4(Mdf4Problem::NoSuchChannel { group: group.name.clone(), channel }))
            }
        }
    }

    /// The records of a group, of `length` bytes each.
    fn records(&self, index: usize, column: Column, length: u64) -> Result<Records, Problem> {
        let fail = |problem| Err(Problem::Mdf4(problem));
        let (group, layout) = (&self.structure.groups[index], &self.structure.layouts[index]);
        let data = &self.structure.data[layout.data_group];
        if length > MOST_RECORD {
            let (group, most) = (group.name.clone(), MOST_RECORD);
            return fail(Mdf4Problem::RecordLength { group, found: length, most });
        }
        let limit = group.samples;
        if length == 0 && limit.is_none_or(|found| found > MOST_EMPTY) {
            let (group, found) = (group.name.clone(), limit.unwrap_or(u64::MAX));
            return fail(Mdf4Problem::EmptyRecords { group, found, most: MOST_EMPTY });
        }
        let shape = if data.id_bytes > 0 {
            let mut known = data.records.clone();
            known.sort_by_key(|record| record.id);
            Shape::Mixed { id_bytes: data.id_bytes, own: layout.record_id, known }
        } else if data.records.len() > 1 {
            let found = "several kinds of records without record ids";
            return fail(Mdf4Problem::Unreadable(Damage::new("data group", data.data, found)));
        } else {
            Shape::Sorted
        };
        let file = open(&self.path)?;
        let stream = DataStream::new(file, data.data, column, self.unfinished, Arc::clone(&self.places));
        Ok(Records::new(stream, shape, length as usize, limit))
    }
}

/// Opens a file for reading.
fn open(path: &Path) -> Result<BlockFile, Problem> {
    BlockFile::new(input::open_regular(path, "MDF4")?.0).map_err(Problem::Read)
}

/// Programs that were killed leave data behind whose samples nobody counted, not always with a word of it in the
/// identification: a group of no samples that has data is read to its end.
fn forget_zero_counts(
    file: &mut BlockFile,
    structure: &mut Structure,
    repairs: &mut Repairs,
) -> Result<(), Problem> {
    let mut groups_of = vec![Vec::new(); structure.data.len()];
    for (group, layout) in structure.layouts.iter().enumerate() {
        groups_of[layout.data_group].push(group);
    }
    for (data, groups) in structure.data.iter().zip(groups_of) {
        let counted = groups.iter().any(|group| structure.groups[*group].samples != Some(0));
        if counted || data.data == 0 || !has_data(file, data.data, &structure.places)? {
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
fn say_units_of_clocks(structure: &Structure, repairs: &mut Repairs) {
    for (group, layout) in structure.groups.iter().zip(&structure.layouts) {
        let Some(clock) = layout.time.and_then(|time| group.channels.get(time)) else { continue };
        if column_unit::seconds(&clock.unit).is_some_and(|seconds| seconds != 1.0) {
            repairs.push(Mdf4Repair::ClockUnit { group: group.name.clone(), unit: clock.unit.clone() });
        }
    }
}

/// Whether a data block has data; the last of a file may have them without a length.
fn has_data(file: &mut BlockFile, at: u64, places: &[u64]) -> Result<bool, Problem> {
    match file.frame("data block", at) {
        Ok(frame) => {
            let last = places.last().is_none_or(|place| *place <= at);
            Ok(frame.length > FRAME || (last && at + FRAME < file.length()))
        }
        Err(Fault::Damaged(_)) => Ok(false),
        Err(Fault::System(error)) => Err(Problem::Read(error)),
    }
}
