//! One object of a BLF file to a frame, and back. Called by the reader and the writer beside it; knows nothing of containers.
//!
//! After the base header (16 bytes) come flags u32 (1: stamps of 10 µs, 2: of 1 ns), 4 bytes, stamp u64; version 2 has 8
//! bytes more. The bodies are described where they are read.

use super::bytes::{array, u8_at, u16_at, u32_at, u64_at};
use super::{BASE_HEADER, SIGNATURE, kind};
use crate::frame::{CanFrame, CanId, Direction, FrameKind, Payload, length_of_code};

/// Largest size of an object that holds a frame; theirs are below 200 bytes, with extended data some more.
pub(super) const MOST_FRAME_BYTES: usize = 1024;

/// Bytes before the body in version 1 and 2.
const HEADER_V1: usize = 32;
const HEADER_V2: usize = 40;

/// Flags of classic messages, of CAN FD messages and of the longer CAN FD messages.
const REMOTE: u8 = 0x80;
const FD_FORMAT: u8 = 1;
const FD_RATE: u8 = 2;
const FD_STATE: u8 = 4;
const FD64_REMOTE: u32 = 0x0010;
const FD64_FORMAT: u32 = 0x1000;
const FD64_RATE: u32 = 0x2000;
const FD64_STATE: u32 = 0x4000;

/// Set in an identifier of 29 bits.
const EXTENDED: u32 = 0x8000_0000;

/// Unit of the stamps in s.
const TEN_MICROSECONDS: u32 = 1;

