//! Report of the alignment, as numbers and as text.

use crate::log::Slot;

/// How a signal came into the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SlotMethod {
    Clock,
    /// As it is; its readings lie this many seconds behind the clock's.
    AsItIs {
        /// In s, within three quarters of a period.
        offset_s: f64,
    },
    LowPass,
    /// On the line between two readings.
    Interpolated,
    /// Nothing, or too little to know its rate, has come.
    Waiting,
    /// Once, in the row after it was sent: a sensor in a tire.
    Sent,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlotAlignment {
    pub slot: Slot,
    /// Readings per second; NaN while unknown.
    pub rate_hz: f64,
    pub method: SlotMethod,
    pub readings: u64,
    /// Readings that found their place in a row already taken.
    pub left_over: u64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct AlignmentReport {
    pub rate_hz: f64,
    /// The signals, in the order of [`Slot::all`].
    pub signals: Vec<SlotAlignment>,
    pub without_time: u64,
    /// Readings stamped far ahead of all others that none followed.
    pub strays: u64,
    /// Readings that came after their row had gone.
    pub late: u64,
    /// Times the clock went back and was believed.
    pub restarts: u64,
}

impl AlignmentReport {
    /// Corrections of the readings, one sentence each.
    pub fn remarks(&self) -> Vec<String> {
        self.signals.iter().filter_map(|signal| self.remark(signal)).collect()
    }

    /// Omissions, a sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        for (count, what) in [
            (self.without_time, "had no time"),
            (self.strays, "had a stamp far ahead of all others that none followed"),
            (self.late, "came after their row had gone"),
            (
                self.signals.iter().map(|signal| signal.left_over).sum(),
                "shared their row with another of their signal",
            ),
        ] {
            if count > 0 {
                out.push(format!("{count} readings {what} and were left out"));
            }
        }
        if self.restarts > 0 {
            out.push(format!("the clock went back {} times", self.restarts));
        }
        out
    }

    fn remark(&self, signal: &SlotAlignment) -> Option<String> {
        let (name, from, to) = (signal.slot.name(), signal.rate_hz, self.rate_hz);
        match signal.method {
            SlotMethod::Clock | SlotMethod::Sent => None,
            SlotMethod::AsItIs { offset_s } => (offset_s.abs() > 0.05 / to).then(|| {
                let when = if offset_s > 0.0 { "after" } else { "before" };
                format!(
                    "{name} comes {:.2} ms {when} the others of its cycle; its values were not changed",
                    1e3 * offset_s.abs()
                )
            }),
            SlotMethod::LowPass => {
                Some(format!("{name}, {from:.0} Hz, was brought to the rows' {to:.0} Hz by a low-pass"))
            }
            SlotMethod::Interpolated => (!(from > 0.95 * to))
                .then(|| format!("{name}, {from:.0} Hz, was interpolated to the rows' {to:.0} Hz")),
            SlotMethod::Waiting => Some(format!("{name} has too few readings ({})", signal.readings)),
        }
    }
}
