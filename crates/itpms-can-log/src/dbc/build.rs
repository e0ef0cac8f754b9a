//! Statements to messages: what belongs together is put together, what cannot be is named and left out.
//!
//! Called by the reader of DBC files alone.

use std::collections::HashMap;

use super::draft::{Draft, MOST_COMPARISONS};
use super::message::{Kind, Message, Signal};
use super::problem::{Fault, Problems};
use super::statement::{RawSignal, Statement};
use crate::CanId;

/// Set in an identifier of 29 bits.
const EXTENDED: u64 = 1 << 31;

/// Vector's editors keep signals without a message under this identifier.
const NO_MESSAGE: u64 = 0xC000_0000;

/// Source address that databases of SAE J1939 have where any node may send.
const NULL_ADDRESS: u32 = 0xFE;

#[derive(Debug, Default)]
pub(super) struct Builder {
    messages: Vec<Draft>,
    /// By the identifier as written.
    places: HashMap<u64, usize>,
    current: Current,
    enumerations: HashMap<String, Vec<String>>,
    defaults: HashMap<String, String>,
    protocol: Option<String>,
    pub(super) problems: Problems,
}

/// To which message a signal belongs.
#[derive(Debug, Default)]
enum Current {
    /// No message yet.
    #[default]
    None,
    /// One that was left out, and its signals with it.
    LeftOut,
    Message(usize),
}

impl Builder {
    pub(super) fn add(&mut self, line: u64, statement: Statement) {
        match statement {
            Statement::Message { id, name, bytes, sender } => self.message(line, id, name, bytes, sender),
            Statement::Signal(signal) => self.signal(line, signal),
            Statement::Selector { id, signal, switch, ranges } => {
                if let Some((draft, place)) = self.find(line, "SG_MUL_VAL_", id, &signal) {
                    draft.extended.entry(place).or_insert((switch, Vec::new())).1.extend(ranges);
                }
            }
            Statement::ValueType { id, signal, kind } => self.value_type(line, id, &signal, kind),
            Statement::Labels { id, signal, labels } => {
                self.quietly(id, &signal, |signal| signal.labels.clone_from(&labels));
            }
            Statement::Comment { id, signal: Some(signal), text } => {
                self.quietly(id, &signal, |signal| signal.comment.clone_from(&text));
            }
            Statement::Comment { id, signal: None, text } => {
                if let Some(draft) = self.draft(id) {
                    draft.message.comment = text;
                }
            }
            Statement::Enumeration { name, values } => {
                self.enumerations.insert(name, values);
            }
            Statement::Default { name, value } => {
                self.defaults.insert(name, value);
            }
            Statement::Attribute { name, id, signal: None, value } => {
                if let Some(draft) = self.draft(id) {
                    match name.as_str() {
                        "VFrameFormat" => draft.frame_format = Some(value),
                        "GenMsgCycleTime" => draft.cycle_ms = Some(value),
                        "SystemMessageLongSymbol" => draft.long_name = Some(value),
                        _ => {}
                    }
                }
            }
            Statement::Attribute { name, id, signal: Some(signal), value } => {
                if name == "SystemSignalLongSymbol"
                    && let Some(draft) = self.draft(id)
                    && let Some(place) = draft.signals.get(&signal)
                {
                    for place in draft.of_the_name(*place) {
                        draft.long_names.insert(place, value.clone());
                    }
                }
            }
            Statement::OfTheBus { name, value } => {
                if name == "ProtocolType" {
                    self.protocol = Some(value);
                }
            }
        }
    }

    fn message(&mut self, line: u64, id: u64, name: String, bytes: u64, sender: String) {
        self.current = Current::LeftOut;
        if id == NO_MESSAGE {
            return;
        }
        let can_id = u32::try_from(id & !EXTENDED).ok().and_then(|number| {
            if id & EXTENDED == 0 { CanId::standard(number) } else { CanId::extended(number) }
        });
        let Some(can_id) = can_id else {
            return self.problems.add(line, Fault::Identifier { message: name, id });
        };
        if bytes > 64 {
            return self.problems.add(line, Fault::TooLong { message: name, bytes });
        }
        if let Some(draft) = self.places.get(&id).and_then(|place| self.messages.get(*place)) {
            let (first, first_line) = (draft.message.name.clone(), draft.message.line);
            return self.problems.add(line, Fault::MessageTwice { message: name, first, first_line });
        }
        self.places.insert(id, self.messages.len());
        self.current = Current::Message(self.messages.len());
        self.messages.push(Draft::new(line, can_id, name, bytes as usize, sender));
    }

