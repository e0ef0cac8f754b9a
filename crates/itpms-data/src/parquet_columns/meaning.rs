//! Meaning of a Parquet column's cells: numbers, or times, and how both are read from the stored values.
//!
//! Called by the columns, of which it sees the description alone. All types of the format that hold one number are among them;
//! what holds none (text, bytes, lists) is named in plain words.

use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as PhysicalType};
use parquet::data_type::Int96;
use parquet::schema::types::ColumnDescriptor;

use crate::log::clock_seconds;

/// The Julian day on which 1970 began.
const JULIAN_DAY_OF_1970: f64 = 2_440_588.0;
const SECONDS_PER_DAY: f64 = 86_400.0;

/// Meaning of a column's cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Meaning {
    pub(crate) quantity: Quantity,
    /// Divisor of the stored integer: a power of ten, so that the quotient is the intended number, to the last bit.
    divisor: f64,
    stored: Stored,
}

/// Whether numbers mean anything besides themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Number,
    /// A point in time or a length of time, in s.
    Time,
}

/// How a cell is laid down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stored {
    Plain,
    /// An integer without a sign.
    Unsigned,
    /// Bytes, an integer in two's complement, most significant first.
    BigEndian,
    /// Two bytes, IEEE 754, least significant first.
    HalfPrecision,
    Days,
    /// Months, days and milliseconds, least significant first.
    Interval,
    /// Text of a date and a time, as tables of text have it.
    ClockText,
    /// One of these words: its place among them, minus one for any other.
    Words(&'static [&'static str]),
}

impl Meaning {
    /// That of a column; `duration_per_s`: of how many units a second has, where the writer stored a duration as integers.
    /// Errors: it holds no numbers: what instead, in words.
    pub(super) fn of(leaf: &ColumnDescriptor, duration_per_s: Option<f64>) -> Result<Self, String> {
        if leaf.max_rep_level() > 0 {
            return Err("lists of values".to_owned());
        }
        let number = |stored, divisor| Ok(Self { quantity: Quantity::Number, divisor, stored });
        let time = |stored, divisor| Ok(Self { quantity: Quantity::Time, divisor, stored });
        let physical = leaf.physical_type();
        let is_integer = matches!(physical, PhysicalType::INT32 | PhysicalType::INT64);
        match (Annotation::of(leaf), physical) {
            (Annotation::Unsigned, _) if is_integer => number(Stored::Unsigned, 1.0),
            (Annotation::Decimal(scale), _) => {
                let stored = if is_integer { Stored::Plain } else { Stored::BigEndian };
                number(stored, 10f64.powi(scale))
            }
            (Annotation::Half, PhysicalType::FIXED_LEN_BYTE_ARRAY) if leaf.type_length() == 2 => {
                number(Stored::HalfPrecision, 1.0)
            }
            (Annotation::PerSecond(units), _) if is_integer => time(Stored::Plain, units),
            (Annotation::Date, PhysicalType::INT32) => time(Stored::Days, 1.0),
            (Annotation::Interval, PhysicalType::FIXED_LEN_BYTE_ARRAY) if leaf.type_length() == 12 => {
                time(Stored::Interval, 1.0)
            }
            (Annotation::None, PhysicalType::INT96) => time(Stored::Plain, 1.0),
            (Annotation::None, PhysicalType::INT64) => match duration_per_s {
                Some(units) => time(Stored::Plain, units),
                None => number(Stored::Plain, 1.0),
            },
            (
                Annotation::None,
                PhysicalType::INT32 | PhysicalType::FLOAT | PhysicalType::DOUBLE | PhysicalType::BOOLEAN,
            ) => number(Stored::Plain, 1.0),
            (Annotation::None, _) => Err("bytes".to_owned()),
            (Annotation::Other(what), _) => Err(what.to_owned()),
            _ => Err("a type that does not fit its storage".to_owned()),
        }
    }

