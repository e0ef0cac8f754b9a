//! Frames of a CAN bus in an MDF4 file (ASAM MDF bus logging 4.1): which groups hold them, and which of their channels is what.
//!
//! For who makes frames of them. A group of data frames has a channel `CAN_DataFrame`, beside or inside it the channels
//! `CAN_DataFrame.ID` and so on; remote and error frames have groups alike.

use super::channel::{Channel, ChannelGroup, ChannelKind};
use super::cursor::GroupCursor;
use super::error::Mdf4Error;
use super::reader::Mdf4Reader;

/// Kind of a group's frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameGroupKind {
    /// Frames with data.
    Data,
    /// Requests for data.
    Remote,
    /// Errors on the bus.
    Error,
}

const KINDS: [(&str, FrameGroupKind); 3] = [
    ("CAN_DataFrame", FrameGroupKind::Data),
    ("CAN_RemoteFrame", FrameGroupKind::Remote),
    ("CAN_ErrorFrame", FrameGroupKind::Error),
];

/// A field of a frame that is a number, by its place in the format's list of such fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameField {
    /// Number of the bus.
    BusChannel,
    /// Identifier, 11 or 29 bits.
    Id,
    /// Whether it has 29 bits.
    Ide,
    /// Code of the length.
    Dlc,
    /// Bytes of data.
    DataLength,
    /// Whether the logger sent it itself.
    Dir,
    /// Whether it is one of CAN FD.
    Edl,
    /// Whether its data went at another bit rate.
    Brs,
    /// Whether its sender was error passive.
    Esi,
}

const FIELDS: [&str; 9] = ["BusChannel", "ID", "IDE", "DLC", "DataLength", "Dir", "EDL", "BRS", "ESI"];

/// The frames of one group, one by one.
#[derive(Debug)]
pub struct FrameCursor {
    /// Kind of the frames.
    pub kind: FrameGroupKind,
    /// The way through the samples; its bytes are the present frame's data.
    pub cursor: GroupCursor,
    /// Per field the place of its value.
    places: [Option<usize>; FIELDS.len()],
    values: Vec<f64>,
}

impl FrameCursor {
    /// All groups of the file that hold frames of a CAN bus.
    ///
    /// # Errors
    /// See [`Mdf4Reader::cursor`].
    pub fn all(reader: &Mdf4Reader) -> Result<Vec<Self>, Mdf4Error> {
        // Frames take room: records of no bytes are none.
        let with_records = reader.groups().iter().enumerate().filter(|(index, _)| reader.has_records(*index));
        let of_groups = with_records.filter_map(|(index, group)| Some((index, kind(group)?)));
        of_groups.map(|(index, (name, kind))| Self::open(reader, index, name, kind)).collect()
    }

    fn open(reader: &Mdf4Reader, index: usize, name: &str, kind: FrameGroupKind) -> Result<Self, Mdf4Error> {
        let channels = &reader.groups()[index].channels;
        let called = |field: &str| {
            channels.iter().position(|channel| {
                channel.name.strip_prefix(name).and_then(|rest| rest.strip_prefix('.')) == Some(field)
            })
        };
        let mut numbers = Vec::new();
        let places = FIELDS.map(|field| {
            let channel = called(field).filter(|place| channels[*place].kind == ChannelKind::Number)?;
            numbers.push(channel);
            Some(numbers.len() - 1)
        });
        let cursor = match called("DataBytes") {
            Some(bytes) => reader.cursor_with_bytes(index, &numbers, bytes)?,
            None => reader.cursor(index, &numbers)?,
        };
        Ok(Self { kind, cursor, places, values: vec![f64::NAN; numbers.len()] })
    }

    /// On to the next frame; its time in s.
    ///
    /// # Errors
    /// See [`GroupCursor::next`].
    pub fn next_frame(&mut self) -> Result<Option<f64>, Mdf4Error> {
        self.cursor.next(&mut self.values)
    }

    /// The value of a field of the present frame; `None` where there is no such field, or it is no number of 32 bits.
    #[must_use]
    pub fn field(&self, field: FrameField) -> Option<u32> {
        let value = self.values[self.places[field as usize]?];
        (0.0..=f64::from(u32::MAX)).contains(&value).then_some(value as u32)
    }
}

/// Whether there are data frames of a CAN bus.
#[must_use]
pub fn has_frames(reader: &Mdf4Reader) -> bool {
    let is_data = |group: &ChannelGroup| kind(group).is_some_and(|(_, kind)| kind == FrameGroupKind::Data);
    reader.groups().iter().any(|group| group.samples != Some(0) && is_data(group))
}

fn kind(group: &ChannelGroup) -> Option<(&'static str, FrameGroupKind)> {
    let has = |name: &str| group.channels.iter().any(|channel: &Channel| channel.name == name);
    KINDS.into_iter().find(|(name, _)| group.has_time && has(name))
}
