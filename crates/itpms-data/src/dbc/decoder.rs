//! Frames to readings: the signals that are columns, in the columns' units.
//!
//! Called for every frame of a log or a bus, so nothing is allocated here once it is made. Does not know the readings are for.

use std::collections::HashMap;

use super::truck::{Beyond, How};
use super::{Dbc, DbcProblem, Message, NoValue, candidates, compound_of, of_candidate};
use crate::can::{CanFrame, CanId, FrameKind};
use crate::error::DataError;
use crate::log::Slot;
use crate::signals::{Conversion, Reading, Resolved, SignalMap, resolve_among};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameCounts {
    pub frames: u64,
    pub used: u64,
    /// Data frames of messages that the description has, without such a signal.
    pub other: u64,
    /// Data frames whose identifier the description does not have.
    pub unknown: u64,
    /// Used ones that ended before a column's signal.
    pub short: u64,
    /// Used messages that came on another bus than the first time; not decoded.
    pub other_bus: u64,
    /// Used parameter groups of SAE J1939 that came from another source address than the first time; not decoded.
    pub other_sender: u64,
    /// Frames of SAE J1939 with a wheel or a tire that no car of two axles with a tire on each side has; that one is left out.
    pub further_wheel: u64,
    pub without_data: u64,
    /// Values sent as not available (`SNA`, SAE J1939), handed on as NaN.
    pub not_available: u64,
    /// Values that are an end of the raw numbers beyond the stated range; see [`Decoder::raw_ends`].
    pub raw_ends: u64,
}

#[derive(Debug, Clone)]
pub struct Decoder {
    dbc: Dbc,
    resolved: Resolved,
    wanted: HashMap<CanId, Wanted>,
    counts: FrameCounts,
}

#[derive(Debug, Clone)]
struct Wanted {
    message: Message,
    signals: Vec<Carried>,
    beyond: Beyond,
    /// Where the message was seen first. The same identifier on another bus may be something else, or a gateway's copy; in either case it
    /// is no second sensor. The same goes for a parameter group of SAE J1939 from a second sender, unless the description names that one.
    first: Option<(u16, CanId)>,
}

/// A signal that is a column.
#[derive(Debug, Clone)]
struct Carried {
    place: usize,
    how: Option<How>,
    slot: Slot,
    conversion: Conversion,
    /// Values that were an end of the raw numbers, and the last of them.
    ends: (u64, u64),
}

impl Decoder {
    /// Decides which signals are columns: those of the map, and those whose names say so.
    /// Errors: the map does not fit the description; see [`resolve`](crate::signals::resolve).
    pub fn new(dbc: Dbc, map: Option<&SignalMap>) -> Result<Self, DataError> {
        Self::knowing(dbc, map, &[])
    }

    /// The same, knowing which of the [`candidates`] have samples.
    pub(crate) fn knowing(
        dbc: Dbc,
        map: Option<&SignalMap>,
        has_samples: &[bool],
    ) -> Result<Self, DataError> {
        let resolved = resolve_among(&candidates(&dbc), has_samples, &[], map)?;
        let mut wanted: HashMap<CanId, Wanted> = HashMap::new();
        for chosen in resolved.iter() {
            if let Some((message, place)) = of_candidate(&dbc, chosen.candidate) {
                let fresh = || Wanted {
                    message: message.clone(),
                    signals: Vec::new(),
                    beyond: Beyond::of(message),
                    first: None,
                };
                let how = compound_of(&dbc, chosen.candidate).map(|compound| compound.how);
                let entry = wanted.entry(message.id).or_insert_with(fresh);
                entry.signals.extend(message.layouts_of(place).map(|place| Carried {
                    place,
                    how,
                    slot: chosen.slot,
                    conversion: chosen.conversion,
                    ends: (0, 0),
                }));
            }
        }
        Ok(Self { dbc, resolved, wanted, counts: FrameCounts::default() })
    }

    /// The columns that can come, in the order of [`Slot::all`].
    pub fn slots(&self) -> Vec<Slot> {
        self.resolved.slots()
    }

    /// Which signal is which column, and what is doubtful about it.
    pub fn resolved(&self) -> &Resolved {
        &self.resolved
    }

    /// The description of the bus.
    pub fn dbc(&self) -> &Dbc {
        &self.dbc
    }

    /// Problems of the description; see [`Dbc::problems`].
    pub fn problems(&self) -> &[DbcProblem] {
        self.dbc.problems()
    }

