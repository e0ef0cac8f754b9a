//! Compressed bytes of a file, whatever the method: deflate, and zstd and lz4 of MDF 4.3.
//!
//! Called for data blocks and attachments; bounds what comes out, whatever the bytes claim of themselves.

use std::io::{self, BufReader, Read};

use flate2::read::ZlibDecoder;
use lz4_flex::frame::FrameDecoder;

use super::block::BlockFile;

/// Logarithm of the farthest that zstd may refer back to in bytes: as far as a block may be long.
const MOST_BACK: u32 = 26;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Deflate,
    Zstd,
    Lz4,
}

impl Method {
    /// The method with this number, and whether rows were transposed before (`dz_zip_type`); attachments have the same numbers.
    pub(super) fn of(zip_type: u8) -> Option<(Self, bool)> {
        let method = match zip_type / 2 {
            0 => Self::Deflate,
            1 => Self::Zstd,
            2 => Self::Lz4,
            _ => return None,
        };
        Some((method, zip_type % 2 == 1))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// With what the method ends with.
    Complete,
    /// With the file.
    Cut,
    /// Beyond all bounds.
    TooLong,
    /// With bytes that the method never writes, or another check sum.
    Broken,
}

/// Adds to `buffer` what `stored` bytes from `from` on hold, up to one byte more than `most`.
pub(super) fn unpack(
    file: &mut BlockFile,
    (from, stored): (u64, u64),
    method: Method,
    buffer: &mut Vec<u8>,
    most: u64,
) -> io::Result<End> {
    let there = file.length().saturating_sub(from).min(stored);
    let mut bytes = Stored { file, from, left: there, refused: None };
    let outcome = {
        let mut input = BufReader::new(&mut bytes);
        let mut unpacked: Box<dyn Read + '_> = match method {
            Method::Deflate => Box::new(ZlibDecoder::new(&mut input)),
            Method::Lz4 => Box::new(FrameDecoder::new(&mut input)),
            Method::Zstd => {
                let mut decoder = zstd::stream::read::Decoder::with_buffer(&mut input)?;
                decoder.window_log_max(MOST_BACK)?;
                Box::new(decoder)
            }
        };
        (&mut unpacked).take(most + 1).read_to_end(buffer)
    };
    if let Some(error) = bytes.refused {
        return Err(error);
    }
    Ok(match outcome {
        Ok(length) if length as u64 > most => End::TooLong,
        // What was there to read may end at a block's end, where the method sees no end of its own.
        Ok(_) if bytes.left > 0 || there == stored => End::Complete,
        Err(_) if there == stored => End::Broken,
        _ => End::Cut,
    })
}

struct Stored<'a> {
    file: &'a mut BlockFile,
    from: u64,
    left: u64,
    /// The system's error when reading failed.
    refused: Option<io::Error>,
}

impl Read for Stored<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let length = (bytes.len() as u64).min(self.left) as usize;
        if let Err(error) = self.file.read(self.from, &mut bytes[..length]) {
            self.refused = Some(error);
            return Err(io::ErrorKind::Other.into());
        }
        self.from += length as u64;
        self.left -= length as u64;
        Ok(length)
    }
}