    fn signal(&mut self, line: u64, raw: RawSignal) {
        let place = match self.current {
            Current::None => return self.problems.add(line, Fault::Homeless { signal: raw.name }),
            Current::LeftOut => return,
            Current::Message(place) => place,
        };
        let Some(draft) = self.messages.get_mut(place) else { return };
        if let Err(fault) = draft.add(line, raw) {
            self.problems.add(line, fault);
        }
    }

    fn value_type(&mut self, line: u64, id: u64, signal: &str, kind: u64) {
        let kind = match kind {
            1 => Kind::Float32,
            2 => Kind::Float64,
            _ => return,
        };
        if let Some((draft, place)) = self.find(line, "SIG_VALTYPE_", id, signal) {
            for place in draft.of_the_name(place) {
                draft.message.signals.get_mut(place).into_iter().for_each(|signal| signal.kind = kind);
            }
        }
    }

    fn draft(&mut self, id: u64) -> Option<&mut Draft> {
        self.places.get(&id).and_then(|place| self.messages.get_mut(*place))
    }

    /// A signal's optional properties, in every layout of its name.
    fn quietly(&mut self, id: u64, signal: &str, mut set: impl FnMut(&mut Signal)) {
        let Some(draft) = self.draft(id) else { return };
        let Some(place) = draft.signals.get(signal) else { return };
        for place in draft.of_the_name(*place) {
            draft.message.signals.get_mut(place).into_iter().for_each(&mut set);
        }
    }

    /// A signal that something is reported of which changes its value; if it is not there, that is named.
    fn find(
        &mut self,
        line: u64,
        statement: &'static str,
        id: u64,
        signal: &str,
    ) -> Option<(&mut Draft, usize)> {
        let place = self.places.get(&id).copied();
        let known = place
            .and_then(|place| self.messages.get(place))
            .and_then(|draft| draft.signals.get(signal).copied());
        match (place, known) {
            (Some(place), Some(signal)) => self.messages.get_mut(place).map(|draft| (draft, signal)),
            // Of a signal that was left out it has been reported why.
            (Some(_), None) => None,
            (None, _) => {
                let signal = signal.to_owned();
                self.problems.add(line, Fault::NobodyThere { statement, signal, id });
                None
            }
        }
    }

    /// The messages, checked, and what is wrong with them.
    pub(super) fn finish(mut self) -> (Vec<Message>, Problems) {
        let mut messages = Vec::with_capacity(self.messages.len());
        let mut comparisons = MOST_COMPARISONS;
        for mut draft in self.messages {
            let cycle = draft.cycle_ms.take().or_else(|| self.defaults.get("GenMsgCycleTime").cloned());
            let cycle_ms = cycle.and_then(|text| text.parse().ok());
            draft.message.cycle_s =
                cycle_ms.filter(|ms: &f64| *ms > 0.0 && ms.is_finite()).map(|ms| 1e-3 * ms);
            let format = draft.frame_format.take().or_else(|| self.defaults.get("VFrameFormat").cloned());
            let format = format.map(|format| frame_format(&format, self.enumerations.get("VFrameFormat")));
            draft.message.fd |= format == Some(FrameFormat::Fd);
            // A file without formats says it of the whole bus, or by identifiers with the null address, which sends no message.
            let from_null = draft.message.id.value() & 0xFF == NULL_ADDRESS;
            let on_j1939 =
                || from_null || self.protocol.as_deref().is_some_and(|protocol| protocol.contains("J1939"));
            draft.message.j1939 = draft.message.id.is_extended()
                && format.map_or_else(on_j1939, |format| format == FrameFormat::J1939);
            messages.push(draft.finish(&mut comparisons, &mut self.problems));
        }
        (messages, self.problems)
    }
}

/// The kinds of `VFrameFormat` that matter here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FrameFormat {
    Fd,
    J1939,
    Other,
}

/// A `VFrameFormat` by its name, or by its place among the names.
fn frame_format(format: &str, names: Option<&Vec<String>>) -> FrameFormat {
    let named = match format.parse::<usize>() {
        Ok(place) => match names.and_then(|names| names.get(place)) {
            Some(name) => name.as_str(),
            // Vector's own list; files leave it out or have it in full.
            None if matches!(place, 14 | 15) => return FrameFormat::Fd,
            None if place == 3 => return FrameFormat::J1939,
            None => "",
        },
        Err(_) => format,
    };
    if named.contains("FD") {
        FrameFormat::Fd
    } else if named.contains("J1939") {
        FrameFormat::J1939
    } else {
        FrameFormat::Other
    }
}
