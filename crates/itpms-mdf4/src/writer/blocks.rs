//! Blocks as bytes: what stands before the data, with places for what is known at the end.
//!
//! Called by the writer when it begins. Knows the layout of blocks (ASAM MDF 4.1), nothing of samples.

use super::spec::{ChannelSpec, GroupSpec, SampleFormat};
use crate::block::{FRAME, IDENTIFICATION};

/// The blocks before the data.
#[derive(Debug)]
pub(super) struct Head {
    pub(super) bytes: Vec<u8>,
    pub(super) places: Vec<Places>,
}

/// Where the numbers go that are known at the end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) data: u64,
    pub(super) count: u64,
}

/// Place of the header's start time.
pub(super) const START: u64 = IDENTIFICATION + FRAME + 6 * 8;

const TIME: &str = "time";

/// Bytes of a record's values and of its invalidation bits.
pub(super) fn widths(group: &GroupSpec) -> (usize, usize) {
    let values: usize = group.channels.iter().map(|channel| channel.format.bytes()).sum();
    let integers = group.channels.iter().filter(|channel| channel.format.is_integer()).count();
    (8 + values, integers.div_ceil(8))
}

pub(super) fn head(groups: &[GroupSpec]) -> Head {
    let mut bytes = Vec::new();
    bytes.extend(b"MDF     4.10    itpms   ");
    bytes.extend([0; 4]);
    bytes.extend(410u16.to_le_bytes());
    bytes.resize(IDENTIFICATION as usize, 0);
    let mut head = Head { bytes, places: Vec::new() };
    let header = head.add(b"HD", &[0; 6], &[0; 32]);
    let history = head.history();
    head.link(header, 1, history);
    let mut previous = (header, 0);
    for group in groups {
        let place = head.group(group);
        head.link(previous.0, previous.1, place);
        previous = (place, 0);
    }
    head
}

/// A block: its frame, links and data, on a multiple of eight bytes.
pub(super) fn block(id: &[u8; 2], links: &[u64], data: &[u8]) -> Vec<u8> {
    let length = FRAME as usize + 8 * links.len() + data.len();
    let mut bytes = Vec::with_capacity(length.next_multiple_of(8));
    bytes.extend(frame(id, length as u64, links.len() as u64));
    links.iter().for_each(|link| bytes.extend(link.to_le_bytes()));
    bytes.extend(data);
    bytes.resize(length.next_multiple_of(8), 0);
    bytes
}

/// The frame of a block of `length` bytes.
pub(super) fn frame(id: &[u8; 2], length: u64, links: u64) -> [u8; FRAME as usize] {
    let mut frame = [0; FRAME as usize];
    frame[..2].copy_from_slice(b"##");
    frame[2..4].copy_from_slice(id);
    frame[8..16].copy_from_slice(&length.to_le_bytes());
    frame[16..].copy_from_slice(&links.to_le_bytes());
    frame
}

impl Head {
    fn add(&mut self, id: &[u8; 2], links: &[u64], data: &[u8]) -> u64 {
        let place = self.bytes.len() as u64;
        self.bytes.extend(block(id, links, data));
        place
    }

    /// Sets the n-th link of the block at `place`.
    fn link(&mut self, place: u64, n: usize, target: u64) {
        let at = (place + FRAME) as usize + 8 * n;
        self.bytes[at..at + 8].copy_from_slice(&target.to_le_bytes());
    }

    /// A text block, or nothing for nothing.
    fn text(&mut self, text: &str) -> u64 {
        if text.is_empty() {
            return 0;
        }
        // A zero would end it.
        let mut bytes = text.replace('\0', " ").into_bytes();
        bytes.push(0);
        self.add(b"TX", &[], &bytes)
    }

    /// The program that wrote the file; the standard wants to know.
    fn history(&mut self) -> u64 {
        let comment = format!(
            "<FHcomment><TX>written</TX><tool_id>itpms</tool_id><tool_vendor>itpms</tool_vendor>\
             <tool_version>{}</tool_version></FHcomment>\0",
            env!("CARGO_PKG_VERSION")
        );
        let comment = self.add(b"MD", &[], comment.as_bytes());
        self.add(b"FH", &[0, comment], &[0; 16])
    }

    fn group(&mut self, group: &GroupSpec) -> u64 {
        let (values, invalid) = widths(group);
        let time = Stored { kind: 2, sync: 1, byte: 0, invalid_bit: None };
        let first = self.channel(&ChannelSpec::new(TIME, "s", SampleFormat::Float64), time);
        let (mut previous, mut byte, mut integers) = (first, 8, 0);
        for channel in &group.channels {
            let invalid_bit = channel.format.is_integer().then_some(integers);
            integers += u32::from(invalid_bit.is_some());
            let place = self.channel(channel, Stored { kind: 0, sync: 0, byte, invalid_bit });
            byte += channel.format.bytes() as u32;
            self.link(previous, 0, place);
            previous = place;
        }
        let links = [0, first, self.text(&group.name), 0, 0, self.text(&group.comment)];
        let mut data = vec![0; 24];
        data.extend((values as u32).to_le_bytes());
        data.extend((invalid as u32).to_le_bytes());
        let channel_group = self.add(b"CG", &links, &data);
        let data_group = self.add(b"DG", &[0, channel_group, 0, 0], &[0; 8]);
        self.places.push(Places {
            data: data_group + FRAME + 2 * 8,
            count: channel_group + FRAME + links.len() as u64 * 8 + 8,
        });
        data_group
    }

    fn channel(&mut self, channel: &ChannelSpec, stored: Stored) -> u64 {
        let links =
            [0, 0, self.text(&channel.name), 0, 0, 0, self.text(&channel.unit), self.text(&channel.comment)];
        let mut data = vec![stored.kind, stored.sync, channel.format.data_type(), 0];
        data.extend(stored.byte.to_le_bytes());
        data.extend((8 * channel.format.bytes() as u32).to_le_bytes());
        // Bit 1 of the flags: there is an invalidation bit.
        let flags = if stored.invalid_bit.is_some() { 2u32 } else { 0 };
        data.extend(flags.to_le_bytes());
        data.extend(stored.invalid_bit.unwrap_or(0).to_le_bytes());
        data.resize(72, 0);
        self.add(b"CN", &links, &data)
    }
}

/// Where and how a channel lies in its record.
#[derive(Debug, Clone, Copy)]
struct Stored {
    /// `cn_type`: 0 value, 2 master.
    kind: u8,
    /// `cn_sync_type`: 1 time.
    sync: u8,
    byte: u32,
    invalid_bit: Option<u32>,
}
