//! One message while it is put together: its signals one by one, then who selects whom and what overlaps.
//!
//! Called by the builder. What comes out of [`Draft::finish`] can be decoded without further questions.

use std::collections::{HashMap, HashSet};

use super::bits::{ByteOrder, Layout};
use super::message::{Kind, Message, Selector, Signal};
use super::missing::Missing;
use super::problem::{Fault, Problems};
use super::statement::{Multiplexing, RawSignal};
use crate::CanId;

/// More than any message has.
const MOST_SIGNALS: usize = 2048;
/// Pairs of signals of a file that are looked at for overlaps; the largest in use need some hundred thousand. Keeps a file
/// made for it from taking minutes.
pub(super) const MOST_COMPARISONS: usize = 20_000_000;
const NAMED_OVERLAPS: usize = 20;

/// A message whose signals do not know each other yet.
#[derive(Debug)]
pub(super) struct Draft {
    pub(super) message: Message,
    /// By name: place among the signals.
    pub(super) signals: HashMap<String, usize>,
    /// Further layouts of a name, which other values of a multiplexer select: by the place of the first, in the order of the file.
    layouts: HashMap<usize, Vec<usize>>,
    multiplexing: Vec<Multiplexing>,
    /// By place: who selects it and by which values (`SG_MUL_VAL_`).
    pub(super) extended: HashMap<usize, (String, Vec<(u64, u64)>)>,
    pub(super) frame_format: Option<String>,
    pub(super) cycle_ms: Option<String>,
    /// Names that editors shorten to 32 letters where they define, in full: the message's, and by place its signals'.
    pub(super) long_name: Option<String>,
    pub(super) long_names: HashMap<usize, String>,
    full: bool,
}

impl Draft {
    pub(super) fn new(line: u64, id: CanId, name: String, bytes: usize, sender: String) -> Self {
        let message = Message {
            id,
            name,
            sender,
            comment: String::new(),
            length: bytes,
            fd: bytes > 8,
            j1939: false,
            cycle_s: None,
            signals: Vec::new(),
            line,
            order: Vec::new(),
        };
        Self {
            message,
            signals: HashMap::new(),
            layouts: HashMap::new(),
            multiplexing: Vec::new(),
            extended: HashMap::new(),
            frame_format: None,
            cycle_ms: None,
            long_name: None,
            long_names: HashMap::new(),
            full: false,
        }
    }

    /// Adds a signal, if there is a place for it in the message.
    pub(super) fn add(&mut self, line: u64, raw: RawSignal) -> Result<(), Fault> {
        let (message, signal) = (self.message.name.clone(), raw.name.clone());
        if self.full {
            return Ok(());
        }
        let first = self.signals.get(&signal).copied();
        if let Some(first) = first
            && !self.is_another_layout(first, raw.multiplexing)
        {
            let first_line = self.message.signals.get(first).map_or(0, |first| first.line);
            return Err(Fault::SignalTwice { message, signal, first_line });
        }
        if self.message.signals.len() == MOST_SIGNALS {
            self.full = true;
            return Err(Fault::TooMany { message, most: MOST_SIGNALS });
        }
        if !(1..=64).contains(&raw.bits) {
            return Err(Fault::Length { message, signal, bits: raw.bits });
        }
        if raw.factor == 0.0 {
            return Err(Fault::Factor { message, signal });
        }
        let order = if raw.little_endian { ByteOrder::LittleEndian } else { ByteOrder::BigEndian };
        let bytes = self.message.length;
        let Some(layout) = Layout::new(order, raw.start, raw.bits, bytes) else {
            return Err(Fault::Outside { message, signal, start: raw.start, bits: raw.bits, bytes });
        };
        match first {
            None => drop(self.signals.insert(signal, self.message.signals.len())),
            Some(first) => self.layouts.entry(first).or_default().push(self.message.signals.len()),
        }
        self.multiplexing.push(raw.multiplexing);
        self.message.signals.push(Signal {
            name: raw.name,
            unit: raw.unit,
            comment: String::new(),
            layout,
            kind: if raw.signed { Kind::Signed } else { Kind::Unsigned },
            factor: raw.factor,
            offset: raw.offset,
            min: raw.min,
            max: raw.max,
            receivers: raw.receivers,
            labels: Vec::new(),
            selector: None,
            line,
            missing: Missing::default(),
            is_another_layout: false,
        });
        Ok(())
    }

