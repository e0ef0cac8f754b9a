//! A text log of which each line is for itself, as frames. Called by `FrameReader` for the formats that are nothing more: PEAK's traces, tables of frames,
//! BUSMASTER's logs.

use super::frame::CanFrame;
use super::lines::{TextLines, beginning};
use super::repairs::{FramePlace, FrameRepairs};
use crate::error::CanProblem;

/// Lines without any frame after which a file is given up.
const MOST_LINES_OF_NOTHING: u64 = 10_000;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LineContent {
    /// Nothing that counts: blank, a comment, a part of the header.
    Nothing,
    /// Something that happened and is no frame.
    Event,
    Frame(CanFrame),
}

/// A format, with what the lines so far have stated of those that follow.
pub(super) trait LineFormat {
    /// What a line looks like.
    const EXPECTED: &'static str;

    /// The content of a line, or the expected content.
    fn line(&mut self, text: &[u8]) -> Result<LineContent, &'static str>;
}

#[derive(Debug)]
pub(super) struct LineReader<F> {
    lines: TextLines,
    format: F,
    any_frame: bool,
    first_strange: Option<(u64, String)>,
}

impl<F: LineFormat> LineReader<F> {
    pub(super) fn new(lines: TextLines, format: F) -> Self {
        Self { lines, format, any_frame: false, first_strange: None }
    }

    pub(super) fn progress(&self) -> f64 {
        self.lines.progress()
    }

    pub(super) fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        while self.lines.advance()? {
            let place = FramePlace::Line(self.lines.number());
            match self.format.line(self.lines.text()) {
                Ok(LineContent::Nothing) => {}
                // The last number of a line that is cut off is another number.
                Ok(_) | Err(_) if !self.lines.is_terminated() => repairs.cut_off = Some(place),
                Ok(LineContent::Event) => repairs.passed_over += 1,
                Ok(LineContent::Frame(frame)) => {
                    self.any_frame = true;
                    return Ok(Some(frame));
                }
                Err(expected) => self.strange(place, expected, repairs)?,
            }
        }
        if self.any_frame { Ok(None) } else { Err(self.nothing()) }
    }

    fn strange(
        &mut self,
        place: FramePlace,
        expected: &'static str,
        repairs: &mut FrameRepairs,
    ) -> Result<(), CanProblem> {
        let (number, text) = (self.lines.number(), self.lines.text());
        repairs.not_understood(place, format!("{:?}", beginning(text)), expected);
        if !self.any_frame {
            self.first_strange.get_or_insert_with(|| (number, beginning(text)));
            if number >= MOST_LINES_OF_NOTHING {
                return Err(self.nothing());
            }
        }
        Ok(())
    }

    /// The error of a file without a frame.
    fn nothing(&self) -> CanProblem {
        match &self.first_strange {
            None => CanProblem::Empty { expected: F::EXPECTED },
            Some((line, found)) => CanProblem::NothingUnderstood {
                lines: self.lines.number(),
                line: *line,
                found: found.clone(),
                expected: F::EXPECTED,
            },
        }
    }
}
