//! A message and its signals: a frame's bytes to physical values and back.
//!
//! Made by the builder, which has checked everything: layouts lie within the message, multiplexers are there and in no
//! circle. Called by the decoder and by whoever sends frames. Knows nothing of columns.

use thiserror::Error;

use super::bits::Layout;
use super::missing::{Missing, NoValue};
use crate::{CanId, Payload};

/// A message of a DBC file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Message {
    /// Its identifier.
    pub id: CanId,
    /// Its name.
    pub name: String,
    /// Who sends it; empty where none is named.
    pub sender: String,
    /// The file's comment; may be empty.
    pub comment: String,
    /// Bytes of its data.
    pub length: usize,
    /// Whether it is a CAN FD message (`VFrameFormat`, or longer than 8 bytes).
    pub fd: bool,
    /// Whether it is a parameter group of SAE J1939, which any node may send with any priority (`VFrameFormat`, `ProtocolType`).
    pub j1939: bool,
    /// Time from one to the next in s (`GenMsgCycleTime`).
    pub cycle_s: Option<f64>,
    /// Its signals, in the file's order.
    pub signals: Vec<Signal>,
    /// Line of the file.
    pub line: u64,
    /// The signals, multiplexers before what they select.
    pub(super) order: Vec<usize>,
}

/// A signal of a message.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Signal {
    /// Its name.
    pub name: String,
    /// Its unit; may be empty.
    pub unit: String,
    /// The file's comment; may be empty.
    pub comment: String,
    /// Where its bits are.
    pub layout: Layout,
    /// Meaning of its bits.
    pub kind: Kind,
    /// Physical value per raw one.
    pub factor: f64,
    /// Physical value of raw zero.
    pub offset: f64,
    /// Least physical value; without meaning unless below `max`.
    pub min: f64,
    /// Largest physical value.
    pub max: f64,
    /// Who receives it.
    pub receivers: Vec<String>,
    /// Raw values with a name.
    pub labels: Vec<(i64, String)>,
    /// When it is there; `None`: always.
    pub selector: Option<Selector>,
    /// Line of the file.
    pub line: u64,
    pub(super) missing: Missing,
    /// Whether a signal of the same name and unit stands before it, which another value of a multiplexer selects.
    pub(super) is_another_layout: bool,
}

/// The meaning of a signal's bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A natural number.
    Unsigned,
    /// A two's complement.
    Signed,
    /// An IEEE 754 number of 32 bits.
    Float32,
    /// An IEEE 754 number of 64 bits.
    Float64,
}

/// A multiplexed signal is there while its multiplexer has one of these values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selector {
    /// The multiplexer's place among the message's signals.
    pub switch: usize,
    /// Its raw values, both ends included.
    pub ranges: Vec<(u64, u64)>,
}

/// A value that a message cannot carry.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "message {message}, signal {signal}: has no value, and no label that says so (SNA), expected a number"
)]
pub struct EncodeError {
    /// The message.
    pub message: String,
    /// The signal.
    pub signal: String,
}

impl Signal {
    /// The raw bits; `None` if the data end before them. Whether a multiplexer selects it is not looked at.
    #[must_use]
    pub fn raw(&self, data: &[u8]) -> Option<u64> {
        self.layout.get(data)
    }

    /// The physical value of raw bits.
    #[must_use]
    pub fn physical(&self, raw: u64) -> f64 {
        let number = match self.kind {
            Kind::Unsigned => raw as f64,
            Kind::Signed => self.layout.signed(raw) as f64,
            Kind::Float32 => f64::from(f32::from_bits(raw as u32)),
            Kind::Float64 => f64::from_bits(raw),
        };
        number * self.factor + self.offset
    }

    /// Whether these bits are no value.
    #[must_use]
    pub fn is_not_available(&self, raw: u64) -> bool {
        self.no_value(raw).is_some()
    }

    /// Why these bits are no value, if they are none: a label such as `SNA` or `invalid`, SAE J1939, or an end of the raw numbers beyond the
    /// stated range.
    #[must_use]
    #[inline]
    pub fn no_value(&self, raw: u64) -> Option<NoValue> {
        self.missing.why(raw)
    }

