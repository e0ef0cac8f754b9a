//! The list of an MDF4 file: its channel groups, one after the other.

use std::path::Path;

use super::statistics::{Clock, Range};
use super::{FormatLister, ListedGroup, ListedSignal, Listing};
use crate::error::{DataError, Problem};
use crate::mdf4::{GroupCursor, Mdf4Reader};
use crate::mdf4_contents::{is_signal, signal_name, stacks, unread};
use crate::signals::Unread;

/// Values between two looks around.
const VALUES_PER_STEP: usize = 16_384;

#[derive(Debug)]
pub(super) struct Mdf4Lister {
    reader: Mdf4Reader,
    /// The groups that have been opened; the last one is being read.
    groups: Vec<Group>,
    cursor: Option<GroupCursor>,
    values: Vec<f64>,
    notes: Vec<String>,
    samples: u64,
    firsts: Vec<usize>,
    unread: Vec<Unread>,
}

#[derive(Debug)]
struct Group {
    place: usize,
    channels: Vec<usize>,
    clock: Clock,
    ranges: Vec<Range>,
}

impl Mdf4Lister {
    pub(super) fn open(path: &Path) -> Result<Self, DataError> {
        let reader = Mdf4Reader::open(path)?;
        let notes = reader.repairs().iter().map(ToString::to_string).collect();
        let (firsts, unread) = (stacks(&reader)?, unread(&reader));
        let (groups, values) = (Vec::new(), Vec::new());
        Ok(Self { reader, groups, cursor: None, values, notes, samples: 0, firsts, unread })
    }

    /// Opens the next group that has a time and numbers; false if there is none.
    fn open_next(&mut self) -> Result<bool, DataError> {
        let first = self.groups.last().map_or(0, |group| group.place + 1);
        for (place, group) in self.reader.groups().iter().enumerate().skip(first) {
            let numbers = group.channels.iter().enumerate();
            let channels: Vec<usize> =
                numbers.filter(|(_, channel)| is_signal(group, channel)).map(|(place, _)| place).collect();
            if channels.is_empty() {
                continue;
            }
            self.cursor = Some(self.reader.cursor(place, &channels)?);
            self.values = vec![f64::NAN; channels.len()];
            let ranges = vec![Range::default(); channels.len()];
            self.groups.push(Group { place, channels, clock: Clock::default(), ranges });
            return Ok(true);
        }
        Ok(false)
    }
}

impl FormatLister for Mdf4Lister {
    fn step(&mut self) -> Result<bool, Problem> {
        if self.cursor.is_none() && !self.open_next()? {
            return Ok(false);
        }
        let (Some(cursor), Some(group)) = (&mut self.cursor, self.groups.last_mut()) else {
            return Ok(false);
        };
        for _ in 0..=VALUES_PER_STEP / self.values.len().max(1) {
            let Some(time_s) = cursor.next(&mut self.values).map_err(DataError::from)? else {
                self.notes.extend(cursor.repairs().iter().map(ToString::to_string));
                self.cursor = None;
                return Ok(true);
            };
            group.clock.tick(time_s);
            group.ranges.iter_mut().zip(&self.values).for_each(|(range, value)| range.add(*value));
            self.samples += 1;
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        let in_group = self.cursor.as_ref().map_or(1.0, GroupCursor::progress);
        let before = self.groups.last().map_or(0, |group| group.place);
        (before as f64 + in_group) / self.reader.groups().len().max(1) as f64
    }

    fn finish(self: Box<Self>) -> Listing {
        let mut span_s: Option<(f64, f64)> = None;
        let (mut groups, mut listed) = (Vec::new(), Vec::new());
        for group in self.groups {
            let Some(of_file) = self.reader.groups().get(group.place) else { continue };
            let signals = group.channels.iter().zip(&group.ranges).filter_map(|(channel, range)| {
                let channel = of_file.channels.get(*channel)?;
                Some(ListedSignal::new(signal_name(of_file, channel), channel.unit.clone(), range))
            });
            let signals = signals.collect();
            let stretch_of = listed.iter().position(|listed| self.firsts[group.place] == *listed);
            listed.push(group.place);
            groups.push(ListedGroup {
                signals,
                stretch_of,
                ..ListedGroup::new(of_file.name.clone(), &group.clock)
            });
            if let Some((first, last)) = group.clock.span_s() {
                let (f, l) = span_s.unwrap_or((first, last));
                span_s = Some((f.min(first), l.max(last)));
            }
        }
        Listing {
            groups,
            kind: "group",
            span_s,
            samples: self.samples,
            clock: None,
            notes: self.notes,
            absent: Vec::new(),
            unread: self.unread,
        }
    }
}
