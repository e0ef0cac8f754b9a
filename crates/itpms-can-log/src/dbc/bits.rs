//! Where a signal's bits are in a frame, and numbers into and out of them.
//!
//! Called by messages. A bit's number is 8 times its byte's plus its place in the byte, 0 the least significant. Intel
//! signals begin with their least significant bit and go up through these numbers; Motorola signals begin with their
//! most significant bit and go down inside a byte, then on with the top of the next. Knows nothing of scales.

/// In which order the bytes come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant first (Intel).
    LittleEndian,
    /// Most significant first (Motorola).
    BigEndian,
}

/// A place of 1 to 64 bits inside 64 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    order: ByteOrder,
    bits: u8,
    /// First and last byte it lies in, both below 64.
    first: u8,
    last: u8,
    /// Bits of the least significant byte below the signal.
    shift: u8,
}

impl Layout {
    /// The place of so many bits from the start bit of a DBC file on; `None` if it does not lie within `bytes`.
    pub(super) fn new(order: ByteOrder, start: u64, bits: u64, bytes: usize) -> Option<Self> {
        let most = 8 * bytes.min(64) as u64;
        if !(1..=64).contains(&bits) || start >= most {
            return None;
        }
        // Both orders as a row of bits without jumps: Motorola's counts each byte from its top.
        let begin = match order {
            ByteOrder::LittleEndian => start,
            ByteOrder::BigEndian => start / 8 * 8 + 7 - start % 8,
        };
        let end = begin + bits - 1;
        if end >= most {
            return None;
        }
        let shift = match order {
            ByteOrder::LittleEndian => begin % 8,
            ByteOrder::BigEndian => 7 - end % 8,
        };
        let byte = |bit: u64| (bit / 8) as u8;
        Some(Self { order, bits: bits as u8, first: byte(begin), last: byte(end), shift: shift as u8 })
    }

    /// Number of bits.
    #[must_use]
    pub fn bits(&self) -> u16 {
        u16::from(self.bits)
    }

    /// Order of the bytes.
    #[must_use]
    pub fn order(&self) -> ByteOrder {
        self.order
    }

    /// The bits as a number; `None` if the data end before them.
    #[must_use]
    pub fn get(&self, data: &[u8]) -> Option<u64> {
        let bytes = data.get(usize::from(self.first)..=usize::from(self.last))?;
        // Nine bytes at most: 64 bits that begin inside a byte.
        let together = |all: u128, byte: &u8| (all << 8) | u128::from(*byte);
        let all = match self.order {
            ByteOrder::LittleEndian => bytes.iter().rev().fold(0, together),
            ByteOrder::BigEndian => bytes.iter().fold(0, together),
        };
        Some((all >> self.shift) as u64 & self.mask())
    }

    /// Puts the lowest bits of a number there, if the data reach that far.
    pub(super) fn put(&self, data: &mut [u8], number: u64) {
        let Some(bytes) = data.get_mut(usize::from(self.first)..=usize::from(self.last)) else { return };
        let mut number = u128::from(number & self.mask()) << self.shift;
        let mut mask = u128::from(self.mask()) << self.shift;
        let mut place = |byte: &mut u8| {
            *byte = (*byte & !(mask as u8)) | number as u8;
            number >>= 8;
            mask >>= 8;
        };
        match self.order {
            ByteOrder::LittleEndian => bytes.iter_mut().for_each(&mut place),
            ByteOrder::BigEndian => bytes.iter_mut().rev().for_each(&mut place),
        }
    }

    /// Whether the two have a bit in common.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        if self.first > other.last || other.first > self.last {
            return false;
        }
        let (mut here, mut there) = ([0; 64], [0; 64]);
        self.put(&mut here, u64::MAX);
        other.put(&mut there, u64::MAX);
        here.iter().zip(&there).any(|(a, b)| a & b != 0)
    }

    pub(super) fn mask(&self) -> u64 {
        u64::MAX >> (64 - u32::from(self.bits))
    }

    pub(super) fn signed(&self, number: u64) -> i64 {
        let unused = 64 - u32::from(self.bits);
        ((number << unused) as i64) >> unused
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ByteOrder::{BigEndian, LittleEndian};

    /// Bit by bit, as the standard's drawing counts them.
    fn slowly(order: ByteOrder, start: u64, bits: u64, data: &[u8]) -> Option<u64> {
        let bit = |number: u64| Some(u64::from(*data.get(number as usize / 8)? >> (number % 8) & 1));
        let (mut value, mut at) = (0, start);
        for i in 0..bits {
            match order {
                LittleEndian => {
                    value |= bit(at)? << i;
                    at += 1;
                }
                BigEndian => {
                    value = value << 1 | bit(at)?;
                    at = if at % 8 == 0 { at + 15 } else { at - 1 };
                }
            }
        }
        Some(value)
    }

    #[test]
    fn every_place_agrees_with_the_bits_one_by_one() {
        let data: Vec<u8> = (0..64u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
        for order in [LittleEndian, BigEndian] {
            for bytes in [1, 3, 8, 12, 64] {
                for start in 0..=8 * bytes as u64 {
                    for bits in [1, 2, 7, 8, 9, 15, 16, 17, 31, 32, 33, 57, 63, 64] {
                        let layout = Layout::new(order, start, bits, bytes);
                        let slow = slowly(order, start, bits, &data[..bytes]);
                        assert_eq!(
                            layout.and_then(|l| l.get(&data[..bytes])),
                            slow,
                            "{order:?} {start}|{bits}"
                        );
                        let Some(layout) = layout else { continue };
                        let mut frame = data[..bytes].to_vec();
                        layout.put(&mut frame, 0x5A5A_5A5A_A5A5_A5A5);
                        assert_eq!(layout.get(&frame), Some(0x5A5A_5A5A_A5A5_A5A5 & layout.mask()));
                        // All other bits are as they were.
                        layout.put(&mut frame, layout.get(&data).unwrap());
                        assert_eq!(frame, data[..bytes]);
                    }
                }
            }
        }
    }

    #[test]
    fn signs_and_overlaps() {
        let layout = |order, start, bits| Layout::new(order, start, bits, 8).unwrap();
        let twelve = layout(LittleEndian, 0, 12);
        assert_eq!((twelve.signed(0x800), twelve.signed(0x7FF), twelve.signed(0xFFF)), (-2048, 2047, -1));
        assert_eq!(layout(LittleEndian, 0, 64).signed(u64::MAX), -1);
        // Motorola 7|12 is byte 0 and the upper half of byte 1; Intel 8|4 is the lower half of byte 1.
        assert!(!layout(BigEndian, 7, 12).overlaps(&layout(LittleEndian, 8, 4)));
        assert!(layout(BigEndian, 7, 12).overlaps(&layout(LittleEndian, 12, 1)));
    }
}
