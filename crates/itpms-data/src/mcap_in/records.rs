//! The records of a file from its beginning to its end, chunks unpacked as they come. No index is needed, so that a recording whose program
//! was killed is read up to its last whole message.

use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use ::mcap::McapError;
use ::mcap::records::{self, Record};
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use itpms_files::input;

use crate::error::{DataError, FileProblem, Problem};

/// Bytes of a record, compressed or not: an attachment or a picture, of which nothing is kept.
const LONGEST: usize = 1 << 28;
/// Bytes of a message that may be one of signals; pictures and clouds of points are longer.
const LONGEST_MESSAGE: usize = 1 << 20;
/// Schemas and channels of a file, of 16 bits each.
const PIECE: usize = 1 << 16;

pub(crate) enum Message<'a> {
    Schema { id: u16, name: String, encoding: String, text: Vec<u8> },
    Channel(records::Channel),
    Data { channel: u16, log_ns: u64, published_ns: u64, bytes: &'a [u8] },
}

enum Next {
    Over,
    /// So many more bytes are needed.
    Wants(usize),
    Record(u8),
    Fails(McapError),
}

pub(crate) struct Messages {
    file: File,
    reader: LinearReader,
    record: Vec<u8>,
    read: u64,
    bytes: u64,
    any: bool,
    /// Why it was not read to its end.
    ended: Option<String>,
    is_over: bool,
}

impl std::fmt::Debug for Messages {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Messages").field("read", &self.read).finish_non_exhaustive()
    }
}

impl Messages {
    pub(crate) fn open(path: &Path) -> Result<Self, DataError> {
        let (file, about) =
            input::open_regular(path, "MCAP").map_err(|problem| DataError::new(path, problem))?;
        let options = LinearReaderOptions::default().with_record_length_limit(LONGEST);
        let reader = LinearReader::new_with_options(options);
        Ok(Self {
            file,
            reader,
            record: Vec::new(),
            read: 0,
            bytes: about.len(),
            any: false,
            ended: None,
            is_over: false,
        })
    }

    /// Hands the next schema, channel or message to `take`; false at the end. A file that is cut off or damaged ends there, and
    /// [`Messages::repairs`] says so. Errors: the file cannot be read, or its beginning is not that of MCAP.
    pub(crate) fn step(&mut self, take: impl FnOnce(Message<'_>)) -> Result<bool, Problem> {
        while !self.is_over {
            let wanted = match self.next() {
                Next::Over => break,
                Next::Wants(wanted) => wanted.clamp(1, PIECE),
                Next::Fails(error) => return self.ends(&error),
                Next::Record(opcode) => {
                    self.any = true;
                    match message(opcode, &self.record) {
                        Ok(None) => continue,
                        Ok(Some(message)) => {
                            take(message);
                            return Ok(true);
                        }
                        Err(error) => return self.ends(&error),
                    }
                }
            };
            let piece = self.reader.insert(wanted);
            let read = self.file.read(piece).map_err(FileProblem::Read)?;
            self.reader.notify_read(read);
            self.read += read as u64;
        }
        self.is_over = true;
        Ok(false)
    }

    /// The next record, its bytes copied if it is one that matters here. The library takes some contradictions of a damaged chunk for a mistake of
    /// its own and panics, where arithmetic is checked; nothing is read on after that.
    fn next(&mut self) -> Next {
        use ::mcap::records::op;
        let Self { reader, record, .. } = self;
        let next = || match reader.next_event() {
            None => Next::Over,
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => Next::Wants(wanted),
            Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                record.clear();
                if matches!(opcode, op::MESSAGE | op::SCHEMA | op::CHANNEL) {
                    record.extend_from_slice(data);
                }
                Next::Record(opcode)
            }
            Some(Err(error)) => Next::Fails(error),
        };
        catch_unwind(AssertUnwindSafe(next)).unwrap_or(Next::Fails(McapError::UnexpectedEoc))
    }

    fn ends(&mut self, error: &McapError) -> Result<bool, Problem> {
        self.is_over = true;
        if !self.any {
            return Err(format!(
                "it does not begin as an MCAP file ({error}), expected one as ROS 2, Foxglove or this program record it"
            )
            .into());
        }
        let place = self.read;
        self.ended = Some(match error {
            McapError::UnexpectedEof => "the file is cut off; what is whole was read".to_owned(),
            other => format!("the file is damaged near byte {place} ({other}); what comes before was read"),
        });
        Ok(false)
    }

