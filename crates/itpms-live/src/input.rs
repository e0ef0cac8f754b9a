//! Messages from a source to the estimating thread.

use std::time::Instant;

use itpms_core::model::Corner;
use itpms_data::LogRow;
use itpms_data::can::CanFrame;
use itpms_data::pulses::Pulse;

#[derive(Debug, Clone)]
pub enum Input {
    /// The kind of rows that follow, from a source that knows before the first: the rate it measured and the corners it has.
    Opened {
        sample_rate_hz: f64,
        corners: Vec<Corner>,
        wheel_speeds: bool,
    },
    Row {
        /// The row, much larger than what else comes.
        row: Box<LogRow>,
        arrived: Instant,
    },
    /// A tooth of a wheel speed sensor passed; comes before the first row or frame that is not earlier.
    Pulse(Pulse),
    Frame {
        frame: CanFrame,
        arrived: Instant,
    },
    /// Lines, messages or frames that could not be read.
    Malformed(u64),
    /// Frames that the system or the source itself lost.
    Lost(u64),
    /// The connection is gone; why.
    Disconnected(String),
    /// The connection is there again.
    Reconnected,
    Ended,
    /// There will be nothing more, because something broke in the middle.
    Failed(String),
}

#[derive(Debug, Clone)]
pub struct SourceName {
    /// Interface, file or topic.
    pub name: String,
    /// `socketcan`, `stdin`, `replay` or `mqtt`.
    pub kind: &'static str,
}

/// Something a person should read, from any thread.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Note {
    Remark(String),
    /// A fault or a loss.
    Warning(String),
}

pub type NoteSink = std::sync::Arc<dyn Fn(Note) + Send + Sync>;
