//! Text formats of which each line is for itself.

use std::fmt::Debug;

use super::frame::CanFrame;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LineContent {
    /// Nothing that counts: blank, a comment, a part of the header.
    Nothing,
    /// Something that happened and is no frame.
    Event,
    Frame(CanFrame),
}

/// A format, with what the lines so far have stated of those that follow.
pub(super) trait LineFormat: Debug + Send + Sync {
    /// An example of a line.
    const EXPECTED: &'static str;

    /// The content of a line, or the expected content.
    fn line(&mut self, text: &[u8]) -> Result<LineContent, &'static str>;
}

#[cfg(test)]
pub(super) fn frames(mut format: impl LineFormat, text: &str) -> Vec<CanFrame> {
    let contents = text.lines().map(|line| format.line(line.as_bytes()).unwrap());
    contents
        .filter_map(|content| if let LineContent::Frame(frame) = content { Some(frame) } else { None })
        .collect()
}