    /// Share of the file that has been read, 0 to 1.
    pub(crate) fn progress(&self) -> f64 {
        (self.read as f64 / self.bytes.max(1) as f64).min(1.0)
    }

    pub(crate) fn repairs(&self) -> Vec<String> {
        self.ended.iter().cloned().collect()
    }
}

/// Content of a record, if it is of a relevant kind.
fn message(opcode: u8, data: &[u8]) -> Result<Option<Message<'_>>, McapError> {
    use ::mcap::records::op;
    match opcode {
        // Parsed in place: a message is most of a file.
        op::MESSAGE => {
            let Some((head, bytes)) = data.split_at_checked(22) else { return Err(McapError::UnexpectedEof) };
            let number = |from: usize, to: usize| {
                head[from..to].iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte))
            };
            let (channel, log_ns, published_ns) = (number(0, 2) as u16, number(6, 14), number(14, 22));
            Ok((bytes.len() <= LONGEST_MESSAGE).then_some(Message::Data {
                channel,
                log_ns,
                published_ns,
                bytes,
            }))
        }
        op::SCHEMA | op::CHANNEL if !names_fit(opcode, data) => Err(McapError::UnexpectedEof),
        op::SCHEMA | op::CHANNEL => Ok(match ::mcap::parse_record(opcode, data)? {
            Record::Schema { header, data } => {
                let records::SchemaHeader { id, name, encoding } = header;
                Some(Message::Schema { id, name, encoding, text: data.into_owned() })
            }
            Record::Channel(channel) => Some(Message::Channel(channel)),
            _ => None,
        }),
        _ => Ok(None),
    }
}

/// Whether the names of a schema or a channel, each after its length, end within the record, those of a channel's metadata included: the
/// library takes as much memory as the lengths say before it looks.
fn names_fit(opcode: u8, data: &[u8]) -> bool {
    let is_channel = opcode == records::op::CHANNEL;
    let after_names = || {
        let rest = data.get(if is_channel { 4 } else { 2 }..)?;
        after_name(after_name(rest)?)
    };
    let metadata_fits = |rest: &[u8]| {
        let (length, mut rest) = rest.split_first_chunk::<4>()?;
        let end = rest.len().checked_sub(u32::from_le_bytes(*length) as usize)?;
        while rest.len() > end {
            rest = after_name(rest)?;
        }
        Some(())
    };
    after_names().is_some_and(|rest| !is_channel || metadata_fits(rest).is_some())
}

fn after_name(bytes: &[u8]) -> Option<&[u8]> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    rest.get(u32::from_le_bytes(*length) as usize..)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::mcap::records::op;

    #[test]
    fn a_name_that_is_longer_than_its_record_ends_the_file() {
        let channel = |topic_bytes: u32, value_bytes: u32| {
            let mut bytes = vec![1, 0, 0, 0];
            bytes.extend(topic_bytes.to_le_bytes());
            bytes.extend(*b"speed");
            bytes.extend(4u32.to_le_bytes());
            bytes.extend(*b"json");
            bytes.extend(10u32.to_le_bytes());
            bytes.extend(1u32.to_le_bytes());
            bytes.extend(*b"k");
            bytes.extend(value_bytes.to_le_bytes());
            bytes.extend(*b"v");
            bytes
        };
        assert!(
            matches!(message(op::CHANNEL, &channel(5, 1)), Ok(Some(Message::Channel(channel))) if channel.topic == "speed")
        );
        for (topic, value) in [(u32::MAX, 1), (1 << 20, 1), (28, 1), (5, u32::MAX), (5, 2)] {
            let read = message(op::CHANNEL, &channel(topic, value)).map(|_| ());
            assert!(matches!(read, Err(McapError::UnexpectedEof)), "{topic} {value}");
        }
        assert!(matches!(message(op::CHANNEL, &[1, 0, 0]), Err(McapError::UnexpectedEof)));
        assert!(matches!(message(op::SCHEMA, &[1, 0, 255, 255, 255, 255]), Err(McapError::UnexpectedEof)));
    }
}
