//! MCAP out: messages in JSON with their JSON Schema, in chunks with an index, as Foxglove and PlotJuggler open them.
//!
//! Called by the writers of drive logs and results beside it and by the live monitor. Knows fields and topics, not what they mean.
//! In memory is one chunk, a megabyte, and what the index holds of each that was written, less than a kB.

mod log;
mod results;
mod rows;
mod schema;

use std::io::{self, Write};

use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{Compression, McapError, WriteOptions};
use serde_json::{Map, Value};

pub(super) use log::McapLog;
pub use results::McapResults;
pub use rows::RowTopics;
pub use schema::{FieldType, alert_fields};

/// Messages that go to a file or a pipe.
pub struct McapWriter<W: Write> {
    writer: ::mcap::Writer<NoSeek<W>>,
    /// When time 0 was, in ns since 1970.
    start_ns: i128,
    has_messages: bool,
    message: Vec<u8>,
}

impl<W: Write> std::fmt::Debug for McapWriter<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("McapWriter").field("start_ns", &self.start_ns).finish_non_exhaustive()
    }
}

#[derive(Debug)]
pub struct Topic {
    channel: u16,
    messages: u32,
}

impl<W: Write> McapWriter<W> {
    pub fn new(target: W) -> io::Result<Self> {
        let options = WriteOptions::new()
            .library(concat!("itpms ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .disable_seeking(true);
        let writer = options.create(NoSeek::new(target)).map_err(io_error)?;
        Ok(Self { writer, start_ns: 0, has_messages: false, message: Vec::new() })
    }

    /// Says when time 0 was, in ns since 1970, before the first message. Unless it is given, times count from 1970 as they are.
    pub fn set_start_ns(&mut self, start_ns: u64) {
        self.start_ns = start_ns.into();
    }

    /// Adds a topic, whose messages have these fields besides `time_s`.
    pub fn add_topic(
        &mut self,
        name: &str,
        fields: impl IntoIterator<Item = (String, FieldType)>,
    ) -> io::Result<Topic> {
        let title = schema::title(name);
        let schema = schema::of(&title, fields).to_string();
        let schema = self.writer.add_schema(&title, "jsonschema", schema.as_bytes()).map_err(io_error)?;
        let channel = self.writer.add_channel(schema, name, "json", &Default::default());
        Ok(Topic { channel: channel.map_err(io_error)?, messages: 0 })
    }

    /// Adds a message. Null fields are left out: JSON has no NaN, and readers take a null for anything.
    pub fn write(
        &mut self,
        topic: &mut Topic,
        time_s: f64,
        mut object: Map<String, Value>,
    ) -> io::Result<()> {
        object.retain(|_, value| !value.is_null());
        object.insert("time_s".to_owned(), Value::from(time_s));
        self.write_message(topic, time_s, |out| Ok(serde_json::to_writer(out, &object)?))
    }

    /// Adds the message that `write` makes.
    fn write_message(
        &mut self,
        topic: &mut Topic,
        time_s: f64,
        write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>,
    ) -> io::Result<()> {
        self.message.clear();
        write(&mut self.message)?;
        let time_ns = self.time_ns(time_s);
        let header = MessageHeader {
            channel_id: topic.channel,
            sequence: topic.messages,
            log_time: time_ns,
            publish_time: time_ns,
        };
        topic.messages = topic.messages.wrapping_add(1);
        self.writer.write_to_known_channel(&header, &self.message).map_err(io_error)
    }

    /// The time as the format has it, which knows none before 1970: where the first message is before, it is at 0.
    fn time_ns(&mut self, time_s: f64) -> u64 {
        let since_ns = (time_s * 1e9).round() as i128;
        if !self.has_messages {
            self.has_messages = true;
            self.start_ns = self.start_ns.max(-since_ns);
        }
        (self.start_ns + since_ns).clamp(0, u64::MAX.into()) as u64
    }

    /// Ends the chunk, so that whoever reads the growing file finds everything written so far.
    pub fn flush(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(io_error)
    }

    /// Writes the index and gives back what was written to.
    pub fn finish(mut self) -> io::Result<W> {
        self.writer.finish().map_err(io_error)?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// An I/O error keeps its own words ("No space left on device").
fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
