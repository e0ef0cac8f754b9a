//! Specification of a file to write: groups, their channels, and how numbers are stored.

/// A channel group to be written: samples with a common clock.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GroupSpec {
    /// Its name.
    pub name: String,
    /// A comment; may be empty.
    pub comment: String,
    /// Its channels, the time not among them: it is a channel of its own, `time` in s.
    pub channels: Vec<ChannelSpec>,
}

/// A channel to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Its name.
    pub name: String,
    /// Unit of its values; may be empty.
    pub unit: String,
    /// A comment; may be empty.
    pub comment: String,
    /// How its values are stored.
    pub format: SampleFormat,
}

impl ChannelSpec {
    /// A channel without a comment.
    #[must_use]
    pub fn new(name: &str, unit: &str, format: SampleFormat) -> Self {
        Self { name: name.to_owned(), unit: unit.to_owned(), comment: String::new(), format }
    }
}

/// How numbers are stored. Integers are rounded; a missing one is marked as invalid, a missing float is NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleFormat {
    /// IEEE 754, eight bytes.
    Float64,
    /// IEEE 754, four bytes.
    Float32,
    /// 0 to 255.
    Unsigned8,
    /// 0 to 65 535.
    Unsigned16,
    /// 0 to 2^32 - 1.
    Unsigned32,
    /// 0 to 2^64 - 1, as far as `f64` tells them apart.
    Unsigned64,
    /// -128 to 127.
    Signed8,
    /// -32 768 to 32 767.
    Signed16,
    /// -2^31 to 2^31 - 1.
    Signed32,
    /// -2^63 to 2^63 - 1, as far as `f64` tells them apart.
    Signed64,
}

impl SampleFormat {
    pub(super) fn bytes(self) -> usize {
        use SampleFormat::*;
        match self {
            Unsigned8 | Signed8 => 1,
            Unsigned16 | Signed16 => 2,
            Float32 | Unsigned32 | Signed32 => 4,
            Float64 | Unsigned64 | Signed64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, SampleFormat::Float32 | SampleFormat::Float64)
    }

    /// `cn_data_type`.
    pub(super) fn data_type(self) -> u8 {
        use SampleFormat::*;
        match self {
            Unsigned8 | Unsigned16 | Unsigned32 | Unsigned64 => 0,
            Signed8 | Signed16 | Signed32 | Signed64 => 2,
            Float32 | Float64 => 4,
        }
    }

    /// Least and greatest number an integer format holds, among those `f64` knows.
    pub(super) fn range(self) -> (f64, f64) {
        use SampleFormat::*;
        let bits = 8 * self.bytes() as i32;
        let power = |bits: i32| 2f64.powi(bits);
        // The number below 2^63 or 2^64 that f64 knows is 2^10 or 2^11 less.
        let below = |bits: i32| if bits > 53 { power(bits) - power(bits - 53) } else { power(bits) - 1.0 };
        match self {
            Float32 | Float64 => (f64::NEG_INFINITY, f64::INFINITY),
            Unsigned8 | Unsigned16 | Unsigned32 | Unsigned64 => (0.0, below(bits)),
            Signed8 | Signed16 | Signed32 | Signed64 => (-power(bits - 1), below(bits - 1)),
        }
    }

    /// Appends `value`, which lies in the range.
    pub(super) fn store(self, value: f64, record: &mut Vec<u8>) {
        use SampleFormat::*;
        let least = |integer: i128, bytes: usize| integer.to_le_bytes().into_iter().take(bytes);
        match self {
            Float64 => record.extend(value.to_le_bytes()),
            Float32 => record.extend((value as f32).to_le_bytes()),
            // Two's complement: its lower bytes are those of the narrower integer, signed or not.
            _ => record.extend(least(value as i128, self.bytes())),
        }
    }
}

/// How data are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compression {
    /// Not at all: the fastest to write and to read.
    None,
    /// Deflate.
    Deflate,
    /// Deflate of the records' bytes column by column: the smallest, mostly by far.
    Transposed,
}