    /// That of a column given as the clock, which may hold text.
    pub(super) fn of_clock(leaf: &ColumnDescriptor, duration_per_s: Option<f64>) -> Result<Self, String> {
        let is_text = Self::of_words(leaf, &[]).is_ok();
        let text = Self { quantity: Quantity::Time, divisor: 1.0, stored: Stored::ClockText };
        if is_text { Ok(text) } else { Self::of(leaf, duration_per_s) }
    }

    /// That of a column of words, in any case. Errors: it holds no text: what instead, in words.
    pub(super) fn of_words(leaf: &ColumnDescriptor, words: &'static [&'static str]) -> Result<Self, String> {
        let bytes = leaf.physical_type() == PhysicalType::BYTE_ARRAY && leaf.max_rep_level() == 0;
        let meant = match Annotation::of(leaf) {
            Annotation::None | Annotation::Other("text") => bytes,
            _ => false,
        };
        match meant {
            true => Ok(Self { quantity: Quantity::Number, divisor: 1.0, stored: Stored::Words(words) }),
            false => Err(Self::of(leaf, None).map_or_else(|what| what, |_| "numbers or times".to_owned())),
        }
    }

    pub(super) fn of_i32(self, value: i32) -> f64 {
        match self.stored {
            Stored::Unsigned => f64::from(value as u32) / self.divisor,
            Stored::Days => f64::from(value) * SECONDS_PER_DAY,
            _ => f64::from(value) / self.divisor,
        }
    }

    pub(super) fn of_i64(self, value: i64) -> f64 {
        let number = if self.stored == Stored::Unsigned { value as u64 as f64 } else { value as f64 };
        number / self.divisor
    }

    pub(super) fn of_bytes(self, bytes: &[u8]) -> f64 {
        match (self.stored, bytes) {
            (Stored::HalfPrecision, &[low, high]) => half::f16::from_le_bytes([low, high]).to_f64(),
            (Stored::BigEndian, _) => integer(bytes) / self.divisor,
            (Stored::Interval, _) => interval_s(bytes).unwrap_or(f64::NAN),
            (Stored::ClockText, _) => clock_seconds(bytes).unwrap_or(f64::NAN),
            (Stored::Words(words), _) => {
                let is = |word: &&str| bytes.trim_ascii().eq_ignore_ascii_case(word.as_bytes());
                words.iter().position(is).map_or(-1.0, |place| place as f64)
            }
            _ => f64::NAN,
        }
    }
}

/// Day and nanoseconds of the day, as Hive, Impala and Spark write a point in time.
pub(super) fn seconds_of_int96(value: Int96) -> f64 {
    let &[low, high, day] = value.data() else { return f64::NAN };
    let nanoseconds = u64::from(high) << 32 | u64::from(low);
    (f64::from(day) - JULIAN_DAY_OF_1970) * SECONDS_PER_DAY + nanoseconds as f64 / 1e9
}

/// Seconds of days and milliseconds; a month has no length.
fn interval_s(bytes: &[u8]) -> Option<f64> {
    let part = |i: usize| Some(u32::from_le_bytes(bytes.get(4 * i..4 * i + 4)?.try_into().ok()?));
    let (months, days, milliseconds) = (part(0)?, part(1)?, part(2)?);
    (months == 0).then_some(f64::from(days) * SECONDS_PER_DAY + f64::from(milliseconds) / 1e3)
}

/// A two's complement of any length; of 38 digits or less it is rounded once.
fn integer(bytes: &[u8]) -> f64 {
    let Some(first) = bytes.first() else { return f64::NAN };
    let sign = (*first as i8 >> 7) as u8;
    // All but the last 16 bytes, if they say no more than the sign.
    let tail = bytes.get(bytes.len().saturating_sub(16)..).unwrap_or(bytes);
    let head = &bytes[..bytes.len() - tail.len()];
    if head.iter().all(|byte| *byte == sign) && (tail[0] ^ sign) & 0x80 == 0 {
        return tail.iter().fold(i128::from(sign as i8), |value, byte| value << 8 | i128::from(*byte)) as f64;
    }
    let size = bytes.iter().fold(0.0, |size, byte| size * 256.0 + f64::from(byte ^ sign));
    if sign == 0 { size } else { -(size + 1.0) }
}