    /// The places of a signal of which the first is this, one for each of its layouts.
    pub(super) fn of_the_name(&self, first: usize) -> Vec<usize> {
        let others = self.layouts.get(&first).into_iter().flatten().copied();
        [first].into_iter().chain(others).collect()
    }

    /// Whether a signal of a name that is there is the same at another place, under another value of the multiplexer.
    fn is_another_layout(&self, first: usize, multiplexing: Multiplexing) -> bool {
        let other = |place: &usize| match (self.multiplexing[*place].selected_by, multiplexing.selected_by) {
            (Some(one), Some(other)) => one != other,
            _ => false,
        };
        self.of_the_name(first).iter().all(other)
    }

    /// The message with the signals that make sense. `comparisons`: how many pairs of signals may still be held against
    /// each other, in this message and all others.
    pub(super) fn finish(mut self, comparisons: &mut usize, problems: &mut Problems) -> Message {
        self.lengthen();
        let mut kept = vec![true; self.message.signals.len()];
        for (place, kept) in kept.iter_mut().enumerate() {
            let fault = self.float_fault(place).or_else(|| self.select(place).err());
            if let Some(fault) = fault {
                *kept = false;
                problems.add(self.message.signals[place].line, fault);
            }
        }
        let order = self.drop_orphans(&mut kept, problems);
        let mut message = compacted(self.message, &kept);
        let new_place = new_places(&kept);
        message.order = order.into_iter().filter_map(|place| new_place[place]).collect();
        let (id, j1939) = (message.id, message.j1939);
        let mut names = HashSet::new();
        for signal in &mut message.signals {
            signal.missing = Missing::of(signal, id, j1939);
            signal.is_another_layout = !names.insert((signal.name.clone(), signal.unit.clone()));
        }
        overlaps(&message, comparisons, problems);
        message
    }

    /// From here on message and signals have their full names, by which nothing in the file calls them.
    fn lengthen(&mut self) {
        let full = |name: Option<String>| name.filter(|name| !name.trim().is_empty());
        if let Some(name) = full(self.long_name.take()) {
            self.message.name = name;
        }
        for (place, name) in std::mem::take(&mut self.long_names) {
            if let (Some(signal), Some(name)) = (self.message.signals.get_mut(place), full(Some(name))) {
                signal.name = name;
            }
        }
    }

    fn float_fault(&self, place: usize) -> Option<Fault> {
        let signal = &self.message.signals[place];
        let expected = match signal.kind {
            Kind::Float32 => 32,
            Kind::Float64 => 64,
            Kind::Unsigned | Kind::Signed => return None,
        };
        let bits = signal.layout.bits();
        let fault = || Fault::FloatLength {
            message: self.message.name.clone(),
            signal: signal.name.clone(),
            bits,
            expected,
        };
        (bits != expected).then(fault)
    }

    /// Finds a signal's multiplexer: the one that `SG_MUL_VAL_` names, else the only one there is.
    fn select(&mut self, place: usize) -> Result<(), Fault> {
        let (message, signal) = (&self.message.name, &self.message.signals[place].name);
        let layouts = self.layouts.iter().find(|(_, others)| others.contains(&place));
        let first = layouts.map_or(place, |(first, _)| *first);
        let (switch, ranges) = match (self.extended.get(&first), self.multiplexing[place].selected_by) {
            (Some((name, ranges)), by) => {
                // The ranges of a name with several layouts are those of all of them together.
                let ranges = match by.filter(|_| self.layouts.contains_key(&first)) {
                    Some(value) => vec![(value, value)],
                    None => ranges.clone(),
                };
                let switch = self.signals.get(name).copied().filter(|switch| *switch != place);
                let missing = || Fault::NoSwitch {
                    message: message.clone(),
                    signal: signal.clone(),
                    switch: Some(name.clone()),
                };
                (switch.ok_or_else(missing)?, ranges)
            }
            (None, Some(value)) => {
                let plain = |m: &Multiplexing| m.switch && m.selected_by.is_none();
                let mut switches =
                    self.multiplexing.iter().enumerate().filter(|(_, m)| plain(m)).map(|(place, _)| place);
                let (message, signal) = (message.clone(), signal.clone());
                match (switches.next(), switches.count()) {
                    (Some(switch), 0) => (switch, vec![(value, value)]),
                    (Some(_), more) => return Err(Fault::WhichSwitch { message, signal, count: more + 1 }),
                    (None, _) => return Err(Fault::NoSwitch { message, signal, switch: None }),
                }
            }
            (None, None) => return Ok(()),
        };
        self.message.signals[place].selector = Some(Selector { switch, ranges });
        Ok(())
    }

