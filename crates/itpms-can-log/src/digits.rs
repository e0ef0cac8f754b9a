//! Numbers in text logs: hexadecimal, decimal, and seconds with a fraction. Called by the readers of text; knows nothing of frames.

pub(super) fn nibble(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'A'..=b'F' => Some(digit - b'A' + 10),
        b'a'..=b'f' => Some(digit - b'a' + 10),
        _ => None,
    }
}

/// Base in which a log writes identifiers and data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Base {
    Decimal,
    Hexadecimal,
}

/// An unsigned number of digits only; `None` if there are none, other characters, or more than 32 bits.
pub(super) fn unsigned(digits: &[u8], base: Base) -> Option<u32> {
    if digits.is_empty() {
        return None;
    }
    digits.iter().try_fold(0_u32, |sum, digit| match base {
        Base::Hexadecimal => {
            let digit = nibble(*digit)?;
            (sum >> 28 == 0).then_some(sum << 4 | u32::from(digit))
        }
        Base::Decimal => {
            let digit = digit.is_ascii_digit().then(|| digit - b'0')?;
            sum.checked_mul(10)?.checked_add(u32::from(digit))
        }
    })
}

/// A byte of exactly two hexadecimal digits.
pub(super) fn byte(digits: &[u8]) -> Option<u8> {
    match digits {
        [high, low] => Some(nibble(*high)? << 4 | nibble(*low)?),
        _ => None,
    }
}

/// Digits that certainly fit 64 bits: enough for the present date in nanoseconds.
const FITTING_DIGITS: usize = 19;

const MOST_DIGITS: usize = 40;

/// A number of seconds such as `1436509052.249713` or, before a trigger, `-0.25`, correctly rounded. Digits and at most one point.
pub(super) fn seconds(text: &[u8]) -> Option<f64> {
    match text {
        [b'-', digits @ ..] => unsigned_seconds(digits).map(|seconds| -seconds),
        digits => unsigned_seconds(digits),
    }
}

#[inline]
fn unsigned_seconds(text: &[u8]) -> Option<f64> {
    let mut sum = 0_u64;
    let mut digits = 0_usize;
    let mut fraction = None;
    for byte in text {
        match byte {
            b'0'..=b'9' => {
                digits += 1;
                sum = sum.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
            }
            b'.' if fraction.is_none() => fraction = Some(digits),
            _ => return None,
        }
    }
    if !(1..=MOST_DIGITS).contains(&digits) {
        return None;
    }
    let decimals = digits - fraction.unwrap_or(digits);
    match POWERS.get(decimals) {
        // Both numbers are exact, so their quotient is rounded once.
        Some(power) if digits <= FITTING_DIGITS && sum < 1 << 53 => Some(sum as f64 / power),
        _ => std::str::from_utf8(text).ok()?.parse().ok(),
    }
}

/// Powers of ten that a 64-bit number holds exactly.
const POWERS: [f64; 20] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_rounded_as_the_standard_library_does() {
        for text in [
            "0",
            "0.0",
            "000.000001",
            "1436509052.249713",
            "1436509052.249713123",
            "9999999999.999999",
            ".5",
            "18446744073709551617.000000",
            "7.",
            "-10.000000",
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(text.parse().unwrap()), "{text}");
        }
        for text in ["", ".", "1.2.3", "-", "--1", "+1", "1e3", "nan", &"1".repeat(41)] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn numbers_have_digits_of_their_base_and_32_bits() {
        assert_eq!(unsigned(b"1FFFffff", Base::Hexadecimal), Some(0x1FFF_FFFF));
        assert_eq!(unsigned(b"100000000", Base::Hexadecimal), None);
        assert_eq!(unsigned(b"4294967295", Base::Decimal), Some(u32::MAX));
        assert_eq!(unsigned(b"4294967296", Base::Decimal), None);
        assert_eq!(unsigned(b"1F", Base::Decimal), None);
        assert_eq!(unsigned(b"", Base::Hexadecimal), None);
        assert_eq!((byte(b"aF"), byte(b"a"), byte(b"0g")), (Some(0xAF), None, None));
    }
}
