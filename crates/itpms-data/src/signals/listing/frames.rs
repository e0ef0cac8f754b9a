//! The list of a CAN log: its messages by identifier and bus, with the signals of those that a DBC file knows.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use super::statistics::{Clock, Range};
use super::{FormatLister, ListedGroup, ListedSignal, Listing};
use crate::can::{CanId, FrameKind, FrameReader};
use crate::dbc::{Dbc, Message};
use crate::error::{DataError, Problem};
use crate::log::attached;
use crate::signals::Candidate;

/// Frames between two looks around.
const FRAMES_PER_STEP: usize = 4096;
/// Identifiers that are distinguished; a bus has some hundred, noise read as a log has any number.
const MOST_IDS: usize = 8192;

#[derive(Debug)]
pub(super) struct FrameLister {
    reader: FrameReader,
    dbc: Option<Dbc>,
    messages: BTreeMap<(CanId, u16), Seen>,
    whole: Clock,
    latest_s: f64,
    without_data: u64,
    beyond: u64,
}

/// One identifier on one bus.
#[derive(Debug)]
struct Seen {
    clock: Clock,
    bytes: (usize, usize),
    ranges: Vec<Range>,
    short: u64,
}

impl FrameLister {
    pub(super) fn open(path: &Path, dbc: Option<&Path>) -> Result<Self, DataError> {
        let dbc = dbc.map_or_else(|| attached(path), |dbc| crate::dbc::described(dbc).map(Some))?;
        Ok(Self {
            reader: FrameReader::open(path)?,
            dbc,
            messages: BTreeMap::new(),
            whole: Clock::default(),
            latest_s: f64::NEG_INFINITY,
            without_data: 0,
            beyond: 0,
        })
    }
}

impl FormatLister for FrameLister {
    fn step(&mut self) -> Result<bool, Problem> {
        for _ in 0..FRAMES_PER_STEP {
            let Some(frame) = self.reader.next_frame().map_err(DataError::from)? else { return Ok(false) };
            self.whole.tick(frame.time_s);
            self.latest_s = self.latest_s.max(frame.time_s);
            if matches!(frame.kind, FrameKind::Remote | FrameKind::Error) {
                self.without_data += 1;
                continue;
            }
            let key = (frame.id, frame.bus);
            if self.messages.len() >= MOST_IDS && !self.messages.contains_key(&key) {
                self.beyond += 1;
                continue;
            }
            let message = self.dbc.as_ref().and_then(|dbc| dbc.message(frame.id));
            let seen = self.messages.entry(key).or_insert_with(|| Seen {
                clock: Clock::default(),
                bytes: (frame.length(), frame.length()),
                ranges: vec![Range::default(); message.map_or(0, |message| message.signals.len())],
                short: 0,
            });
            seen.add(frame.time_s, frame.data(), message);
        }
        Ok(true)
    }

    fn progress(&self) -> f64 {
        self.reader.progress()
    }

    fn finish(self: Box<Self>) -> Listing {
        let several = self.messages.keys().any(|(_, bus)| *bus != 0);
        let mut notes: Vec<String> = self
            .dbc
            .iter()
            .flat_map(|dbc| dbc.problems().iter().map(|problem| format!("DBC: {problem}")))
            .collect();
        notes.extend(self.reader.repairs().warnings());
        if self.without_data > 0 {
            notes.push(format!("{} remote and error frames", self.without_data));
        }
        if self.beyond > 0 {
            notes.push(format!("{} frames of more than {MOST_IDS} identifiers are not listed", self.beyond));
        }
        let mut groups = Vec::new();
        for ((id, bus), seen) in &self.messages {
            let message = self.dbc.as_ref().and_then(|dbc| dbc.message(*id));
            if let (Some(message), true) = (message, seen.short > 0) {
                let (name, short) = (&message.name, seen.short);
                notes.push(format!(
                    "{short} frames of {name} are shorter than its signals ({} bytes)",
                    message.length
                ));
            }
            groups.push(seen.listed(*id, several.then_some(*bus), message));
        }
        let absent = self.dbc.as_ref().map(|dbc| absent(dbc, &self.messages)).unwrap_or_default();
        let span_s = self.whole.span_s().map(|(first, _)| (first, self.latest_s));
        let (samples, unread) = (self.whole.samples(), Vec::new());
        Listing { groups, kind: "message", span_s, samples, clock: None, notes, absent, unread }
    }
}

impl Seen {
    fn add(&mut self, time_s: f64, data: &[u8], message: Option<&Message>) {
        self.clock.tick(time_s);
        self.bytes = (self.bytes.0.min(data.len()), self.bytes.1.max(data.len()));
        let Some(message) = message else { return };
        let mut short = false;
        for (place, (signal, range)) in message.signals.iter().zip(&mut self.ranges).enumerate() {
            match message.raw(place, data) {
                Some(raw) if signal.is_not_available(raw) => range.add(f64::NAN),
                Some(raw) => range.add(signal.physical(raw)),
                None => short |= signal.raw(data).is_none(),
            }
        }
        self.short += u64::from(short);
    }

    fn listed(&self, id: CanId, bus: Option<u16>, message: Option<&Message>) -> ListedGroup {
        let name = message.map_or(String::new(), |message| message.name.clone());
        let firsts =
            message.iter().flat_map(|message| message.first_layouts().map(move |first| (message, first)));
        let signals = firsts.map(|(message, first)| {
            let signal = &message.signals[first];
            let ranges = message.layouts_of(first).filter_map(|place| self.ranges.get(place));
            let range = ranges.fold(Range::default(), |all, range| all.and(range));
            ListedSignal::new(signal.name.clone(), signal.unit.clone(), &range)
        });
        ListedGroup {
            id: Some(id.to_string()),
            bus,
            is_known: message.is_some(),
            stated_hz: message.and_then(|message| message.cycle_s).map(|cycle_s| 1.0 / cycle_s),
            bytes: Some(self.bytes),
            signals: signals.collect(),
            ..ListedGroup::new(name, &self.clock)
        }
    }
}

/// Signals of messages that did not come.
fn absent(dbc: &Dbc, seen: &BTreeMap<(CanId, u16), Seen>) -> Vec<Candidate> {
    let messages = seen.keys().filter_map(|(id, _)| dbc.message(*id));
    let seen: HashSet<CanId> = messages.map(|message| message.id).collect();
    let came = |message: &Message| seen.contains(&message.id);
    let signals = dbc.messages().iter().filter(|message| !came(message)).flat_map(|message| {
        message.first_layouts().map(|place| &message.signals[place]).map(|signal| Candidate {
            group: message.name.clone(),
            name: signal.name.clone(),
            unit: signal.unit.clone(),
        })
    });
    signals.collect()
}
