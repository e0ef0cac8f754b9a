//! Readings from an MDF4 file: its channel groups side by side, always the one whose next sample is the oldest.

use std::collections::VecDeque;
use std::path::Path;

use super::feed::Feed;
use super::slot::Slot;
use super::stamps::{Fate, Strays};
use crate::error::{DataError, Problem};
use crate::mdf4::{GroupCursor, Mdf4Reader};
use crate::mdf4_contents::{has_samples, is_signal, signal_name, stacks, unread};
use crate::signals::{Candidate, Conversion, Reading, Resolved, SignalMap, contested, resolve_among};

#[derive(Debug)]
pub(super) struct Mdf4Feed {
    groups: Vec<Group>,
    start_ns: u64,
    repairs: Vec<String>,
}

/// A channel group with signals that mean something to us.
#[derive(Debug)]
struct Group {
    cursor: GroupCursor,
    /// The meaning of each value, and its conversion to the column's unit.
    slots: Vec<(Slot, Conversion)>,
    values: Vec<f64>,
    /// The group's stamps are repaired before the groups are merged: one that is odd must not hold its group back.
    strays: Strays<Reading>,
    /// Readings that are next, in the order of the file.
    next: VecDeque<Reading>,
    is_over: bool,
}

impl Group {
    /// Reads a sample. What it says is next, waits until later samples confirm it, or is left out.
    fn advance(&mut self, take: &mut impl FnMut(Fate<Reading>)) -> Result<(), DataError> {
        let Self { cursor, slots, values, strays, next, is_over } = self;
        let mut sink = |fate| match fate {
            Fate::Kept(reading) => next.push_back(reading),
            left_out => take(left_out),
        };
        match cursor.next(values)? {
            None => {
                strays.finish(&mut sink);
                *is_over = true;
            }
            Some(time_s) if !time_s.is_finite() => {}
            Some(time_s) => {
                for ((slot, conversion), value) in slots.iter().zip(values.iter()) {
                    strays.take(Reading { time_s, slot: *slot, value: conversion.apply(*value) }, &mut sink);
                }
            }
        }
        Ok(())
    }

    fn next_s(&self) -> Option<f64> {
        self.next.front().map(|reading| reading.time_s)
    }
}

impl Mdf4Feed {
    /// Opens a file; also what its channels were taken for.
    pub(super) fn open(path: &Path, map: Option<&SignalMap>) -> Result<(Self, Resolved), DataError> {
        let reader = Mdf4Reader::open(path)?;
        let firsts = stacks(&reader)?;
        let (candidates, places) = candidates(&reader, &firsts);
        let mut has_samples: Vec<bool> =
            places.iter().map(|(group, _)| has_samples(&reader, &firsts, *group)).collect();
        for place in contested(&candidates, map) {
            has_samples[place] = has_samples[place] && has_value(&reader, &firsts, places[place])?;
        }
        let resolved = resolve_among(&candidates, &has_samples, &unread(&reader), map)?;
        let mut groups = Vec::new();
        for (index, first) in firsts.iter().enumerate() {
            let here = resolved.iter().filter(|chosen| places[chosen.candidate].0 == *first);
            let (channels, slots): (Vec<usize>, Vec<_>) =
                here.map(|chosen| (places[chosen.candidate].1, (chosen.slot, chosen.conversion))).unzip();
            if channels.is_empty() {
                continue;
            }
            let cursor = reader.cursor(index, &channels)?;
            groups.push(Group {
                cursor,
                values: vec![f64::NAN; slots.len()],
                slots,
                strays: Strays::new(),
                next: VecDeque::new(),
                is_over: false,
            });
        }
        let repairs = reader.repairs().iter().map(ToString::to_string).collect();
        Ok((Self { groups, start_ns: reader.start_ns(), repairs }, resolved))
    }
}

impl Feed for Mdf4Feed {
    fn step(&mut self, mut take: &mut dyn FnMut(Fate<Reading>)) -> Result<bool, Problem> {
        for group in self.groups.iter_mut().filter(|group| group.next.is_empty()) {
            while group.next.is_empty() && !group.is_over {
                group.advance(&mut take)?;
            }
        }
        let with_next =
            self.groups.iter_mut().filter_map(|group| group.next_s().map(|time_s| (time_s, group)));
        let Some((time_s, group)) = with_next.min_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(false) };
        while group.next_s() == Some(time_s) {
            group.next.pop_front().into_iter().for_each(|reading| take(Fate::Kept(reading)));
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        self.groups.iter().map(|group| group.cursor.progress()).fold(1.0, f64::min)
    }

    fn repairs(&self) -> Vec<String> {
        let of_groups = self.groups.iter().flat_map(|group| group.cursor.repairs());
        self.repairs.iter().cloned().chain(of_groups.map(ToString::to_string)).collect()
    }

    fn start_ns(&self) -> u64 {
        self.start_ns
    }
}

/// Whether a channel has a value anywhere. Asked of those alone between which there is a choice: the first sample mostly says so.
fn has_value(
    reader: &Mdf4Reader,
    firsts: &[usize],
    (first, channel): (usize, usize),
) -> Result<bool, DataError> {
    let mut value = [f64::NAN];
    for (group, _) in firsts.iter().enumerate().filter(|(_, of)| **of == first) {
        let mut cursor = reader.cursor(group, &[channel])?;
        while cursor.next(&mut value)?.is_some() {
            if value[0].is_finite() {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// The channels that hold numbers and have a time, and their places: group and channel. Stretches of one recording are there once.
fn candidates(reader: &Mdf4Reader, firsts: &[usize]) -> (Vec<Candidate>, Vec<(usize, usize)>) {
    let mut candidates = Vec::new();
    let mut places = Vec::new();
    for (group_index, group) in
        reader.groups().iter().enumerate().filter(|(index, _)| firsts[*index] == *index)
    {
        for (index, channel) in
            group.channels.iter().enumerate().filter(|(_, channel)| is_signal(group, channel))
        {
            let name = signal_name(group, channel);
            let (group, unit) = (group.name.clone(), channel.unit.clone());
            candidates.push(Candidate { group, name, unit });
            places.push((group_index, index));
        }
    }
    (candidates, places)
}