/// Logical type of a column, in the newer or the older way.
enum Annotation {
    None,
    Unsigned,
    /// Digits after the point.
    Decimal(i32),
    Half,
    /// Units of time that a second has.
    PerSecond(f64),
    Date,
    Interval,
    Other(&'static str),
}

impl Annotation {
    fn of(leaf: &ColumnDescriptor) -> Self {
        let Some(logical) = leaf.logical_type_ref() else { return Self::converted(leaf) };
        let per_s = |unit: &TimeUnit| match unit {
            TimeUnit::MILLIS => 1e3,
            TimeUnit::MICROS => 1e6,
            TimeUnit::NANOS => 1e9,
        };
        match logical {
            LogicalType::Integer(integer) if !integer.is_signed => Self::Unsigned,
            // A column of nulls is what `Unknown` means.
            LogicalType::Integer(_) | LogicalType::Unknown => Self::None,
            LogicalType::Decimal(decimal) => Self::Decimal(decimal.scale),
            LogicalType::Float16 => Self::Half,
            LogicalType::Time(time) => Self::PerSecond(per_s(&time.unit)),
            LogicalType::Timestamp(time) => Self::PerSecond(per_s(&time.unit)),
            LogicalType::Date => Self::Date,
            LogicalType::String | LogicalType::Enum => Self::Other("text"),
            LogicalType::Json | LogicalType::Bson => Self::Other("JSON"),
            LogicalType::Uuid => Self::Other("UUIDs"),
            LogicalType::Map | LogicalType::List => Self::Other("lists of values"),
            _ => Self::Other("values of a type that is no number"),
        }
    }

    fn converted(leaf: &ColumnDescriptor) -> Self {
        match leaf.converted_type() {
            ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64 => Self::Unsigned,
            ConvertedType::DECIMAL => Self::Decimal(leaf.type_scale()),
            ConvertedType::DATE => Self::Date,
            ConvertedType::TIME_MILLIS | ConvertedType::TIMESTAMP_MILLIS => Self::PerSecond(1e3),
            ConvertedType::TIME_MICROS | ConvertedType::TIMESTAMP_MICROS => Self::PerSecond(1e6),
            ConvertedType::UTF8 | ConvertedType::ENUM => Self::Other("text"),
            ConvertedType::JSON | ConvertedType::BSON => Self::Other("JSON"),
            ConvertedType::INTERVAL => Self::Interval,
            ConvertedType::LIST | ConvertedType::MAP | ConvertedType::MAP_KEY_VALUE => {
                Self::Other("lists of values")
            }
            ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64 => Self::None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_of_any_length_keep_their_sign() {
        assert_eq!(integer(&[0xff]), -1.0);
        assert_eq!(integer(&[0x00, 0xff]), 255.0);
        assert_eq!(integer(&(-1_234_567_890_123_i128).to_be_bytes()), -1_234_567_890_123.0);
        let mut long = [0xff; 32];
        assert_eq!(integer(&long), -1.0);
        long[31] = 0x00;
        assert_eq!(integer(&long), -256.0);
        long[0] = 0x80;
        assert!((integer(&long) / -(2f64.powi(255) - 2f64.powi(248)) - 1.0).abs() < 1e-14);
        assert!(integer(&[]).is_nan());
    }

    #[test]
    fn days_and_nanoseconds_are_seconds() {
        // 2026-03-01 08:00:00.25 UTC by `date +%s`: 1772352000.25.
        let nanoseconds: u64 = (8 * 3600) * 1_000_000_000 + 250_000_000;
        let stamp = Int96::from(vec![nanoseconds as u32, (nanoseconds >> 32) as u32, 2_440_588 + 20_513]);
        assert_eq!(seconds_of_int96(stamp), 1_772_352_000.25);
    }
}
