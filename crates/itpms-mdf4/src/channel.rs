//! Contents of a file: channel groups and their channels.
//!
//! Made by the structure, used by everybody who reads MDF4; knows nothing of files.

use std::sync::Arc;

use super::conversion::{Conversion, Raw};
use super::field::Field;

/// Samples with a common clock.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelGroup {
    /// Its name, else its comment or its source; `group N` where there is none of these.
    pub name: String,
    /// Samples as the file claims them; `None` where the file does not know.
    pub samples: Option<u64>,
    /// The channels in the file's order.
    pub channels: Vec<Channel>,
    /// Whether the samples have a time: a master channel in s, here or in another group.
    pub has_time: bool,
}

/// One channel of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Its name.
    pub name: String,
    /// Unit of the physical value; empty if there is none.
    pub unit: String,
    /// Comment; empty if there is none.
    pub comment: String,
    /// Whether it is the group's time in s.
    pub is_time: bool,
    /// Of an element of a short array: its number from zero, and how many there are. Its name is the array's and `[0]`.
    pub element: Option<(u32, u32)>,
    /// Its readable content.
    pub kind: ChannelKind,
}

/// Kind of a channel's values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChannelKind {
    /// Numbers, physical ones where the file says how to compute them.
    Number,
    /// Text of fixed length; listed, not read.
    Text,
    /// Bytes, pictures, dates; listed, not read.
    Bytes,
    /// Text or bytes of varying length; listed, not read.
    VariableLength,
    /// A structure, or an array that is long or has several dimensions; listed, not read.
    Composite,
    /// Something that could be a number but cannot be computed, and why.
    Unreadable(String),
}

impl ChannelKind {
    /// In words, for a message.
    #[must_use]
    pub fn describe(&self) -> &str {
        match self {
            Self::Number => "numbers",
            Self::Text => "text",
            Self::Bytes => "bytes",
            Self::VariableLength => "of varying length",
            Self::Composite => "an array or a structure",
            Self::Unreadable(why) => why,
        }
    }
}

/// How a channel's numbers come out of a record.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub(super) field: Field,
    pub(super) raw: Raw,
    pub(super) conversion: Arc<Conversion>,
    pub(super) validity: Validity,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BytesLayout {
    /// In the record.
    Inside { offset: usize, length: usize },
    /// In data of their own, which begin with the block at `data`; the record has their place there.
    Apart { offset: usize, length: usize, data: u64 },
}

/// Where a channel says that a value is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Validity {
    /// Nowhere: all values are valid.
    All,
    None,
    /// At a bit of the record's invalidation bytes.
    Bit {
        byte: usize,
        mask: u8,
    },
}

impl Layout {
    /// The physical value in `record`, the `index`-th of its group; NaN if the invalidation bytes say so.
    #[inline]
    pub(super) fn value(&self, record: &[u8], invalid: &[u8], index: u64) -> f64 {
        let valid = match self.validity {
            Validity::All => true,
            Validity::None => false,
            Validity::Bit { byte, mask } => invalid.get(byte).is_none_or(|bits| bits & mask == 0),
        };
        if !valid {
            return f64::NAN;
        }
        let raw = self.field.read(record, index);
        match &*self.conversion {
            Conversion::Identity => raw,
            conversion => conversion.apply(raw, self.raw),
        }
    }
}
