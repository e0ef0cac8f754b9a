//! The frames of a bus logging in MDF4 (ASAM MDF bus logging). Called by `FrameReader`; the blocks of the format are the MDF4 reader's.
//!
//! A file has data frames, remote frames and error frames in groups of their own, often one per bus: the oldest of their next frames comes first. The bus is
//! the channel as the file numbers it: python-can counts from 0, Vector's programs from 1.

use std::path::Path;

use itpms_mdf4::Mdf4Reader;
use itpms_mdf4::bus::{FrameCursor, FrameField, FrameGroupKind};

use super::frame::{CanFrame, CanId, Direction, FrameKind, Payload, length_of_code};
use super::frame_source::FrameSource;
use super::repairs::{FramePlace, FrameRepairs};
use super::writer::MOST_TIME_S;
use crate::error::{CanError, CanProblem};

/// Set in an identifier of 29 bits where a file has no field for that.
const EXTENDED: u32 = 1 << 31;

#[derive(Debug)]
pub(super) struct Mf4Reader {
    groups: Vec<Group>,
    /// When time 0 was, in s since 1970; 0 if the file does not know.
    start_s: f64,
    repairs: Vec<String>,
}

#[derive(Debug)]
struct Group {
    cursor: FrameCursor,
    next: Option<CanFrame>,
    count: u64,
}

impl Mf4Reader {
    pub(super) fn open(path: &Path) -> Result<Self, CanError> {
        let reader = Mdf4Reader::open(path)?;
        let groups = FrameCursor::all(&reader)?;
        if groups.is_empty() {
            return Err(CanError::new(path, CanProblem::NoFrameGroup));
        }
        let groups = groups.into_iter().map(|cursor| Group { cursor, next: None, count: 0 }).collect();
        let repairs = reader.repairs().iter().map(ToString::to_string).collect();
        let mut frames = Self { groups, start_s: reader.start_ns() as f64 / 1e9, repairs };
        let mut found = FrameRepairs::default();
        for group in &mut frames.groups {
            group.advance(frames.start_s, &mut found).map_err(|problem| CanError::new(path, problem))?;
        }
        frames.repairs.extend(found.warnings());
        Ok(frames)
    }
}

impl FrameSource for Mf4Reader {
    fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        let with_next = self.groups.iter_mut().filter(|group| group.next.is_some());
        let Some(oldest) = with_next.min_by(|a, b| a.next_s().total_cmp(&b.next_s())) else {
            self.repairs.drain(..).for_each(|sentence| repairs.assume(sentence));
            let of_groups = self.groups.iter().flat_map(|group| group.cursor.cursor.repairs());
            of_groups.for_each(|repair| repairs.assume(repair.to_string()));
            return Ok(None);
        };
        let frame = oldest.next;
        oldest.advance(self.start_s, repairs)?;
        Ok(frame)
    }

    fn progress(&self) -> f64 {
        self.groups.iter().map(|group| group.cursor.cursor.progress()).fold(1.0, f64::min)
    }
}

impl Group {
    fn next_s(&self) -> f64 {
        self.next.map_or(f64::INFINITY, |frame| frame.time_s)
    }

    fn advance(&mut self, start_s: f64, repairs: &mut FrameRepairs) -> Result<(), CanProblem> {
        self.next = None;
        while self.next.is_none() {
            let Some(time_s) = self.cursor.next_frame().map_err(|error| CanProblem::Mdf4(*error.problem))?
            else {
                return Ok(());
            };
            self.count += 1;
            match frame(&mut self.cursor, start_s + time_s)? {
                Ok(frame) => self.next = Some(frame),
                Err(expected) => {
                    let place = FramePlace::Frame(self.count);
                    repairs.not_understood(place, "none".to_owned(), expected);
                }
            }
        }
        Ok(())
    }
}

/// The frame that the cursor is at, or what was expected of it.
fn frame(cursor: &mut FrameCursor, time_s: f64) -> Result<Result<CanFrame, &'static str>, CanProblem> {
    use FrameField::{Brs, BusChannel, DataLength, Dir, Dlc, Edl, Esi, Id, Ide};
    let is_set = |field| cursor.field(field).is_some_and(|value| value != 0);
    // Before a trigger times are negative where the file has no date.
    if !(-MOST_TIME_S..=MOST_TIME_S).contains(&time_s) {
        return Ok(Err("a time before the year 9999"));
    }
    let Some(id) = cursor.field(Id).or((cursor.kind == FrameGroupKind::Error).then_some(0)) else {
        return Ok(Err("an identifier"));
    };
    let is_extended = match cursor.field(Ide) {
        Some(ide) => ide != 0,
        None => id & EXTENDED != 0 || id > CanId::STANDARD_MOST,
    };
    let Some(id) = (if is_extended { Some(CanId::extended_of(id)) } else { CanId::standard(id) }) else {
        return Ok(Err("an identifier of 11 bits, or IDE set"));
    };
    let code = cursor.field(Dlc);
    let length = cursor.field(DataLength).map(|length| length as usize);
    let is_fd = is_set(Edl) || (cursor.field(Edl).is_none() && length.is_some_and(|length| length > 8));
    let kind = match cursor.kind {
        FrameGroupKind::Error => FrameKind::Error,
        FrameGroupKind::Remote => FrameKind::Remote,
        FrameGroupKind::Data if is_fd => {
            FrameKind::Fd { bit_rate_switch: is_set(Brs), error_state_indicator: is_set(Esi) }
        }
        FrameGroupKind::Data => FrameKind::Data,
    };
    let direction = if is_set(Dir) { Direction::Tx } else { Direction::Rx };
    let bus = cursor.field(BusChannel).map_or(0, |channel| u16::try_from(channel).unwrap_or(u16::MAX));
    let of_code = code.map(|code| length_of_code(code.min(if is_fd { 15 } else { 8 }) as u8));
    let payload = match kind {
        FrameKind::Remote => Payload::zeros(of_code.or(length).unwrap_or(0).min(8)),
        _ => {
            let bytes = cursor.cursor.bytes()?;
            let length = length.or(of_code).or(bytes.map(<[u8]>::len));
            match (bytes, length) {
                (_, Some(0) | None) => Some(Payload::EMPTY),
                (bytes, Some(length)) => bytes.and_then(|bytes| bytes.get(..length)).and_then(Payload::new),
            }
        }
    };
    // A classic frame has eight bytes.
    let payload = payload.filter(|payload| kind != FrameKind::Data || payload.len() <= 8);
    let Some(payload) = payload else { return Ok(Err("as many bytes of data as it has by its length")) };
    Ok(Ok(CanFrame { time_s, bus, id, kind, direction, payload }))
}
