//! From the bytes of a record to a number: where a channel lies, and how its bits are read.
//!
//! Called by the structure, which compiles channels into fields, and by the cursor, which reads them. Knows nothing of
//! conversions and of files.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Unsigned,
    Signed,
    Float,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    /// Not stored: the number of the record, from zero.
    Index,
    /// The two that nearly every channel is.
    Float64 {
        offset: usize,
    },
    Float32 {
        offset: usize,
    },
    /// Everything else.
    Bits(Bits),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Bits {
    offset: usize,
    /// Bytes touched, up to nine.
    bytes: usize,
    order: ByteOrder,
    /// Bits below the number, once the bytes are in order.
    shift: u32,
    /// Bits of the number, 1 to 64.
    count: u32,
    number: Number,
}

impl Field {
    /// A field in records of `record` bytes, or why it cannot be one.
    pub(super) fn new(
        number: Number,
        order: ByteOrder,
        byte_offset: u32,
        bit_offset: u8,
        bit_count: u32,
        record: u32,
    ) -> Result<Self, String> {
        let sizes_known = match number {
            Number::Float => matches!(bit_count, 16 | 32 | 64),
            _ => (1..=64).contains(&bit_count),
        };
        if !sizes_known || bit_offset > 7 {
            let what = if number == Number::Float { "floating-point number" } else { "integer" };
            return Err(format!("a {what} of {bit_count} bits at bit {bit_offset} of a byte"));
        }
        let bytes = (u32::from(bit_offset) + bit_count).div_ceil(8);
        if byte_offset.checked_add(bytes).is_none_or(|end| end > record) {
            return Err(format!("{bytes} bytes at byte {byte_offset} of a record of {record} bytes"));
        }
        let offset = byte_offset as usize;
        let plain = bit_offset == 0 && order == ByteOrder::LittleEndian && number == Number::Float;
        Ok(match bit_count {
            64 if plain => Field::Float64 { offset },
            32 if plain => Field::Float32 { offset },
            _ => Field::Bits(Bits {
                offset,
                bytes: bytes as usize,
                order,
                shift: u32::from(bit_offset),
                count: bit_count,
                number,
            }),
        })
    }

    /// The number in `record`, the `index`-th of its group; NaN if the record is shorter than the field reaches.
    #[inline]
    pub(super) fn read(&self, record: &[u8], index: u64) -> f64 {
        match self {
            Field::Index => index as f64,
            Field::Float64 { offset } => bytes(record, *offset).map_or(f64::NAN, f64::from_le_bytes),
            Field::Float32 { offset } => {
                bytes(record, *offset).map_or(f64::NAN, |bytes| f64::from(f32::from_le_bytes(bytes)))
            }
            Field::Bits(bits) => {
                record.get(bits.offset..bits.offset + bits.bytes).map_or(f64::NAN, |bytes| bits.read(bytes))
            }
        }
    }
}

#[inline]
fn bytes<const N: usize>(record: &[u8], offset: usize) -> Option<[u8; N]> {
    record.get(offset..offset + N).and_then(|bytes| bytes.try_into().ok())
}

impl Bits {
    fn read(&self, bytes: &[u8]) -> f64 {
        let append = |sum: u128, byte: &u8| sum << 8 | u128::from(*byte);
        let all = match self.order {
            ByteOrder::LittleEndian => bytes.iter().rev().fold(0, append),
            ByteOrder::BigEndian => bytes.iter().fold(0, append),
        };
        // Up to 72 bits; the shift leaves the wanted ones at the bottom.
        let raw = (all >> self.shift) as u64 & (u64::MAX >> (64 - self.count));
        match self.number {
            // Beyond 2^53 the nearest number.
            Number::Unsigned => raw as f64,
            Number::Signed => {
                let unused = 64 - self.count;
                ((raw << unused) as i64 >> unused) as f64
            }
            Number::Float => match self.count {
                16 => half(raw as u16),
                32 => f64::from(f32::from_bits(raw as u32)),
                _ => f64::from_bits(raw),
            },
        }
    }
}

