//! One frame as it went over a bus, whatever file or socket it came from. No heap: a frame is a value that is copied.
//!
//! Made by the readers beside it and by whoever listens to a bus; knows nothing of files and of signals.
//! Lengths and identifiers are those of ISO 11898-1: 11 or 29 bits, 8 bytes, with CAN FD 64.

use std::fmt;

/// Identifier of a frame: standard (11 bit) or extended (29 bit). The same number is another identifier in the other form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CanId(u32);

/// Set in [`CanId`] when the identifier has 29 bits, as SocketCAN does it.
const EXTENDED: u32 = 1 << 31;

impl CanId {
    /// Largest standard identifier.
    pub const STANDARD_MOST: u32 = 0x7FF;
    /// Largest extended identifier.
    pub const EXTENDED_MOST: u32 = 0x1FFF_FFFF;

    /// A standard identifier; `None` above [`CanId::STANDARD_MOST`].
    #[must_use]
    pub const fn standard(value: u32) -> Option<Self> {
        if value <= Self::STANDARD_MOST { Some(Self(value)) } else { None }
    }

    /// An extended identifier; `None` above [`CanId::EXTENDED_MOST`].
    #[must_use]
    pub const fn extended(value: u32) -> Option<Self> {
        if value <= Self::EXTENDED_MOST { Some(Self(value | EXTENDED)) } else { None }
    }

    /// The lowest 29 bits of a number as an extended identifier.
    pub(crate) const fn extended_of(value: u32) -> Self {
        Self((value & Self::EXTENDED_MOST) | EXTENDED)
    }

    /// The number, without the form.
    #[must_use]
    pub const fn value(self) -> u32 {
        self.0 & Self::EXTENDED_MOST
    }

    /// The number of the parameter group (PGN) that an identifier of 29 bits has on SAE J1939-21: neither priority nor source
    /// address, and no destination address, which stands in place of the group's low byte where the byte before it is below 240.
    #[must_use]
    pub const fn parameter_group(self) -> u32 {
        let group = (self.0 >> 8) & 0x3_FFFF;
        let to_one_node = (group >> 8) & 0xFF < 240;
        if to_one_node { group & 0x3_FF00 } else { group }
    }

    /// Whether it has 29 bits.
    #[must_use]
    pub const fn is_extended(self) -> bool {
        self.0 & EXTENDED != 0
    }
}

/// Hexadecimal, three digits for standard and eight for extended identifiers.
impl fmt::Display for CanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_extended() { write!(f, "{:08X}", self.value()) } else { write!(f, "{:03X}", self.value()) }
    }
}

/// Kind of frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameKind {
    /// Classic data frame, up to 8 bytes.
    Data,
    /// CAN FD data frame, up to 64 bytes.
    Fd {
        /// The data were sent at the higher rate (BRS).
        bit_rate_switch: bool,
        /// The sender was error passive (ESI).
        error_state_indicator: bool,
    },
    /// Request for data; it has a length and no data.
    Remote,
    /// An error on the bus. Identifier and payload are what the log says of it: SocketCAN's error class and details,
    /// or the frame that was disturbed; often zero.
    Error,
}

/// Which way a frame went, seen from who logged it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Received; also where the log does not say.
    Rx,
    /// Sent.
    Tx,
}

/// Up to 64 bytes, in place.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Payload {
    length: u8,
    /// Zero beyond `length`, so that equal payloads are equal values.
    bytes: [u8; Self::MOST],
}

impl Payload {
    /// Bytes of the longest frame.
    pub const MOST: usize = 64;
    /// No bytes.
    pub const EMPTY: Self = Self { length: 0, bytes: [0; Self::MOST] };

    /// These bytes; `None` if there are more than [`Payload::MOST`].
    #[must_use]
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let mut payload = Self::zeros(bytes.len())?;
        payload.bytes.get_mut(..bytes.len())?.copy_from_slice(bytes);
        Some(payload)
    }

    /// So many zeros: the length of a remote frame. `None` above [`Payload::MOST`].
    #[must_use]
    pub fn zeros(length: usize) -> Option<Self> {
        (length <= Self::MOST).then_some(Self { length: length as u8, bytes: [0; Self::MOST] })
    }

    /// Adds a byte; false when there is no room.
    pub(crate) fn push(&mut self, byte: u8) -> bool {
        match self.bytes.get_mut(usize::from(self.length)) {
            Some(place) => {
                *place = byte;
                self.length += 1;
                true
            }
            None => false,
        }
    }

    /// The bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.len()).unwrap_or_default()
    }

    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        usize::from(self.length)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }
}

