//! Compressed data blocks (DZ): unpacked, and turned back if they were transposed.
//!
//! Called by the data stream with a block's place; one block is in memory at a time, at most [`MOST_INFLATED`] bytes of
//! it, twice that while it is turned.

use flate2::{Decompress, FlushDecompress, Status};
use itpms_files::FileProblem;

use super::block::{BlockFile, FRAME, Fault, Frame};
use super::error::{Damage, Mdf4Problem};
use super::packed::{End, Method, unpack};

/// Contents of a compressed block in bytes. The standard asks writers for 4 MiB at most.
pub(super) const MOST_INFLATED: u64 = 64 << 20;

/// Bytes read from the file at a time.
const READ: usize = 64 << 10;

/// Result of a compressed block.
#[derive(Debug)]
pub(super) struct Inflated {
    /// Bytes that are missing in the buffer: all the block has, or those behind the point where the file ends.
    pub(super) lost: u64,
    pub(super) damage: Option<Damage>,
}

/// Header of a compressed block (DZBLOCK, behind the frame).
#[derive(Debug, Clone, Copy)]
pub(super) struct Zipped {
    method: Method,
    transposed: bool,
    /// Bytes of a row before it was transposed.
    columns: usize,
    /// Bytes once inflated.
    pub(super) original: u64,
    stored: u64,
    from: u64,
}

impl Zipped {
    /// Reads what stands before the compressed bytes of the block at `at`.
    pub(super) fn read(
        file: &mut BlockFile,
        at: u64,
        frame: Frame,
    ) -> Result<Result<Self, Damage>, Mdf4Problem> {
        let damaged = |found: &str| Ok(Err(Damage::new("compressed block", at, found)));
        let header = Frame { length: FRAME + 24, links: 0, ..frame };
        if frame.length < header.length {
            return damaged("too short for one");
        }
        let block = match file.contents("compressed block", at, header, 24) {
            Ok(block) => block,
            Err(fault) => return Ok(Err(Fault::damage(fault)?)),
        };
        let Some((method, transposed)) = Method::of(block.u8(2)) else {
            return Err(Mdf4Problem::Compression { at, found: block.u8(2) });
        };
        let zipped = Self {
            method,
            transposed,
            columns: block.u32(4) as usize,
            original: block.u64(8),
            stored: block.u64(16).min(frame.length - header.length),
            from: at + header.length,
        };
        let most = MOST_INFLATED;
        if zipped.original > most {
            return Err(Mdf4Problem::BlockLength { at, found: zipped.original, most });
        }
        if zipped.transposed && zipped.columns == 0 {
            return damaged("transposed with rows of 0 bytes");
        }
        Ok(Ok(zipped))
    }

    /// Fills `buffer` with the block's contents; `spare` is memory for turning them.
    pub(super) fn inflate(
        &self,
        file: &mut BlockFile,
        buffer: &mut Vec<u8>,
        spare: &mut Vec<u8>,
    ) -> Result<Inflated, Mdf4Problem> {
        let at = self.from - FRAME - 24;
        let found = match self.method {
            Method::Deflate => self.inflate_raw(file, buffer)?,
            Method::Zstd | Method::Lz4 => {
                buffer.clear();
                unpack(file, (self.from, self.stored), self.method, buffer, MOST_INFLATED)
                    .map_err(FileProblem::Read)?
            }
        };
        let damage = |found: String| Some(Damage::new("compressed block", at, found));
        let original = self.original;
        let inflated = match found {
            // A check sum that fits is worth more than a length that does not.
            End::Complete => {
                let length = buffer.len() as u64;
                let wrong = length != original;
                Inflated {
                    lost: 0,
                    damage: wrong
                        .then(|| damage(format!("has {length} bytes of contents, claims {original}")))
                        .flatten(),
                }
            }
            // Rows of a transposed block are complete only at its end.
            End::Cut if self.transposed => {
                buffer.clear();
                Inflated { lost: original, damage: damage("cut off; it is left out".to_owned()) }
            }
            End::Cut => {
                buffer.truncate(original as usize);
                let lost = original - buffer.len() as u64;
                Inflated {
                    lost,
                    damage: damage(format!("cut off, {} of {original} bytes can be read", buffer.len())),
                }
            }
            End::TooLong => {
                buffer.clear();
                let most = MOST_INFLATED;
                return Err(Mdf4Problem::BlockLength { at, found: most + 1, most });
            }
            End::Broken => {
                buffer.clear();
                Inflated { lost: original, damage: damage("cannot be unpacked; it is left out".to_owned()) }
            }
        };
        if self.transposed {
            turn_back(buffer, spare, self.columns);
        }
        Ok(inflated)
    }

