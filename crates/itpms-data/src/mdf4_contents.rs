//! Contents of an MDF file: channels that can be read, those that cannot with the reason, and groups that are
//! one recording in stretches.
//!
//! Called by the drive-log reader and by the list of signals, so that both know the same.

use crate::error::DataError;
use crate::mdf4::{Channel, ChannelGroup, ChannelKind, Mdf4Reader};
use crate::signals::{Candidate, Unread, element_name};

/// Channels of frames of a bus as ASAM's bus logging names them.
const FRAMES: [&str; 7] = [
    "CAN_DataFrame",
    "CAN_RemoteFrame",
    "CAN_ErrorFrame",
    "LIN_Frame",
    "FLX_Frame",
    "ETH_Frame",
    "MOST_Message",
];

/// Whether a channel can be a signal of a group with a clock.
pub(crate) fn is_signal(group: &ChannelGroup, channel: &Channel) -> bool {
    group.has_time && !channel.is_time && channel.kind == ChannelKind::Number
}

pub(crate) fn signal_name(group: &ChannelGroup, channel: &Channel) -> String {
    let array = channel.element.zip(channel.name.rsplit_once('['));
    array.map_or_else(
        || channel.name.clone(),
        |((number, of), (array, _))| {
            element_name(&group.name, array, &channel.unit, number as usize, of as usize)
        },
    )
}

/// Whether a file holds frames of a CAN bus that are read as such: it has nothing else, or their description is given.
#[cfg(feature = "can")]
pub(crate) fn is_bus_log(path: &std::path::Path, described: bool) -> Result<bool, DataError> {
    let reader = Mdf4Reader::open(path)?;
    let is_frame = |channel: &Channel| FRAMES.contains(&channel.name.as_str());
    let others = || {
        let groups = reader.groups().iter().filter(|group| group.samples != Some(0));
        groups
            .filter(|group| !group.channels.iter().any(is_frame))
            .any(|group| group.channels.iter().any(|channel| is_signal(group, channel)))
    };
    Ok(crate::mdf4::bus::has_frames(&reader) && (described || !others()))
}

/// Other contents, and why they are not read; frames of a bus first.
pub(crate) fn unread(reader: &Mdf4Reader) -> Vec<Unread> {
    let of_group = |group: &ChannelGroup, name: String, why: String| Unread {
        candidate: Candidate { group: group.name.clone(), name, unit: String::new() },
        why,
    };
    let (mut frames, mut others) = (Vec::new(), Vec::new());
    for group in reader.groups() {
        if let Some(bus) =
            FRAMES.iter().find(|bus| group.channels.iter().any(|channel| channel.name == **bus))
        {
            let why = match bus.starts_with("CAN_") {
                true => "frames of a bus, not signals: give the DBC file that says what they mean (--dbc)",
                false => "frames of another bus than CAN, which are not read",
            };
            if group.samples != Some(0) {
                frames.push(of_group(group, (*bus).to_owned(), why.to_owned()));
            }
            continue;
        }
        for channel in group.channels.iter().filter(|channel| !channel.is_time && !is_signal(group, channel))
        {
            let why = match &channel.kind {
                ChannelKind::Number => "in a group whose clock is missing or cannot be read".to_owned(),
                other => other.describe().to_owned(),
            };
            others.push(of_group(group, channel.name.clone(), why));
        }
    }
    frames.append(&mut others);
    frames
}

/// For each group the first one of the same recording: of the same name (or none), with the same channels, at other times.
pub(crate) fn stacks(reader: &Mdf4Reader) -> Result<Vec<usize>, DataError> {
    let groups = reader.groups();
    let alike = |a: usize, b: usize| {
        let [a, b] = [&groups[a], &groups[b]];
        let same_name = a.name == b.name || (is_unnamed(a) && is_unnamed(b));
        let key = |channel: &Channel| (channel.name.clone(), channel.unit.clone(), channel.kind.clone());
        a.has_time && b.has_time && same_name && a.channels.iter().map(key).eq(b.channels.iter().map(key))
    };
    let mut firsts: Vec<usize> = (0..groups.len()).collect();
    let mut spans = vec![None; groups.len()];
    for later in 0..groups.len() {
        let Some(first) = (0..later).find(|first| firsts[*first] == *first && alike(*first, later)) else {
            continue;
        };
        // Only where there may be one are the stamps read beforehand.
        let members: Vec<usize> = (first..later).filter(|member| firsts[*member] == first).collect();
        for member in members.iter().chain([&later]) {
            if spans[*member].is_none() {
                spans[*member] = Some(span(reader, *member)?);
            }
        }
        let (began_s, ended_s) = spans[later].unwrap_or((f64::NAN, f64::NAN));
        let apart = |member: &usize| {
            spans[*member].is_some_and(|(from_s, to_s)| to_s < began_s || ended_s < from_s || from_s.is_nan())
        };
        if members.iter().all(apart) || began_s.is_nan() {
            firsts[later] = first;
        }
    }
    Ok(firsts)
}

/// Whether the recording of which a group is the first stretch has samples, as far as the file counts them.
pub(crate) fn has_samples(reader: &Mdf4Reader, firsts: &[usize], first: usize) -> bool {
    let stretches = reader.groups().iter().zip(firsts).filter(|(_, of)| **of == first);
    stretches.into_iter().any(|(group, _)| group.samples != Some(0))
}

/// The name that a group gets where it has none.
fn is_unnamed(group: &ChannelGroup) -> bool {
    group.name.strip_prefix("group ").is_some_and(|number| number.parse::<usize>().is_ok())
}

/// First and last time of a group in s; NaN where there is none.
fn span(reader: &Mdf4Reader, group: usize) -> Result<(f64, f64), DataError> {
    let mut cursor = reader.cursor(group, &[])?;
    let mut span = (f64::NAN, f64::NAN);
    while let Some(time_s) = cursor.next(&mut [])? {
        span = (time_s.min(span.0), time_s.max(span.1));
    }
    Ok(span)
}
