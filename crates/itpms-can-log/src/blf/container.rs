//! The file level of BLF: containers and what stands between them, as pieces of the stream of objects. Called by the
//! reader beside it; knows nothing of frames.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};

use flate2::{Decompress, FlushDecompress, Status};

use super::bytes::{u16_at, u32_at};
use super::{BASE_HEADER, SIGNATURE, kind, object};
use crate::repairs::{FramePlace, FrameRepairs};

/// Bytes between objects, at most: three of padding, by some programs the same again.
pub(super) const MOST_PADDING: u64 = 7;

/// Largest container that is read, compressed as well as not.
pub(super) const MOST_BYTES: usize = 16 << 20;

/// Bytes of a container before its data.
const CONTAINER_HEADER: usize = BASE_HEADER + 16;

const AS_IT_IS: u16 = 0;
const ZLIB: u16 = 2;

/// A piece of the stream of objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    /// A container's contents; they go on where the container before ended.
    Container,
    /// The same, but something before it is missing.
    AfterGap,
    /// An object outside of containers.
    Object,
    /// Nothing more.
    End,
}

#[derive(Debug)]
pub(super) struct Containers {
    input: BufReader<File>,
    /// Bytes of the file consumed.
    pub(super) position: u64,
    bytes: u64,
    /// Something is missing since the last piece.
    gap: bool,
    compressed: Vec<u8>,
    /// Kept from container to container: making one costs more than a small container.
    inflater: Decompress,
}

impl Containers {
    /// Reads from `position`, where `file` stands.
    pub(super) fn new(file: File, position: u64, bytes: u64) -> Self {
        Self {
            input: BufReader::with_capacity(1 << 16, file),
            position,
            bytes,
            gap: false,
            compressed: Vec::new(),
            inflater: Decompress::new(true),
        }
    }

