//! CRC-64/XZ: polynomial of ECMA-182, reflected, all ones before and after. Finds every damage of up to 64 neighboring
//! bits, and any other but for one in 10^19. It is no signature: who wants to forge a reference can.

/// ECMA-182 with its bits in reverse.
const POLYNOMIAL: u64 = 0xC96C_5795_D787_0F42;

/// The checksum of all parts, one after the other.
#[must_use]
pub fn crc64(parts: &[&[u8]]) -> u64 {
    let mut crc = u64::MAX;
    for byte in parts.iter().copied().flatten() {
        crc ^= u64::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ POLYNOMIAL } else { crc >> 1 };
        }
    }
    !crc
}

/// Why a sealed file is not opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unsealed {
    /// It begins otherwise: so.
    Foreign(String),
    /// Cut short, or changed since it was written.
    #[allow(missing_docs, reason = "the checksum in the first line, and that of the contents")]
    Damaged { found: String, expected: String },
}

/// The first line of a file: what it is, its format, and a checksum of the format and of the body below.
#[must_use]
pub fn seal(magic: &str, format: &str, body: &[u8]) -> String {
    format!("{magic}{format} {}\n", seal_of(format, body))
}

/// Format and body of a file that begins with such a line.
///
/// # Errors
/// It is another file, or damaged.
pub fn unsealed<'a>(magic: &str, bytes: &'a [u8]) -> Result<(String, &'a [u8]), Unsealed> {
    let Some(rest) = bytes.strip_prefix(magic.as_bytes()) else {
        let beginning = &bytes[..bytes.len().min(magic.len())];
        return Err(Unsealed::Foreign(String::from_utf8_lossy(beginning).into_owned()));
    };
    let end_of_line = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
    let (line, body) = (&rest[..end_of_line], rest.get(end_of_line + 1..).unwrap_or_default());
    let line = String::from_utf8_lossy(line);
    let (format, found) = line.split_once(' ').unwrap_or((&line, ""));
    let expected = seal_of(format, body);
    if found != expected {
        return Err(Unsealed::Damaged { found: found.to_owned(), expected });
    }
    Ok((format.to_owned(), body))
}

/// In lower-case digits.
fn seal_of(format: &str, body: &[u8]) -> String {
    format!("{:016x}", crc64(&[format.as_bytes(), b"\n", body]))
}

#[cfg(test)]
mod tests {
    use super::crc64;

    #[test]
    fn the_published_check_value() {
        // The digits 1 to 9, as every catalog of cyclic codes lists for CRC-64/XZ.
        assert_eq!(crc64(&[b"123456789"]), 0x995D_C9BB_DF19_39FA);
        assert_eq!(crc64(&[b"1234", b"", b"56789"]), 0x995D_C9BB_DF19_39FA);
    }
}
