//! The channels of a group: CN blocks, compiled into fields.
//!
//! Called by the structure for each channel group; a part of its walk.

use super::block::{Block, Kind};
use super::channel::{BytesLayout, Channel, ChannelKind, Layout, Validity};
use super::conversion::{Conversion, Raw};
use super::error::Mdf4Problem;
use super::field::{ByteOrder, Field, Number};
use super::structure::{MOST_CHANNELS, Walk, too_many};

const CHANNEL: Kind = Kind { name: "channel", id: b"##CN", links: 8, data: 24, most: 128 };

const ARRAY: Kind = Kind { name: "array", id: b"##CA", links: 1, data: 24, most: 64 };

/// Elements of an array that are channels of their own: a value per wheel, the axes of a sensor. Longer ones are curves and pictures.
const MOST_ELEMENTS: u64 = 16;

/// Structures inside structures.
const DEEPEST: usize = 8;

/// `cn_flags`.
const ALL_INVALID: u32 = 1;
const HAS_INVALIDATION_BIT: u32 = 1 << 1;

/// Bytes of a group's records.
#[derive(Debug, Clone, Copy)]
struct Widths {
    values: u32,
    invalid: u32,
}

/// An array of one dimension in a record: how many elements, and from one to the next bytes and invalidation bits.
#[derive(Debug, Clone, Copy)]
struct Array {
    elements: u32,
    bytes: i64,
    invalidation_bits: u32,
}

/// Where a channel is among those of its group, and in its array.
#[derive(Debug, Clone, Copy)]
struct Place {
    index: usize,
    element: Option<(u32, Array)>,
}

/// A channel, how it is read if it is a number, and where its bytes are.
type Found = (Channel, (Option<Layout>, Option<BytesLayout>));

impl Walk<'_> {
    /// The channels from `first` on, those inside structures after the structure.
    pub(super) fn channel_list(
        &mut self,
        first: u64,
        group: &str,
        values: u32,
        invalid: u32,
    ) -> Result<Vec<Found>, Mdf4Problem> {
        let mut found = Vec::new();
        let widths = Widths { values, invalid };
        // Channels still to be read, as the first of their lists; the depth bounds the number of lists.
        let mut lists = vec![first];
        while let Some(at) = lists.pop() {
            if at == 0 {
                continue;
            }
            let list = || format!("channels of group {group:?}");
            let Some(block) = self.next_in_list(&CHANNEL, at, found.len(), list)? else { continue };
            if self.channels == MOST_CHANNELS {
                return Err(too_many("channels", MOST_CHANNELS));
            }
            self.channels += 1;
            lists.push(block.link(0));
            let mut composite = None;
            if block.link(1) != 0 {
                composite = Some(ChannelKind::Composite);
                let inside = self.file.frame("composition", block.link(1)).map(|frame| frame.id);
                // An array's elements have no channels of their own.
                if lists.len() <= DEEPEST && inside.as_ref().is_ok_and(|id| id == b"##CN") {
                    lists.push(block.link(1));
                }
                if let Some(array) = self.array(block.link(1))
                    && self.channels + array.elements as usize <= MOST_CHANNELS
                {
                    self.channels += array.elements as usize;
                    for number in 0..array.elements {
                        let place = Place { index: found.len(), element: Some((number, array)) };
                        found.push(self.channel(&block, place, widths, None)?);
                    }
                    continue;
                }
            }
            let place = Place { index: found.len(), element: None };
            found.push(self.channel(&block, place, widths, composite)?);
        }
        Ok(found)
    }

    /// A short array of values in the record; `None` for any other composition.
    fn array(&mut self, at: u64) -> Option<Array> {
        let block = self.file.block(&ARRAY, at).ok()?;
        // Values, or a look-up table of them, without a further composition, in the record (and not in groups of their own).
        let plain = matches!(block.u8(0), 0 | 2) && block.u8(1) == 0 && block.link(0) == 0;
        let (dimensions, elements) = (block.u16(2), block.u64(16));
        let bytes = i32::from_le_bytes(block.bytes(8));
        (plain && dimensions == 1 && (1..=MOST_ELEMENTS).contains(&elements)).then(|| Array {
            elements: elements as u32,
            bytes: i64::from(bytes),
            invalidation_bits: block.u32(12),
        })
    }

    fn channel(
        &mut self,
        block: &Block,
        place: Place,
        widths: Widths,
        composite: Option<ChannelKind>,
    ) -> Result<Found, Mdf4Problem> {
        let mut name = self.text(block.link(2))?;
        if name.is_empty() {
            name = format!("channel {}", place.index + 1);
        }
        if let Some((number, _)) = place.element {
            name = format!("{name}[{number}]");
        }
        let mut unit = self.text(block.link(6))?;
        let comment = self.text(block.link(7))?;
        let master = matches!(block.u8(0), 2 | 3);
        let is_time = master && block.u8(1) == 1;
        let field = match composite {
            Some(kind) => Err(kind),
            None => field(block, place.element, widths.values),
        };
        let (kind, layout) = match field {
            Err(kind) => (kind, None),
            Ok((field, raw)) => {
                let (conversion, unit_at) = self.conversions.read(self.file, block.link(4))?;
                if unit.is_empty() {
                    unit = self.text(unit_at)?;
                }
                match &*conversion {
                    Conversion::Unreadable(why) => (ChannelKind::Unreadable(why.clone()), None),
                    _ => {
                        let validity = validity(block, place.element, widths.invalid);
                        (ChannelKind::Number, Some(Layout { field, raw, conversion, validity }))
                    }
                }
            }
        };
        let element = place.element.map(|(number, array)| (number, array.elements));
        let bytes = bytes(block, widths.values).filter(|_| element.is_none());
        Ok((Channel { name, unit, comment, is_time, element, kind }, (layout, bytes)))
    }
}

