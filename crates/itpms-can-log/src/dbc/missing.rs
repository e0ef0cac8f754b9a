//! Raw values that say that a signal has none: made once for each signal ([`find_missing`](super::find_missing)), asked for every frame.

/// Why raw bits are no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoValue {
    /// A label says so, or the standard.
    Stated,
    /// They are an end of the raw numbers, beyond the stated range.
    RawEnd,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Missing {
    pub(super) labelled: Vec<u64>,
    /// From here on, on J1939.
    pub(super) from: Option<u64>,
    pub(super) ends: Vec<u64>,
}

impl Missing {
    #[inline]
    pub(super) fn why(&self, raw: u64) -> Option<NoValue> {
        if self.from.is_some_and(|from| raw >= from) || self.labelled.contains(&raw) {
            Some(NoValue::Stated)
        } else if self.ends.contains(&raw) {
            Some(NoValue::RawEnd)
        } else {
            None
        }
    }

    /// The raw value of a missing one.
    pub(super) fn code(&self, mask: u64) -> Option<u64> {
        self.labelled.first().copied().or(self.from.map(|_| mask))
    }
}