/// IEEE 754 binary16: sign, five bits of exponent, ten of fraction.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    match exponent {
        0 => sign * fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        _ => sign * (1.0 + fraction) * 2f64.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(number: Number, order: ByteOrder, bit_offset: u8, bit_count: u32, record: &[u8]) -> f64 {
        Field::new(number, order, 0, bit_offset, bit_count, record.len() as u32).unwrap().read(record, 0)
    }

    #[test]
    fn bits_are_counted_from_the_least_after_the_bytes_are_in_order() {
        use {ByteOrder::*, Number::*};
        // 0x1234 at bit 4, 8 bits: 0x23 in both orders.
        assert_eq!(read(Unsigned, LittleEndian, 4, 8, &[0x34, 0x12]), f64::from(0x23));
        assert_eq!(read(Unsigned, BigEndian, 4, 8, &[0x12, 0x34]), f64::from(0x23));
        // Three bits 0b101 are 5, or -3 in two's complement.
        assert_eq!(read(Unsigned, LittleEndian, 2, 3, &[0b1_0100]), 5.0);
        assert_eq!(read(Signed, LittleEndian, 2, 3, &[0b1_0100]), -3.0);
        assert_eq!(read(Signed, BigEndian, 0, 64, &[0xff; 8]), -1.0);
        // Sixty-four bits across nine bytes.
        assert_eq!(
            read(Unsigned, LittleEndian, 4, 64, &[0xf0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x0f]),
            2f64.powi(64)
        );
    }

    #[test]
    fn halves_are_those_of_the_standard() {
        let cases = [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 2f64.powi(-24)),
            (0x0400, 2f64.powi(-14)),
            (0x3555, 0.333_251_953_125),
            (0x7c00, f64::INFINITY),
            (0x8000, 0.0),
        ];
        for (bits, value) in cases {
            assert_eq!(half(bits), value, "{bits:#06x}");
        }
        assert!(half(0x7e00).is_nan());
    }

    #[test]
    fn a_field_outside_its_record_or_of_impossible_size_is_refused() {
        use {ByteOrder::*, Number::*};
        assert!(Field::new(Unsigned, LittleEndian, 3, 1, 8, 4).is_err());
        assert!(Field::new(Unsigned, LittleEndian, u32::MAX, 0, 8, 4).is_err());
        assert!(Field::new(Unsigned, LittleEndian, 0, 0, 65, 20).is_err());
        assert!(Field::new(Unsigned, LittleEndian, 0, 0, 0, 20).is_err());
        assert!(Field::new(Float, LittleEndian, 0, 0, 24, 20).is_err());
        assert!(Field::new(Float, LittleEndian, 0, 8, 32, 20).is_err());
        // A record that is shorter than it was when the field was made.
        assert!(Field::new(Float, LittleEndian, 0, 0, 64, 8).unwrap().read(&[0; 7], 0).is_nan());
    }

    proptest! {
        /// Writing bit by bit, as the standard's pictures do, is the inverse of reading.
        #[test]
        fn what_is_written_bit_by_bit_is_read(
            value: u64, offset in 0u8..8, count in 1u32..=64, big: bool, noise: [u8; 9],
        ) {
            let value = value & (u64::MAX >> (64 - count));
            let bytes = (usize::from(offset) + count as usize).div_ceil(8);
            let mut record = noise[..bytes].to_vec();
            for bit in 0..count as usize {
                let at = usize::from(offset) + bit;
                let byte = if big { bytes - 1 - at / 8 } else { at / 8 };
                record[byte] = record[byte] & !(1 << (at % 8)) | (((value >> bit & 1) as u8) << (at % 8));
            }
            let order = if big { ByteOrder::BigEndian } else { ByteOrder::LittleEndian };
            prop_assert_eq!(read(Number::Unsigned, order, offset, count, &record), value as f64);
        }
    }
}