    /// How much of the file has been read, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        (self.position as f64 / self.bytes.max(1) as f64).min(1.0)
    }

    /// The next piece, in place of the content of `out`.
    pub(super) fn next(&mut self, out: &mut Vec<u8>, repairs: &mut FrameRepairs) -> io::Result<Piece> {
        loop {
            out.clear();
            let begin = self.position;
            let is_found = self.skip_to_signature()?;
            if self.position - begin > MOST_PADDING {
                self.strange(begin, "bytes of no object".to_owned(), "LOBJ", repairs);
            }
            if !is_found {
                return Ok(Piece::End);
            }
            let at = self.position;
            let mut header = [0; CONTAINER_HEADER];
            header[..4].copy_from_slice(SIGNATURE);
            self.position += 4;
            if !self.fill(&mut header[4..BASE_HEADER])? {
                repairs.cut_off = Some(FramePlace::Byte(at));
                return Ok(Piece::End);
            }
            let size = u32_at(&header, 8).unwrap_or(0) as usize;
            let object_type = u32_at(&header, 12).unwrap_or(0);
            let piece = if object_type == kind::LOG_CONTAINER {
                self.container(at, size, &mut header, out, repairs)?
            } else {
                self.outside(at, size, object_type, &header, out, repairs)?
            };
            if let Some(piece) = piece {
                return Ok(piece);
            }
        }
    }

    /// Leaves out something that cannot be read.
    fn strange(&mut self, at: u64, found: String, expected: &'static str, repairs: &mut FrameRepairs) {
        self.gap = true;
        repairs.not_understood(FramePlace::Byte(at), found, expected);
    }

    /// Goes to the next signature and past it, without counting it; false at the end of the file.
    fn skip_to_signature(&mut self) -> io::Result<bool> {
        let mut matched = 0;
        let mut skipped = 0_u64;
        loop {
            let ahead = self.input.fill_buf()?;
            if ahead.is_empty() {
                self.position += skipped + matched as u64;
                return Ok(false);
            }
            let mut used = 0;
            for byte in ahead {
                used += 1;
                if *byte == SIGNATURE[matched] {
                    matched += 1;
                    if matched == SIGNATURE.len() {
                        break;
                    }
                } else {
                    // No part of the signature is its beginning again, but this byte may be.
                    skipped += matched as u64;
                    matched = usize::from(*byte == SIGNATURE[0]);
                    skipped += u64::from(matched == 0);
                }
            }
            self.input.consume(used);
            if matched == SIGNATURE.len() {
                self.position += skipped;
                return Ok(true);
            }
        }
    }

    /// Fills the whole buffer; false if the file ends before.
    fn fill(&mut self, buffer: &mut [u8]) -> io::Result<bool> {
        let mut filled = 0;
        while let Some(rest) = buffer.get_mut(filled..).filter(|rest| !rest.is_empty()) {
            match self.input.read(rest) {
                Ok(0) => return Ok(false),
                Ok(count) => {
                    filled += count;
                    self.position += count as u64;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(true)
    }

    /// The contents of a container at `at`; `None` if there are none.
    fn container(
        &mut self,
        at: u64,
        size: usize,
        header: &mut [u8; CONTAINER_HEADER],
        out: &mut Vec<u8>,
        repairs: &mut FrameRepairs,
    ) -> io::Result<Option<Piece>> {
        let place = FramePlace::Byte(at);
        if !(CONTAINER_HEADER..=MOST_BYTES).contains(&size) {
            let found = format!("a container of {size} bytes");
            self.strange(at, found, "32 bytes to 16 MiB", repairs);
            return Ok(None);
        }
        if !self.fill(&mut header[BASE_HEADER..])? {
            repairs.cut_off = Some(place);
            return Ok(Some(Piece::End));
        }
        let method = u16_at(header, BASE_HEADER).unwrap_or(0);
        let whole = u32_at(header, BASE_HEADER + 8).unwrap_or(0) as usize;
        let left = usize::try_from(self.bytes.saturating_sub(self.position)).unwrap_or(usize::MAX);
        let wanted = size - CONTAINER_HEADER;
        let is_cut = wanted > left;
        let had_gap = std::mem::take(&mut self.gap);
        let mut compressed = std::mem::take(&mut self.compressed);
        compressed.resize(wanted.min(left), 0);
        self.fill(&mut compressed)?;
        let ended = match method {
            AS_IT_IS => {
                out.extend_from_slice(&compressed);
                Ended { used: compressed.len(), is_whole: !is_cut }
            }
            ZLIB if is_nothing(&compressed) => Ended { used: compressed.len(), is_whole: !is_cut },
            ZLIB => inflate(&mut self.inflater, &compressed, whole, out),
            _ => {
                let found = format!("a container compressed with method {method}");
                self.strange(at, found, "0 (not) or 2 (zlib)", repairs);
                Ended { used: compressed.len(), is_whole: true }
            }
        };
        if is_cut && ended.is_whole {
            // The stream has its end before the file's: the size was wrong, and objects may follow.
            let back = compressed.len() - ended.used;
            self.input.seek_relative(-(back as i64))?;
            self.position -= back as u64;
            repairs.not_understood(
                place,
                format!("a container of {size} bytes"),
                "one that ends within the file",
            );
        } else if is_cut {
            repairs.cut_off = Some(place);
        } else if !ended.is_whole || (method == ZLIB && out.len() != whole) {
            let found = format!("a container of which {} of {whole} bytes can be read", out.len());
            self.strange(at, found, "all of them", repairs);
        }
        self.compressed = compressed;
        Ok(Some(if had_gap { Piece::AfterGap } else { Piece::Container }))
    }

    /// An object outside of containers; `None` if it is not one of ours.
    fn outside(
        &mut self,
        at: u64,
        size: usize,
        object_type: u32,
        header: &[u8; CONTAINER_HEADER],
        out: &mut Vec<u8>,
        repairs: &mut FrameRepairs,
    ) -> io::Result<Option<Piece>> {
        let is_frame = object::is_frame(object_type);
        let left = self.bytes.saturating_sub(self.position);
        let rest = (size as u64).saturating_sub(BASE_HEADER as u64);
        if size < BASE_HEADER || (is_frame && size > object::MOST_FRAME_BYTES) {
            let found = format!("an object of {size} bytes");
            self.strange(at, found, "the size of an object", repairs);
            return Ok(None);
        }
        if rest > left {
            repairs.cut_off = Some(FramePlace::Byte(at));
            return Ok(None);
        }
        if is_frame {
            out.extend_from_slice(&header[..BASE_HEADER]);
            out.resize(size, 0);
            self.fill(&mut out[BASE_HEADER..])?;
            return Ok(Some(Piece::Object));
        }
        self.input.seek_relative(rest as i64)?;
        self.position += rest;
        repairs.passed_over += 1;
        Ok(None)
    }
}

/// Whether a stream of zlib is the shortest that holds nothing, of deflate's fixed or stored kind: inflating it takes longer than
/// a small container does.
fn is_nothing(stream: &[u8]) -> bool {
    matches!(stream.get(2..), Some([0x03, 0x00, 0, 0, 0, 1] | [0x01, 0x00, 0x00, 0xff, 0xff, 0, 0, 0, 1]))
}

/// How a container's data ended.
#[derive(Debug, Clone, Copy)]
struct Ended {
    /// Bytes of input used.
    used: usize,
    /// The stream came to its own end.
    is_whole: bool,
}

/// Inflates as far as it goes, up to [`MOST_BYTES`]. `whole` is what the container says it has.
fn inflate(state: &mut Decompress, input: &[u8], whole: usize, out: &mut Vec<u8>) -> Ended {
    const STEP: usize = 1 << 16;
    state.reset(true);
    loop {
        if out.len() == out.capacity() {
            // The container's stated size is believed as far as deflate can reach: 1032 bytes from one.
            let expected = whole.min(input.len().saturating_mul(1032)).saturating_sub(out.len());
            let more = expected.max(out.len()).max(STEP).min(MOST_BYTES.saturating_sub(out.len()));
            out.reserve_exact(more);
        }
        let used = state.total_in() as usize;
        let before = (used, out.len());
        let status = state.decompress_vec(input.get(used..).unwrap_or_default(), out, FlushDecompress::None);
        let used = state.total_in() as usize;
        match status {
            Ok(Status::StreamEnd) => return Ended { used, is_whole: true },
            Ok(_) if out.len() < MOST_BYTES && (used, out.len()) != before => {}
            Ok(_) if out.len() == out.capacity() && out.len() < MOST_BYTES => {}
            _ => return Ended { used, is_whole: false },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::ZlibEncoder;

    use super::*;

    fn deflated(data: &[u8]) -> Vec<u8> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn a_small_container_that_inflates_to_very_much_is_stopped() {
        let bomb = deflated(&vec![0; 3 * MOST_BYTES]);
        assert!(bomb.len() < 64 << 10);
        for claimed in [0, 1000, 3 * MOST_BYTES, u32::MAX as usize] {
            let mut out = Vec::new();
            let ended = inflate(&mut Decompress::new(true), &bomb, claimed, &mut out);
            assert!(!ended.is_whole);
            assert_eq!(out.len(), MOST_BYTES);
            assert!(out.capacity() <= MOST_BYTES);
        }
    }

    #[test]
    fn a_stream_of_nothing_is_known() {
        use flate2::Compression;
        for level in [0, 1, 6, 9] {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(level));
            encoder.write_all(&[]).unwrap();
            assert!(is_nothing(&encoder.finish().unwrap()), "level {level}");
        }
        assert!(!is_nothing(&deflated(&[0])) && !is_nothing(&[]));
    }

    #[test]
    fn what_is_there_of_a_cut_container_is_inflated() {
        // Numbers that do not compress, so that half the stream is half the data.
        let step = |state: &mut u64| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            Some((*state >> 56) as u8)
        };
        let data: Vec<u8> = std::iter::repeat_n((), 100_000).scan(1, |state, ()| step(state)).collect();
        let whole = deflated(&data);
        let mut out = Vec::new();
        let ended = inflate(&mut Decompress::new(true), &whole, data.len(), &mut out);
        assert!(ended.is_whole && ended.used == whole.len());
        assert_eq!(out, data);
        let mut half = Vec::new();
        let ended = inflate(&mut Decompress::new(true), &whole[..whole.len() / 2], data.len(), &mut half);
        assert!(!ended.is_whole);
        assert!(half.len() > data.len() / 3 && data.starts_with(&half));
        assert!(!inflate(&mut Decompress::new(true), &[], 10, &mut Vec::new()).is_whole);
    }
}