    /// The raw bits nearest to a physical value, kept within the signal's range. NaN is sent as the raw value labeled
    /// as no value, on SAE J1939 as all ones; `None` if there is none and it is no float.
    #[must_use]
    pub fn bits_of(&self, physical: f64) -> Option<u64> {
        let float = matches!(self.kind, Kind::Float32 | Kind::Float64);
        if physical.is_nan() && !float {
            return self.missing.code(self.layout.mask());
        }
        let within = if self.min < self.max { physical.clamp(self.min, self.max) } else { physical };
        let number = (within - self.offset) / self.factor;
        // Casts of floats keep to the range of the integer; 2^53 and above has no fractions to round.
        Some(match self.kind {
            Kind::Unsigned => (number.round() as u64).min(self.layout.mask()),
            Kind::Signed => {
                let largest = (self.layout.mask() >> 1) as i64;
                ((number.round() as i64).clamp(-largest - 1, largest)) as u64 & self.layout.mask()
            }
            Kind::Float32 if number.is_finite() => {
                let limit = f64::from(f32::MAX);
                u64::from((number.clamp(-limit, limit) as f32).to_bits())
            }
            Kind::Float32 => u64::from((number as f32).to_bits()),
            Kind::Float64 => number.to_bits(),
        })
    }
}

impl Message {
    /// Hands the physical value of every signal that is in these data to `found`, with the signal's place, NaN
    /// where the bits say that there is none. Signals beyond the end of a short frame, and those that a multiplexer does not select, are not in it.
    pub fn decode(&self, data: &[u8], mut found: impl FnMut(usize, f64)) {
        for (place, signal) in self.signals.iter().enumerate() {
            if let Some(raw) = self.raw(place, data) {
                let value = if signal.is_not_available(raw) { f64::NAN } else { signal.physical(raw) };
                found(place, value);
            }
        }
    }

    /// The signals, each in its first layout: their places.
    pub fn first_layouts(&self) -> impl Iterator<Item = usize> {
        let first = |(_, signal): &(usize, &Signal)| !signal.is_another_layout;
        self.signals.iter().enumerate().filter(first).map(|(place, _)| place)
    }

    /// All layouts of the signal whose first one is at this place: those of its name and unit.
    pub fn layouts_of(&self, first: usize) -> impl Iterator<Item = usize> {
        let wanted = self.signals.get(first);
        let same = move |place: usize, other: &Signal| {
            place == first
                || wanted.is_some_and(|wanted| {
                    other.is_another_layout && wanted.name == other.name && wanted.unit == other.unit
                })
        };
        self.signals
            .iter()
            .enumerate()
            .filter(move |(place, other)| same(*place, other))
            .map(|(place, _)| place)
    }

    /// The raw bits of one signal, if it is in these data.
    #[must_use]
    pub fn raw(&self, place: usize, data: &[u8]) -> Option<u64> {
        let signal = self.signals.get(place)?;
        if signal.selector.is_none() || self.is_selected(place, data) { signal.raw(data) } else { None }
    }

    /// Whether all multiplexers before a signal select what leads to it.
    fn is_selected(&self, place: usize, data: &[u8]) -> bool {
        let mut at = place;
        // The builder let no circle through; as many steps as there are signals end in any case.
        for _ in 0..self.signals.len() {
            let Some(signal) = self.signals.get(at) else { return false };
            let Some(selector) = &signal.selector else { return true };
            let Some(raw) = self.signals.get(selector.switch).and_then(|switch| switch.raw(data)) else {
                return false;
            };
            if !selector.ranges.iter().any(|(low, high)| (*low..=*high).contains(&raw)) {
                return false;
            }
            at = selector.switch;
        }
        false
    }

    /// The data of a frame with these physical values, rounded, and kept within each signal's range. Asked for are
    /// multiplexers first, then the signals that they select. A CAN FD message gets the next length that a frame
    /// can have; bits without a signal are zero. Where signals overlap, the later one in the file prevails.
    ///
    /// # Errors
    /// A value is NaN, and its signal has no raw value labeled as none.
    pub fn encode(&self, mut value: impl FnMut(usize) -> f64) -> Result<Payload, EncodeError> {
        let mut data = [0; Payload::MOST];
        for &place in &self.order {
            let Some(signal) = self.signals.get(place) else { continue };
            if signal.selector.is_some() && !self.is_selected(place, &data) {
                continue;
            }
            let bits = signal
                .bits_of(value(place))
                .ok_or_else(|| EncodeError { message: self.name.clone(), signal: signal.name.clone() })?;
            signal.layout.put(&mut data, bits);
        }
        let length = self.frame_length();
        Ok(data.get(..length).and_then(Payload::new).unwrap_or(Payload::EMPTY))
    }

    /// Bytes of a frame that holds this message: CAN FD knows but some lengths above 8.
    #[must_use]
    pub fn frame_length(&self) -> usize {
        const ABOVE_EIGHT: [usize; 7] = [12, 16, 20, 24, 32, 48, 64];
        if self.length <= 8 {
            return self.length;
        }
        ABOVE_EIGHT.into_iter().find(|length| *length >= self.length).unwrap_or(Payload::MOST)
    }
}