    /// Signals in an order in which multiplexers come before what they select. What no order reaches is selected by
    /// itself in the end, or by a signal that was left out.
    fn drop_orphans(&self, kept: &mut [bool], problems: &mut Problems) -> Vec<usize> {
        let signals = &self.message.signals;
        let mut order = Vec::with_capacity(signals.len());
        let mut below = vec![Vec::new(); signals.len()];
        for (place, signal) in signals.iter().enumerate().filter(|(place, _)| kept[*place]) {
            match &signal.selector {
                None => order.push(place),
                Some(selector) => below[selector.switch].push(place),
            }
        }
        let mut next = 0;
        while let Some(place) = order.get(next).copied() {
            order.append(&mut below[place]);
            next += 1;
        }
        let mut reached = vec![false; signals.len()];
        order.iter().for_each(|place| reached[*place] = true);
        for (place, signal) in signals.iter().enumerate().filter(|(place, _)| !reached[*place]) {
            if std::mem::replace(&mut kept[place], false) {
                let (message, name) = (self.message.name.clone(), signal.name.clone());
                problems.add(signal.line, self.why_not_reached(place, message, name));
            }
        }
        order
    }

    fn why_not_reached(&self, place: usize, message: String, signal: String) -> Fault {
        let signals = &self.message.signals;
        let mut at = place;
        for _ in 0..signals.len() {
            match &signals[at].selector {
                Some(selector) => at = selector.switch,
                // It ends at a signal that was left out itself.
                None => return Fault::NoSwitch { message, signal, switch: Some(signals[at].name.clone()) },
            }
        }
        Fault::SwitchLoop { message, signal }
    }
}

/// For each signal its place among those that are kept.
fn new_places(kept: &[bool]) -> Vec<Option<usize>> {
    let mut next = 0;
    let place = |kept: &bool| {
        let place = kept.then_some(next);
        next += usize::from(*kept);
        place
    };
    kept.iter().map(place).collect()
}

/// Only the signals that are kept, their multiplexers by their new places.
fn compacted(mut message: Message, kept: &[bool]) -> Message {
    let new_place = new_places(kept);
    let mut place = 0..;
    message.signals.retain(|_| place.next().is_some_and(|place| kept[place]));
    for signal in &mut message.signals {
        if let Some(selector) = &mut signal.selector
            && let Some(place) = new_place[selector.switch]
        {
            selector.switch = place;
        }
    }
    message
}

/// Names signals that share bits although they can be there at the same time.
fn overlaps(message: &Message, comparisons: &mut usize, problems: &mut Problems) {
    let signals = &message.signals;
    let pairs = signals.len() * signals.len() / 2;
    if pairs > *comparisons {
        return problems.add(message.line, Fault::NotCompared { message: message.name.clone() });
    }
    *comparisons -= pairs;
    let mut named = 0;
    for (place, signal) in signals.iter().enumerate() {
        for (other_place, other) in signals.iter().enumerate().take(place) {
            if !signal.layout.overlaps(&other.layout) || !together(message, place, other_place) {
                continue;
            }
            let fault = Fault::Overlap {
                message: message.name.clone(),
                signal: signal.name.clone(),
                other: other.name.clone(),
                other_line: other.line,
            };
            problems.add(signal.line, fault);
            named += 1;
            if named == NAMED_OVERLAPS {
                return;
            }
        }
    }
}

/// Whether two signals can be in one frame: no multiplexer that both depend on keeps them apart.
fn together(message: &Message, a: usize, b: usize) -> bool {
    chain(message, a).all(|a| {
        chain(message, b)
            .filter(|b| b.switch == a.switch)
            .all(|b| a.ranges.iter().any(|(low, high)| b.ranges.iter().any(|(l, h)| low <= h && l <= high)))
    })
}

fn chain(message: &Message, place: usize) -> impl Iterator<Item = &Selector> {
    let before = |selector: &&Selector| message.signals.get(selector.switch)?.selector.as_ref();
    // There is no circle; the bound is for the reader of this line.
    std::iter::successors(message.signals.get(place).and_then(|signal| signal.selector.as_ref()), before)
        .take(message.signals.len())
}
