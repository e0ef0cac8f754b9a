//! Frames as a BLF file. Called by `FrameWriter`, which has looked at the times.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use itpms_files::{AtomicFile, FileError, FileProblem};

use super::header::{self, Summary};
use super::{BASE_HEADER, SIGNATURE, kind, object};
use crate::frame::CanFrame;

/// Uncompressed bytes of a container, as in Vector's programs.
const CONTAINER_BYTES: usize = 1 << 17;

/// Writes objects into containers of zlib, as they come.
#[derive(Debug, Default)]
pub(crate) struct BlfWriter {
    /// The log's beginning in whole s since 1970, from the first frame.
    start_s: Option<f64>,
    stop_s: f64,
    objects: u32,
    /// Objects that are in no container yet.
    buffer: Vec<u8>,
    file_bytes: u64,
    uncompressed_bytes: u64,
}

impl BlfWriter {
    /// Adds a frame. One that is older than the log's beginning gets stamp 0: the format knows no negative ones.
    pub(crate) fn write(&mut self, file: &mut AtomicFile, frame: &CanFrame) -> Result<(), FileError> {
        if self.file_bytes == 0 {
            self.begin(file)?;
        }
        let start_s = *self.start_s.get_or_insert(frame.time_s.floor());
        self.stop_s = self.stop_s.max(frame.time_s);
        self.objects = self.objects.saturating_add(1);
        let stamp_ns = ((frame.time_s - start_s).max(0.0) * 1e9).round() as u64;
        object::push(&mut self.buffer, frame, stamp_ns);
        while self.buffer.len() >= CONTAINER_BYTES {
            self.flush(file)?;
        }
        Ok(())
    }

    /// Ends the log: the last container, and the sums in the header (a pipe keeps the header without them).
    pub(crate) fn finish(&mut self, file: &mut AtomicFile) -> Result<(), FileError> {
        if self.file_bytes == 0 {
            self.begin(file)?;
        }
        if !self.buffer.is_empty() {
            self.flush(file)?;
        }
        if file.is_device() { Ok(()) } else { file.replace(0, &self.summary().to_bytes()) }
    }

    fn summary(&self) -> Summary {
        Summary {
            file_bytes: self.file_bytes,
            uncompressed_bytes: self.uncompressed_bytes,
            objects: self.objects,
            start_s: self.start_s.unwrap_or(0.0) as i64,
            stop_ms: (self.stop_s * 1000.0) as i64,
        }
    }

    fn begin(&mut self, file: &mut AtomicFile) -> Result<(), FileError> {
        self.file_bytes = header::SIZE as u64;
        self.uncompressed_bytes = header::SIZE as u64;
        file.append(&self.summary().to_bytes())
    }

    /// Puts the oldest bytes into a container; an object may be split.
    fn flush(&mut self, file: &mut AtomicFile) -> Result<(), FileError> {
        let whole = self.buffer.len().min(CONTAINER_BYTES);
        let fail = |error| FileError::new(file.target(), FileProblem::Write(error));
        let mut encoder = ZlibEncoder::new(Vec::with_capacity(whole / 4), Compression::default());
        encoder.write_all(self.buffer.get(..whole).unwrap_or_default()).map_err(fail)?;
        let data = encoder.finish().map_err(fail)?;
        let size = BASE_HEADER + 16 + data.len();
        let mut head = Vec::with_capacity(BASE_HEADER + 16);
        head.extend_from_slice(SIGNATURE);
        head.extend_from_slice(&(BASE_HEADER as u16).to_le_bytes());
        head.extend_from_slice(&1_u16.to_le_bytes());
        head.extend_from_slice(&(size as u32).to_le_bytes());
        head.extend_from_slice(&kind::LOG_CONTAINER.to_le_bytes());
        head.extend_from_slice(&[2, 0, 0, 0, 0, 0, 0, 0]);
        head.extend_from_slice(&(whole as u32).to_le_bytes());
        head.extend_from_slice(&[0; 4]);
        file.append(&head)?;
        file.append(&data)?;
        // The format pads by the size modulo four, not up to the next multiple.
        let padding = size % 4;
        file.append([0; 4].get(..padding).unwrap_or_default())?;
        self.file_bytes += (size + padding) as u64;
        self.uncompressed_bytes += (BASE_HEADER + 16 + whole) as u64;
        self.buffer.drain(..whole);
        Ok(())
    }
}