    pub fn counts(&self) -> &FrameCounts {
        &self.counts
    }

    /// Which signals came as an end of their raw numbers beyond the stated range, in words; `None` if there are none.
    pub fn raw_ends(&self) -> Option<String> {
        let carried =
            self.wanted.values().flat_map(|wanted| wanted.signals.iter().map(move |of| (wanted, of)));
        let mut named: Vec<String> = carried
            .filter(|(_, carried)| carried.ends.0 > 0)
            .filter_map(|(wanted, carried)| {
                let signal = wanted.message.signals.get(carried.place)?;
                let (message, name, (count, raw)) = (&wanted.message.name, &signal.name, carried.ends);
                let (least, most) = (signal.min, signal.max);
                Some(format!("{message}.{name} {count} times (raw 0x{raw:X}, stated [{least}|{most}])"))
            })
            .collect();
        named.sort();
        let total = self.counts.raw_ends;
        (total > 0).then(|| {
            format!(
                "{total} values are an end of their raw numbers beyond the stated range and were taken as not available: {}",
                named.join(", ")
            )
        })
    }

    /// Hands every column's value in this frame to `found`, with the frame's time.
    pub fn decode(&mut self, frame: &CanFrame, found: &mut impl FnMut(Reading)) {
        self.counts.frames += 1;
        if matches!(frame.kind, FrameKind::Remote | FrameKind::Error) {
            self.counts.without_data += 1;
            return;
        }
        let id = if self.wanted.contains_key(&frame.id) {
            Some(frame.id)
        } else {
            self.dbc.message(frame.id).map(|message| message.id)
        };
        let Some(wanted) = id.and_then(|id| self.wanted.get_mut(&id)) else {
            *(if id.is_some() { &mut self.counts.other } else { &mut self.counts.unknown }) += 1;
            return;
        };
        let (bus, sender) = wanted.first.get_or_insert((frame.bus, frame.id));
        if *bus != frame.bus {
            self.counts.other_bus += 1;
            return;
        }
        if *sender != frame.id {
            if wanted.message.id != frame.id {
                self.counts.other_sender += 1;
                return;
            }
            *sender = frame.id;
        }
        self.counts.used += 1;
        let data = frame.data();
        let mut short = false;
        let mut further = wanted.beyond.has_speed(&wanted.message, data);
        let mut tire = None;
        for Carried { place, how, slot, conversion, ends } in &mut wanted.signals {
            let mut plus = 0.0;
            match how {
                None => {}
                Some(How::Plus(axle)) => {
                    let Some(axle_speed) = number(&wanted.message, *axle, data) else { continue };
                    plus = axle_speed;
                }
                Some(How::At(location, corner)) => {
                    let here = *tire.get_or_insert_with(|| {
                        let raw = wanted.message.raw(*location, data)?;
                        let is_known = !wanted.message.signals[*location].is_not_available(raw);
                        is_known.then(|| wanted.beyond.corner(raw).map_err(|()| further = true).ok()?)?
                    });
                    if here != Some(*corner) {
                        continue;
                    }
                }
                Some(How::OnAxle(location, axle)) => {
                    let raw = wanted.message.raw(*location, data).unwrap_or(u64::MAX);
                    further |= raw >> 4 > 1 && raw < 0xFB;
                    if raw != *axle << 4 {
                        continue;
                    }
                }
            }
            let Some(signal) = wanted.message.signals.get(*place) else { continue };
            let Some(raw) = wanted.message.raw(*place, data) else {
                short |= signal.raw(data).is_none();
                continue;
            };
            let value = match signal.no_value(raw) {
                None => conversion.apply(signal.physical(raw) + plus),
                Some(NoValue::Stated) => {
                    self.counts.not_available += 1;
                    f64::NAN
                }
                Some(NoValue::RawEnd) => {
                    self.counts.raw_ends += 1;
                    *ends = (ends.0 + 1, raw);
                    f64::NAN
                }
            };
            let slot = *slot;
            found(Reading { time_s: frame.time_s, slot, value });
        }
        self.counts.short += u64::from(short);
        self.counts.further_wheel += u64::from(further);
    }
}

/// The physical value of a signal in these data, NaN where it is sent as none.
fn number(message: &Message, place: usize, data: &[u8]) -> Option<f64> {
    let (raw, signal) = (message.raw(place, data)?, message.signals.get(place)?);
    Some(if signal.is_not_available(raw) { f64::NAN } else { signal.physical(raw) })
}