/// Where a channel's number lies, or what the channel is instead.
fn field(block: &Block, element: Option<(u32, Array)>, record: u32) -> Result<(Field, Raw), ChannelKind> {
    let from_first = element.map_or(0, |(number, array)| i64::from(number) * array.bytes);
    // Beyond any record where it is no place.
    let offset = u32::try_from(i64::from(block.u32(4)) + from_first).unwrap_or(u32::MAX);
    match block.u8(0) {
        // Values, masters, and channels that run beside another medium.
        0 | 2 | 4 => {}
        1 | 5 | 7 => return Err(ChannelKind::VariableLength),
        // Virtual ones are computed from the number of the record.
        3 | 6 => return Ok((Field::Index, Raw::Integer)),
        other => return Err(ChannelKind::Unreadable(format!("a channel of unknown type {other}"))),
    }
    use ByteOrder::{BigEndian, LittleEndian};
    let (number, order) = match block.u8(2) {
        0 => (Number::Unsigned, LittleEndian),
        1 => (Number::Unsigned, BigEndian),
        2 => (Number::Signed, LittleEndian),
        3 => (Number::Signed, BigEndian),
        4 => (Number::Float, LittleEndian),
        5 => (Number::Float, BigEndian),
        6..=9 | 17 => return Err(ChannelKind::Text),
        10..=14 => return Err(ChannelKind::Bytes),
        15 | 16 => return Err(ChannelKind::Unreadable("complex numbers".to_owned())),
        other => return Err(ChannelKind::Unreadable(format!("data of unknown type {other}"))),
    };
    let field = Field::new(number, order, offset, block.u8(3), block.u32(8), record);
    let raw = if number == Number::Float { Raw::Float } else { Raw::Integer };
    field.map(|field| (field, raw)).map_err(ChannelKind::Unreadable)
}

/// Where whole bytes lie in records of `record` bytes.
fn bytes(block: &Block, record: u32) -> Option<BytesLayout> {
    let (offset, bits) = (block.u32(4), block.u32(8));
    let whole = block.u8(3) == 0 && bits % 8 == 0 && offset.checked_add(bits / 8)? <= record;
    let (offset, length) = whole.then_some((offset as usize, bits as usize / 8))?;
    match block.u8(0) {
        // Of fixed length, or of one that another channel has.
        0 | 5 => Some(BytesLayout::Inside { offset, length }),
        1 if length <= 8 => Some(BytesLayout::Apart { offset, length, data: block.link(5) }),
        _ => None,
    }
}

fn validity(block: &Block, element: Option<(u32, Array)>, invalid_bytes: u32) -> Validity {
    let from_first = element.map_or(0, |(number, array)| number.saturating_mul(array.invalidation_bits));
    let (flags, position) = (block.u32(12), block.u32(16).saturating_add(from_first));
    if flags & ALL_INVALID != 0 {
        return Validity::None;
    }
    if flags & HAS_INVALIDATION_BIT == 0 || position / 8 >= invalid_bytes {
        return Validity::All;
    }
    Validity::Bit { byte: (position / 8) as usize, mask: 1 << (position % 8) }
}