pub(super) fn is_frame(object_type: u32) -> bool {
    matches!(
        object_type,
        kind::CAN_MESSAGE
            | kind::CAN_ERROR
            | kind::CAN_ERROR_EXT
            | kind::CAN_MESSAGE2
            | kind::CAN_FD_MESSAGE
            | kind::CAN_FD_MESSAGE_64
            | kind::CAN_FD_ERROR_64
    )
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Object {
    /// A frame; its time is the time since the measurement's beginning.
    Frame(CanFrame),
    /// A request to send, which is followed by the frame itself, or a header of a version not known.
    Other,
    /// Shorter than its fields.
    Broken,
}

/// Reads an object whose type [`is_frame`], from its signature to its end.
pub(super) fn parse(data: &[u8]) -> Object {
    let header = match u16_at(data, 6) {
        Some(1) => HEADER_V1,
        Some(2) => HEADER_V2,
        _ => return Object::Other,
    };
    frame(data, header).unwrap_or(Object::Broken)
}

fn frame(data: &[u8], header: usize) -> Option<Object> {
    let (flags, stamp) = (u32_at(data, BASE_HEADER)?, u64_at(data, BASE_HEADER + 8)?);
    let units_per_s = if flags == TEN_MICROSECONDS { 1e5 } else { 1e9 };
    let body = data.get(header..)?;
    let found = match u32_at(data, 12)? {
        kind::CAN_MESSAGE | kind::CAN_MESSAGE2 => classic(body)?,
        kind::CAN_FD_MESSAGE => fd(body)?,
        kind::CAN_FD_MESSAGE_64 => fd64(body, header)?,
        kind::CAN_ERROR_EXT => error_ext(body)?,
        kind::CAN_ERROR => Some(error(u16_at(body, 0)?)),
        kind::CAN_FD_ERROR_64 => Some(error(u8_at(body, 0)?.into())),
        _ => None,
    };
    Some(match found {
        Some(mut frame) => {
            frame.time_s = stamp as f64 / units_per_s;
            Object::Frame(frame)
        }
        None => Object::Other,
    })
}

/// Channel u16, flags u8, length code u8, identifier u32, 8 bytes.
fn classic(body: &[u8]) -> Option<Option<CanFrame>> {
    let (flags, length) = (u8_at(body, 2)?, usize::from(u8_at(body, 3)?).min(8));
    let bytes: [u8; 8] = array(body, 8)?;
    let Some(direction) = direction_of(flags & 0x0F) else { return Some(None) };
    let (kind, payload) = if flags & REMOTE != 0 {
        (FrameKind::Remote, Payload::zeros(length)?)
    } else {
        (FrameKind::Data, Payload::new(bytes.get(..length)?)?)
    };
    Some(Some(made(u16_at(body, 0)?, u32_at(body, 4)?, kind, direction, payload)))
}

/// Channel u16, flags u8, length code u8, identifier u32, frame length u32, bits u8, FD flags u8, valid bytes u8, 5, up to 64 bytes.
fn fd(body: &[u8]) -> Option<Option<CanFrame>> {
    let (flags, code, fd_flags) = (u8_at(body, 2)?, u8_at(body, 3)?, u8_at(body, 13)?);
    let Some(direction) = direction_of(flags & 0x0F) else { return Some(None) };
    let bytes = padded(body.get(20..)?, u8_at(body, 14)?);
    let fd = (fd_flags & FD_FORMAT != 0).then_some((fd_flags & FD_RATE != 0, fd_flags & FD_STATE != 0));
    let (kind, payload) = fd_kind(fd, flags & REMOTE != 0, code, bytes)?;
    Some(Some(made(u16_at(body, 0)?, u32_at(body, 4)?, kind, direction, payload)))
}

/// Channel u8, length code u8, valid bytes u8, 1, identifier u32, frame length u32, flags u32, 16, bits u16, direction u8,
/// offset of extended data u8 (from the object's beginning, 0 if there are none), checksum u32, the bytes.
fn fd64(body: &[u8], header: usize) -> Option<Option<CanFrame>> {
    const FIXED: usize = 40;
    let (code, flags) = (u8_at(body, 1)?, u32_at(body, 12)?);
    let Some(direction) = direction_of(u8_at(body, 34)?) else { return Some(None) };
    let end = match usize::from(u8_at(body, 35)?) {
        0 => body.len(),
        offset => offset.saturating_sub(header).clamp(FIXED, body.len()),
    };
    // Fewer bytes than are valid may be there; Vector's library takes the rest as zeros.
    let bytes = padded(body.get(FIXED..end)?, u8_at(body, 2)?);
    let fd = (flags & FD64_FORMAT != 0).then_some((flags & FD64_RATE != 0, flags & FD64_STATE != 0));
    let (kind, payload) = fd_kind(fd, flags & FD64_REMOTE != 0, code, bytes)?;
    Some(Some(made(u8_at(body, 0)?.into(), u32_at(body, 4)?, kind, direction, payload)))
}

/// Channel u16, length u16, flags u32, code u8, position u8, length code u8, 1, frame length u32, identifier u32, flags u16, 2, 8 bytes.
fn error_ext(body: &[u8]) -> Option<Option<CanFrame>> {
    let length = usize::from(u8_at(body, 10)? & 0x0F).min(8);
    let bytes: [u8; 8] = array(body, 24)?;
    let payload = Payload::new(bytes.get(..length)?)?;
    let id = u32_at(body, 16)?;
    Some(Some(made(u16_at(body, 0)?, id, FrameKind::Error, Direction::Rx, payload)))
}

/// An error of which no more is known than where.
fn error(channel: u16) -> CanFrame {
    made(channel, EXTENDED, FrameKind::Error, Direction::Rx, Payload::EMPTY)
}

/// Received, sent; 2 is a request to send.
fn direction_of(code: u8) -> Option<Direction> {
    match code {
        2 => None,
        code if code & 1 != 0 => Some(Direction::Tx),
        _ => Some(Direction::Rx),
    }
}

/// So many bytes, zeros where there are none.
fn padded(bytes: &[u8], valid: u8) -> Payload {
    let mut payload = Payload::EMPTY;
    for index in 0..usize::from(valid).min(Payload::MOST) {
        payload.push(bytes.get(index).copied().unwrap_or(0));
    }
    payload
}

/// Kind and payload of a message that may be CAN FD (with rate and state), remote or classic.
fn fd_kind(
    fd: Option<(bool, bool)>,
    is_remote: bool,
    code: u8,
    bytes: Payload,
) -> Option<(FrameKind, Payload)> {
    Some(match fd {
        _ if is_remote => (FrameKind::Remote, Payload::zeros(length_of_code(code).min(8))?),
        Some((bit_rate_switch, error_state_indicator)) => {
            (FrameKind::Fd { bit_rate_switch, error_state_indicator }, bytes)
        }
        None => (FrameKind::Data, Payload::new(bytes.as_slice().get(..bytes.len().min(8))?)?),
    })
}

/// Channels count from one, buses from zero. A number too large for a standard identifier is an extended one.
fn made(channel: u16, id: u32, kind: FrameKind, direction: Direction, payload: Payload) -> CanFrame {
    let id = match CanId::standard(id & !EXTENDED) {
        Some(standard) if id & EXTENDED == 0 => standard,
        _ => CanId::extended_of(id),
    };
    CanFrame { time_s: 0.0, bus: channel.saturating_sub(1), id, kind, direction, payload }
}

/// Adds a frame as an object, with its padding: `CAN_MESSAGE`, `CAN_FD_MESSAGE` or `CAN_ERROR_EXT`, stamps of 1 ns.
pub(super) fn push(out: &mut Vec<u8>, frame: &CanFrame, stamp_ns: u64) {
    let object_type = match frame.kind {
        FrameKind::Data | FrameKind::Remote => kind::CAN_MESSAGE,
        FrameKind::Fd { .. } => kind::CAN_FD_MESSAGE,
        FrameKind::Error => kind::CAN_ERROR_EXT,
    };
    let begin = out.len();
    out.extend_from_slice(SIGNATURE);
    out.extend_from_slice(&(HEADER_V1 as u16).to_le_bytes());
    out.extend_from_slice(&1_u16.to_le_bytes());
    out.extend_from_slice(&0_u32.to_le_bytes());
    out.extend_from_slice(&object_type.to_le_bytes());
    out.extend_from_slice(&2_u32.to_le_bytes());
    out.extend_from_slice(&0_u32.to_le_bytes());
    out.extend_from_slice(&stamp_ns.to_le_bytes());
    push_body(out, frame);
    let size = out.len() - begin;
    if let Some(place) = out.get_mut(begin + 8..begin + 12) {
        place.copy_from_slice(&(size as u32).to_le_bytes());
    }
    // The bodies' lengths are multiples of four: no padding.
    debug_assert_eq!(size % 4, 0);
}

fn push_body(out: &mut Vec<u8>, frame: &CanFrame) {
    let channel = frame.bus.saturating_add(1).to_le_bytes();
    let id = (frame.id.value() | if frame.id.is_extended() { EXTENDED } else { 0 }).to_le_bytes();
    let mut bytes = [0; Payload::MOST];
    bytes[..frame.length()].copy_from_slice(frame.payload.as_slice());
    let sent = u8::from(frame.direction == Direction::Tx);
    let code = frame.length_code();
    out.extend_from_slice(&channel);
    match frame.kind {
        FrameKind::Data | FrameKind::Remote => {
            let remote = if frame.kind == FrameKind::Remote { REMOTE } else { 0 };
            out.extend_from_slice(&[sent | remote, code.min(8)]);
            out.extend_from_slice(&id);
            out.extend_from_slice(&bytes[..8]);
        }
        FrameKind::Fd { bit_rate_switch, error_state_indicator } => {
            let rate = if bit_rate_switch { FD_RATE } else { 0 };
            let state = if error_state_indicator { FD_STATE } else { 0 };
            out.extend_from_slice(&[sent, code]);
            out.extend_from_slice(&id);
            out.extend_from_slice(&[0; 5]);
            out.extend_from_slice(&[FD_FORMAT | rate | state, frame.length() as u8, 0, 0, 0, 0, 0]);
            out.extend_from_slice(&bytes);
        }
        FrameKind::Error => {
            out.extend_from_slice(&[0; 8]);
            out.extend_from_slice(&[code.min(8), 0, 0, 0, 0, 0]);
            out.extend_from_slice(&id);
            out.extend_from_slice(&[0; 4]);
            out.extend_from_slice(&bytes[..8]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(object_type: u32, flags: u32, stamp: u64, body: &[u8]) -> Vec<u8> {
        let mut data = SIGNATURE.to_vec();
        data.extend_from_slice(&[32, 0, 1, 0]);
        data.extend_from_slice(&(32 + body.len() as u32).to_le_bytes());
        data.extend_from_slice(&object_type.to_le_bytes());
        data.extend_from_slice(&flags.to_le_bytes());
        data.extend_from_slice(&[0; 4]);
        data.extend_from_slice(&stamp.to_le_bytes());
        data.extend_from_slice(body);
        data
    }

    fn frame_of(data: &[u8]) -> CanFrame {
        match parse(data) {
            Object::Frame(frame) => frame,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_classic_message_has_its_fields_where_the_format_says() {
        let body = [2, 0, 1, 3, 0x23, 0x01, 0, 0, 0xDE, 0xAD, 0xBE, 0, 0, 0, 0, 0];
        let frame = frame_of(&object(kind::CAN_MESSAGE, 1, 25_000, &body));
        assert_eq!((frame.time_s, frame.bus, frame.direction), (0.25, 1, Direction::Tx));
        assert_eq!((frame.id, frame.data()), (CanId::standard(0x123).unwrap(), &[0xDE, 0xAD, 0xBE][..]));
        // MESSAGE2 has eight bytes more, stamps may be of 1 ns, a code above 8 means 8 bytes.
        let body = [&[1, 0, 0x80, 15, 0x23, 0x01, 0, 0x80][..], &[0; 16]].concat();
        let remote = frame_of(&object(kind::CAN_MESSAGE2, 2, 250_000_000, &body));
        assert_eq!((remote.time_s, remote.kind, remote.length()), (0.25, FrameKind::Remote, 8));
        assert_eq!(remote.id, CanId::extended(0x123).unwrap());
        // A request to send is no frame.
        let body = [1, 0, 2, 3, 0x23, 0x01, 0, 0, 0xDE, 0xAD, 0xBE, 0, 0, 0, 0, 0];
        assert_eq!(parse(&object(kind::CAN_MESSAGE, 1, 0, &body)), Object::Other);
    }

    #[test]
    fn long_messages_end_where_their_extended_data_begin_and_are_filled_with_zeros() {
        let mut body = vec![3, 9, 12, 0, 0x23, 0x01, 0, 0, 0, 0, 0, 0];
        body.extend_from_slice(&0x3000_u32.to_le_bytes());
        body.resize(40, 0);
        body[34] = 1;
        body.extend_from_slice(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0xEE, 0xEE]);
        let frame = frame_of(&object(kind::CAN_FD_MESSAGE_64, 2, 0, &body));
        assert_eq!(frame.kind, FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false });
        assert_eq!(frame.data(), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
        assert_eq!((frame.bus, frame.direction), (2, Direction::Tx));
        body[35] = 32 + 40 + 2;
        let short = frame_of(&object(kind::CAN_FD_MESSAGE_64, 2, 0, &body));
        assert_eq!(short.data(), [1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn what_is_shorter_than_its_fields_is_broken() {
        for object_type in [
            kind::CAN_MESSAGE,
            kind::CAN_MESSAGE2,
            kind::CAN_FD_MESSAGE,
            kind::CAN_FD_MESSAGE_64,
            kind::CAN_ERROR_EXT,
            kind::CAN_ERROR,
            kind::CAN_FD_ERROR_64,
        ] {
            assert_eq!(parse(&object(object_type, 2, 0, &[])), Object::Broken, "{object_type}");
        }
    }

    #[test]
    fn every_kind_is_read_as_it_was_written() {
        let kinds = [
            (FrameKind::Data, 8),
            (FrameKind::Data, 0),
            (FrameKind::Remote, 5),
            (FrameKind::Fd { bit_rate_switch: true, error_state_indicator: false }, 64),
            (FrameKind::Fd { bit_rate_switch: false, error_state_indicator: true }, 0),
            (FrameKind::Error, 3),
        ];
        for (kind, length) in kinds {
            for id in [CanId::standard(0x7FF).unwrap(), CanId::extended(0x7FF).unwrap()] {
                let bytes: Vec<u8> = (1..=length).collect();
                let payload = match kind {
                    FrameKind::Remote => Payload::zeros(length.into()).unwrap(),
                    _ => Payload::new(&bytes).unwrap(),
                };
                let direction = if kind == FrameKind::Error { Direction::Rx } else { Direction::Tx };
                let frame = CanFrame { time_s: 0.25, bus: 6, id, kind, direction, payload };
                let mut data = Vec::new();
                push(&mut data, &frame, 250_000_000);
                assert_eq!(frame_of(&data), frame);
            }
        }
    }
}