    fn inflate_raw(&self, file: &mut BlockFile, buffer: &mut Vec<u8>) -> Result<End, Mdf4Problem> {
        let mut inflater = Decompress::new(true);
        buffer.clear();
        // The claimed size is believed as far as deflate can reach from the bytes that are there.
        let reach = self.stored.saturating_mul(1032).saturating_add(64);
        buffer.reserve(self.original.min(reach) as usize + 64);
        let there = file.length().saturating_sub(self.from).min(self.stored);
        let mut chunk = vec![0; READ.min(there as usize)];
        let mut unused = 0..0;
        let mut read = 0;
        loop {
            if unused.is_empty() && read < there {
                let length = chunk.len().min((there - read) as usize);
                file.read(self.from + read, &mut chunk[..length]).map_err(FileProblem::Read)?;
                (unused, read) = (0..length, read + length as u64);
            }
            if buffer.len() as u64 > MOST_INFLATED {
                return Ok(End::TooLong);
            }
            if buffer.len() == buffer.capacity() {
                buffer.reserve(READ);
            }
            let before = (inflater.total_in(), buffer.len());
            match inflater.decompress_vec(&chunk[unused.clone()], buffer, FlushDecompress::None) {
                Err(_) => return Ok(End::Broken),
                Ok(Status::StreamEnd) => return Ok(End::Complete),
                Ok(_) => {}
            }
            if before == (inflater.total_in(), buffer.len()) {
                // It waits for bytes that are not there.
                return Ok(if there < self.stored { End::Cut } else { End::Broken });
            }
            unused.start += (inflater.total_in() - before.0) as usize;
        }
    }
}

/// The inverse of the transposition: the bytes of all rows' first column come first, then those of the second. What is
/// left of an incomplete last row stands behind as it is (ASAM MDF 4.1, DZBLOCK, `dz_zip_parameter`).
fn turn_back(buffer: &mut Vec<u8>, spare: &mut Vec<u8>, columns: usize) {
    /// A square of this size stays in the processor's first cache.
    const TILE: usize = 64;
    let rows = buffer.len() / columns;
    let whole = rows * columns;
    spare.clear();
    spare.resize(whole, 0);
    for first_row in (0..rows).step_by(TILE) {
        let some_rows = first_row..rows.min(first_row + TILE);
        for first_column in (0..columns).step_by(TILE) {
            for column in first_column..columns.min(first_column + TILE) {
                let values = &buffer[column * rows..][some_rows.clone()];
                let targets = spare[first_row * columns + column..].iter_mut().step_by(columns);
                for (target, value) in targets.zip(values) {
                    *target = *value;
                }
            }
        }
    }
    spare.extend_from_slice(&buffer[whole..]);
    std::mem::swap(buffer, spare);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn turning_back_undoes_the_transposition(
            bytes in prop::collection::vec(any::<u8>(), 0..2000), columns in 1usize..150,
        ) {
            let rows = bytes.len() / columns;
            let mut turned: Vec<u8> =
                (0..columns).flat_map(|column| (0..rows).map(move |row| row * columns + column)).map(|i| bytes[i]).collect();
            turned.extend(&bytes[rows * columns..]);
            turn_back(&mut turned, &mut Vec::new(), columns);
            prop_assert_eq!(turned, bytes);
        }
    }
}
