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
