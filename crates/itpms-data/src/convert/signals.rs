//! A CAN log to MDF4: every signal that its description knows, a channel group per message and bus.
//!
//! The log is read twice: first for what is in it, then for the values.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Converted, LOOK, Look, Request, counted};
use crate::can::{CanFrame, CanId, FrameKind, FrameReader};
use crate::dbc::{Dbc, Message};
use crate::error::DataError;
use crate::log::frame_description;
use crate::mdf4::{ChannelSpec, GroupSpec, Mdf4Writer, SampleFormat};

/// Clocks that count from 1970 are beyond this, in s: the ones of a log that counts from its own beginning are not.
const SINCE_1970_S: f64 = 1e8;

pub(super) fn convert(request: &Request<'_>, look: Look<'_>) -> Result<Option<Converted>, DataError> {
    let path = request.options.dbc.as_deref();
    let dbc = frame_description(request.input, path)?;
    let path = path.unwrap_or(request.input);
    let Some(content) = Content::of(request.input, &dbc, look)? else { return Ok(None) };
    if content.groups.is_empty() {
        return Err(DataError::new(request.input, "has no frame that the DBC file knows"));
    }
    let groups: Vec<Group<'_>> = content
        .groups
        .keys()
        .filter_map(|(bus, id)| dbc.message(*id).map(|message| Group::new(*bus, message)))
        .collect();
    let several = groups.iter().any(|group| group.bus != groups[0].bus);
    let specs: Vec<GroupSpec> = groups.iter().map(|group| group.spec(several)).collect();
    let mut writer = Mdf4Writer::create(request.output, &specs, request.packing.into())?;
    let start_s = if content.first_s > SINCE_1970_S { content.first_s } else { 0.0 };
    writer.set_start_ns((start_s * 1e9) as u64);
    // By the identifier in the log, which on SAE J1939 has another source address than the description's.
    let places: BTreeMap<(u16, CanId), usize> = content.groups.keys().copied().zip(0..).collect();

    let mut reader = FrameReader::open(request.input)?;
    let mut count = 0u64;
    let mut values = Vec::new();
    while let Some(frame) = reader.next_frame()? {
        if count.is_multiple_of(LOOK) && look(0.5 + 0.5 * reader.progress()).is_break() {
            return Ok(None);
        }
        count += 1;
        let Some(place) = places.get(&(frame.bus, frame.id)).filter(|_| has_data(&frame)) else { continue };
        let Group { message, columns, .. } = &groups[*place];
        values.clear();
        values.resize(message.first_layouts().count(), f64::NAN);
        message.decode(frame.data(), |signal, value| values[columns[signal]] = value);
        writer.write(*place, frame.time_s - start_s, &values)?;
    }
    let mut warnings = reader.repairs().warnings();
    warnings.extend(dbc.problems().iter().map(|problem| format!("{}: {problem}", path.display())));
    if content.unknown > 0 {
        warnings.push(format!(
            "{} of messages that the DBC file does not have: left out",
            counted(content.unknown, "frame")
        ));
    }
    let known: u64 = content.groups.values().sum();
    let content =
        format!("{} in {}", counted(known, "sample"), counted(groups.len() as u64, "channel group"));
    Ok(Some(Converted { file: writer.finish()?, content, warnings, remarks: Vec::new() }))
}

#[derive(Debug, Default)]
struct Content {
    /// Frames per bus and message of the description.
    groups: BTreeMap<(u16, CanId), u64>,
    first_s: f64,
    unknown: u64,
}

impl Content {
    fn of(path: &Path, dbc: &Dbc, look: Look<'_>) -> Result<Option<Self>, DataError> {
        let mut content = Self { first_s: f64::INFINITY, ..Self::default() };
        let mut reader = FrameReader::open(path)?;
        let mut count = 0u64;
        while let Some(frame) = reader.next_frame()? {
            if count.is_multiple_of(LOOK) && look(0.5 * reader.progress()).is_break() {
                return Ok(None);
            }
            count += 1;
            if !has_data(&frame) {
                continue;
            }
            content.first_s = content.first_s.min(frame.time_s);
            if dbc.message(frame.id).is_some() {
                *content.groups.entry((frame.bus, frame.id)).or_default() += 1;
            } else {
                content.unknown += 1;
            }
        }
        Ok(Some(content))
    }
}

fn has_data(frame: &CanFrame) -> bool {
    matches!(frame.kind, FrameKind::Data | FrameKind::Fd { .. })
}

struct Group<'a> {
    bus: u16,
    message: &'a Message,
    /// For each signal of the message its channel: all layouts of a signal are one.
    columns: Vec<usize>,
}

impl<'a> Group<'a> {
    fn new(bus: u16, message: &'a Message) -> Self {
        let mut columns = vec![0; message.signals.len()];
        for (column, first) in message.first_layouts().enumerate() {
            message.layouts_of(first).for_each(|place| columns[place] = column);
        }
        Self { bus, message, columns }
    }

    fn spec(&self, several: bool) -> GroupSpec {
        let signals = self.message.first_layouts().map(|place| &self.message.signals[place]);
        let channels = signals.map(|signal| ChannelSpec {
            name: signal.name.clone(),
            unit: signal.unit.clone(),
            comment: signal.comment.clone(),
            format: SampleFormat::Float64,
        });
        let bus = if several { format!(" (bus {})", self.bus) } else { String::new() };
        GroupSpec {
            name: format!("{}{bus}", self.message.name),
            comment: self.message.comment.clone(),
            channels: channels.collect(),
        }
    }
}
