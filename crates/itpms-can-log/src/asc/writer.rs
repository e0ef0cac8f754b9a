//! Frames as the lines of an ASC file. Called by `FrameWriter`, which has looked at the times.

use std::fmt::Write;

use itpms_files::{AtomicFile, FileError};

use super::date;
use crate::frame::{CanFrame, Direction, FrameKind};

/// Writes the header with the first frame: the log begins at the whole second before it.
#[derive(Debug, Default)]
pub(crate) struct AscWriter {
    /// The log's beginning in s since 1970.
    start_s: Option<f64>,
    text: String,
}

impl AscWriter {
    /// Adds a frame. One that is older than the log's beginning gets stamp 0: the format knows no negative ones.
    pub(crate) fn write(&mut self, file: &mut AtomicFile, frame: &CanFrame) -> Result<(), FileError> {
        self.text.clear();
        let start_s = self.start_s.unwrap_or_else(|| self.begin(frame.time_s.floor()));
        let stamp_s = (frame.time_s - start_s).max(0.0);
        // Writing to a String does not fail.
        let _ = write!(self.text, "{stamp_s:11.6} ");
        self.push_frame(frame);
        self.text.push('\n');
        file.append(self.text.as_bytes())
    }

    /// Ends the log, which without a frame has a header all the same.
    pub(crate) fn finish(&mut self, file: &mut AtomicFile) -> Result<(), FileError> {
        self.text.clear();
        if self.start_s.is_none() {
            self.begin(0.0);
        }
        self.text.push_str("End TriggerBlock\n");
        file.append(self.text.as_bytes())
    }

    fn begin(&mut self, start_s: f64) -> f64 {
        self.start_s = Some(start_s);
        let date = date::format(start_s as i64);
        let _ = write!(
            self.text,
            "date {date}\nbase hex  timestamps absolute\ninternal events logged\nBegin TriggerBlock {date}\n   0.000000 Start of measurement\n"
        );
        start_s
    }

    fn push_frame(&mut self, frame: &CanFrame) {
        let channel = u32::from(frame.bus) + 1;
        let direction = match frame.direction {
            Direction::Rx => "Rx",
            Direction::Tx => "Tx",
        };
        let mut id = format!("{:X}", frame.id.value());
        if frame.id.is_extended() {
            id.push('x');
        }
        let text = &mut self.text;
        let _ = match frame.kind {
            FrameKind::Error => write!(text, "{channel}  ErrorFrame"),
            FrameKind::Remote => {
                write!(text, "{channel}  {id:<15} {direction:<4} r {:x}", frame.length().min(8))
            }
            FrameKind::Data => {
                write!(text, "{channel}  {id:<15} {direction:<4} d {:x}", frame.length_code().min(8))
            }
            FrameKind::Fd { bit_rate_switch, error_state_indicator } => write!(
                text,
                "CANFD {channel:>3} {direction:<4} {id:>8}  {:>32} {} {} {:x} {:>2}",
                "",
                u8::from(bit_rate_switch),
                u8::from(error_state_indicator),
                frame.length_code(),
                frame.length()
            ),
        };
        if frame.kind == FrameKind::Error {
            return;
        }
        for byte in frame.data() {
            let _ = write!(text, " {byte:02X}");
        }
        if let FrameKind::Fd { bit_rate_switch, error_state_indicator } = frame.kind {
            // Duration and length in bits are not known; the flags say FD, BRS, ESI; checksum and bit timing are not known.
            let flags = 0x1000 | u32::from(bit_rate_switch) << 13 | u32::from(error_state_indicator) << 14;
            let _ =
                write!(text, " {:>8} {:>4} {flags:>8X} {:>8} {:>8} {:>8} {:>8} {:>8}", 0, 0, 0, 0, 0, 0, 0);
        }
    }
}
