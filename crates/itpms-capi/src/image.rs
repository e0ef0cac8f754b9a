//! Bytes that are to be found whole: what they are, of which version, how many, and a checksum over all of that.
//!
//! Little-endian: 4 bytes of kind, `u32` format, `u32` length of the body, `u32` CRC-32 (IEEE 802.3) of the first twelve and the body.

use serde::{Deserialize, Serialize};

use crate::itpms_real;
use crate::status::itpms_status;

/// Bytes before the body.
pub(crate) const HEADER: usize = 16;

/// What an image holds.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    name: [u8; 4],
    format: u32,
}

impl Kind {
    /// The bytes of a scalar tell an image of one precision from one of the other.
    pub(crate) const fn new(letter: u8, format: u32) -> Self {
        Self { name: [b'I', b'T', letter, b'0' + size_of::<itpms_real>() as u8], format }
    }
}

/// Writes a value as an image; gives the bytes it takes.
pub(crate) fn save(kind: Kind, value: &impl Serialize, bytes: &mut [u8]) -> Result<usize, itpms_status> {
    let body = postcard::to_slice(value, body(bytes)?).map_err(|_| itpms_status::TooSmall)?.len();
    seal(kind, bytes, body)
}

/// The value that an image of this kind holds.
pub(crate) fn load<'a, X: Deserialize<'a>>(kind: Kind, bytes: &'a [u8]) -> Result<X, itpms_status> {
    postcard::from_bytes(open(kind, bytes)?).map_err(|_| itpms_status::OtherFormat)
}

/// The body's place in memory that is to hold an image.
fn body(bytes: &mut [u8]) -> Result<&mut [u8], itpms_status> {
    bytes.get_mut(HEADER..).ok_or(itpms_status::TooSmall)
}

/// Writes the header of a body that lies in its place; gives the bytes of the image.
fn seal(kind: Kind, bytes: &mut [u8], body: usize) -> Result<usize, itpms_status> {
    let length = u32::try_from(body).map_err(|_| itpms_status::TooSmall)?;
    let (header, rest) = bytes.split_first_chunk_mut::<HEADER>().ok_or(itpms_status::TooSmall)?;
    let body = rest.get(..body).ok_or(itpms_status::TooSmall)?;
    let words = [kind.format.to_le_bytes(), length.to_le_bytes()];
    let [format, length] = words;
    let crc = crc32(&[&kind.name, &format, &length, body]).to_le_bytes();
    for (place, word) in header.chunks_exact_mut(4).zip([kind.name, format, length, crc]) {
        place.copy_from_slice(&word);
    }
    Ok(HEADER + body.len())
}

/// The body of an image of this kind.
fn open(kind: Kind, bytes: &[u8]) -> Result<&[u8], itpms_status> {
    let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or(itpms_status::Damaged)?;
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = *header;
    let (name, format, length) = ([a, b, c, d], [e, f, g, h], [i, j, k, l]);
    if name != kind.name {
        return Err(itpms_status::OtherFormat);
    }
    let body = usize::try_from(u32::from_le_bytes(length)).ok().and_then(|length| rest.get(..length));
    let body = body.ok_or(itpms_status::Damaged)?;
    if crc32(&[&name, &format, &length, body]) != u32::from_le_bytes([m, n, o, p]) {
        return Err(itpms_status::Damaged);
    }
    if u32::from_le_bytes(format) != kind.format {
        return Err(itpms_status::OtherFormat);
    }
    Ok(body)
}

/// CRC-32 as in IEEE 802.3, bit by bit: no table in flash.
fn crc32(parts: &[&[u8]]) -> u32 {
    let bytes = parts.iter().flat_map(|part| part.iter());
    !bytes.fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(crc & 1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: Kind = Kind { name: *b"TEST", format: 7 };

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        // The check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
        assert_eq!(crc32(&[b"1234", b"56789"]), 0xcbf4_3926);
    }

    #[test]
    fn an_image_is_found_whole_or_not_at_all() {
        let mut bytes = [0u8; HEADER + 5];
        body(&mut bytes).unwrap().copy_from_slice(b"hello");
        assert_eq!(seal(KIND, &mut bytes, 5), Ok(HEADER + 5));
        assert_eq!(open(KIND, &bytes), Ok(&b"hello"[..]));
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(open(KIND, &damaged).is_err(), "bit {bit}");
        }
        for length in 0..bytes.len() {
            assert_eq!(open(KIND, &bytes[..length]), Err(itpms_status::Damaged));
        }
        let other = Kind { format: 8, ..KIND };
        assert_eq!(open(other, &bytes), Err(itpms_status::OtherFormat));
        assert_eq!(seal(KIND, &mut bytes, 6), Err(itpms_status::TooSmall));
    }
}