impl fmt::Debug for Payload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02X?}", self.as_slice())
    }
}

/// One frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CanFrame {
    /// Time in s on the log's clock: since 1970 (UTC) where the log knows the date, else since its beginning. A
    /// 64-bit number holds the present date to 0.24 µs.
    pub time_s: f64,
    /// Which bus, from zero: `can0` is 0, channel 1 of Vector's formats is 0.
    pub bus: u16,
    /// Its identifier.
    pub id: CanId,
    /// Kind of frame.
    pub kind: FrameKind,
    /// Received or sent.
    pub direction: Direction,
    /// Its bytes; of a remote frame zeros, as many as it asks for.
    pub payload: Payload,
}

impl CanFrame {
    /// A classic data frame received on bus 0; `None` if there are more than 8 bytes.
    #[must_use]
    pub fn new(time_s: f64, id: CanId, data: &[u8]) -> Option<Self> {
        let payload = Payload::new(data).filter(|payload| payload.len() <= 8)?;
        Some(Self { time_s, bus: 0, id, kind: FrameKind::Data, direction: Direction::Rx, payload })
    }

    /// The bytes it carries; none for a remote frame.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        if self.kind == FrameKind::Remote { &[] } else { self.payload.as_slice() }
    }

    /// Its length in bytes; of a remote frame what it asks for.
    #[must_use]
    pub fn length(&self) -> usize {
        self.payload.len()
    }

    /// Whether it is a CAN FD frame.
    #[must_use]
    pub fn is_fd(&self) -> bool {
        matches!(self.kind, FrameKind::Fd { .. })
    }

    /// The data length code (0 to 15) of the shortest frame that holds its bytes.
    #[must_use]
    pub fn length_code(&self) -> u8 {
        code_of_length(self.length())
    }
}

/// Bytes by data length code; the codes above 8 are CAN FD's (ISO 11898-1, table of DLC).
const LENGTHS: [u8; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// The smallest code whose frame holds so many bytes; 15 above 64.
pub(crate) fn code_of_length(length: usize) -> u8 {
    LENGTHS.iter().position(|most| usize::from(*most) >= length).unwrap_or(15) as u8
}

/// Bytes of a CAN FD frame with this code; only the lowest four bits count.
pub(crate) fn length_of_code(code: u8) -> usize {
    LENGTHS.get(usize::from(code & 15)).map_or(0, |length| usize::from(*length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identifier_keeps_its_number_and_its_form() {
        let standard = CanId::standard(0x123).unwrap();
        let extended = CanId::extended(0x123).unwrap();
        assert_ne!(standard, extended);
        assert_eq!((standard.value(), extended.value()), (0x123, 0x123));
        assert_eq!((standard.is_extended(), extended.is_extended()), (false, true));
        assert_eq!((standard.to_string(), extended.to_string()), ("123".to_owned(), "00000123".to_owned()));
        assert_eq!(CanId::standard(0x800), None);
        assert_eq!(CanId::extended(0x2000_0000), None);
    }

    #[test]
    fn length_codes_are_those_of_the_standard() {
        for length in 0..=8 {
            assert_eq!(usize::from(code_of_length(length)), length);
        }
        for (code, length) in [(9, 12), (10, 16), (11, 20), (12, 24), (13, 32), (14, 48), (15, 64)] {
            assert_eq!((code_of_length(length), length_of_code(code)), (code, length));
            assert_eq!(code_of_length(length - 1), code);
        }
    }

    #[test]
    fn a_payload_takes_64_bytes_and_not_one_more() {
        assert_eq!(Payload::new(&[7; 64]).unwrap().as_slice(), [7; 64]);
        assert!(Payload::new(&[7; 65]).is_none());
        let mut payload = Payload::EMPTY;
        assert!((0..64).all(|byte| payload.push(byte)));
        assert!(!payload.push(0));
        assert!(CanFrame::new(0.0, CanId::standard(1).unwrap(), &[0; 9]).is_none());
    }
}
