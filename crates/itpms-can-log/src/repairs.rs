//! Omissions and repairs of a reader of CAN logs, as numbers and as sentences. Filled by the readers beside it, shown by the binary.

use std::fmt;

/// Where in a log: text has lines, a binary file has bytes, an MDF4 file groups of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FramePlace {
    /// Line, from one.
    Line(u64),
    /// Byte, from zero.
    Byte(u64),
    /// Frame of a group of MDF4, from one.
    Frame(u64),
}

impl fmt::Display for FramePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FramePlace::Line(line) => write!(f, "line {line}"),
            FramePlace::Byte(byte) => write!(f, "byte {byte}"),
            FramePlace::Frame(frame) => write!(f, "frame {frame} of its group"),
        }
    }
}

/// The first of several places that were not understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotUnderstood {
    /// Where.
    pub place: FramePlace,
    /// The finding.
    pub found: String,
    /// The expected content.
    pub expected: &'static str,
}

/// Counts over what has been read so far; complete once the reader has returned `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameRepairs {
    /// Frames handed out.
    pub frames: u64,
    /// Lines or objects that are well-formed and no frame: events, statistics, other buses, requests to send.
    pub passed_over: u64,
    /// Lines or stretches of a file that mean nothing, left out.
    pub not_understood: u64,
    /// The first of them.
    pub first_not_understood: Option<NotUnderstood>,
    /// Frames the logger itself says it has lost.
    pub lost_by_logger: u64,
    /// Where the file is cut off: the last line or object is not whole and was left out.
    pub cut_off: Option<FramePlace>,
    /// Assumptions where the log is silent, a sentence each.
    pub assumptions: Vec<String>,
}

/// Assumptions kept; one of a kind is reported once, so that more would be a log full of oddities.
const MOST_ASSUMPTIONS: usize = 16;

impl FrameRepairs {
    /// Whether every frame was read as it stands.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.not_understood == 0 && self.lost_by_logger == 0 && self.cut_off.is_none()
    }

    /// One sentence per kind of repair, without the file's name. What was passed over is no repair and is not among them.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        if let Some(first) = &self.first_not_understood {
            let unit = match first.place {
                FramePlace::Line(_) => ("line is", "lines are"),
                FramePlace::Byte(_) => ("part is", "parts are"),
                FramePlace::Frame(_) => ("frame is", "frames are"),
            };
            let unit = if self.not_understood == 1 { unit.0 } else { unit.1 };
            out.push(format!(
                "{} {unit} not understood and left out, the first at {}: found {}, expected {}",
                self.not_understood, first.place, first.found, first.expected
            ));
        }
        if self.lost_by_logger > 0 {
            let frames = if self.lost_by_logger == 1 { "frame" } else { "frames" };
            out.push(format!("the logger says it has lost {} {frames}", self.lost_by_logger));
        }
        if let Some(place) = self.cut_off {
            out.push(format!("the file is cut off at {place}; what is whole was read"));
        }
        out.extend(self.assumptions.iter().cloned());
        out
    }

    pub(super) fn not_understood(&mut self, place: FramePlace, found: String, expected: &'static str) {
        self.not_understood += 1;
        self.first_not_understood.get_or_insert(NotUnderstood { place, found, expected });
    }

    pub(super) fn assume(&mut self, sentence: String) {
        if self.assumptions.len() < MOST_ASSUMPTIONS && !self.assumptions.contains(&sentence) {
            self.assumptions.push(sentence);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clean_log_says_nothing_and_others_count() {
        assert!(FrameRepairs { frames: 10, passed_over: 3, ..Default::default() }.warnings().is_empty());
        let mut repairs = FrameRepairs::default();
        repairs.not_understood(FramePlace::Line(7), "\"x\"".to_owned(), "a frame");
        repairs.not_understood(FramePlace::Line(9), "\"y\"".to_owned(), "a frame");
        repairs.cut_off = Some(FramePlace::Line(12));
        assert!(!repairs.is_clean());
        assert_eq!(
            repairs.warnings(),
            [
                "2 lines are not understood and left out, the first at line 7: found \"x\", expected a frame",
                "the file is cut off at line 12; what is whole was read",
            ]
        );
    }
}
