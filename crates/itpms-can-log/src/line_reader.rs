//! A text log of which each line is for itself, as frames. Called by `FrameReader` for the formats that are nothing more: PEAK's traces, tables of frames,
//! BUSMASTER's logs.

use super::frame::CanFrame;
use super::frame_source::FrameSource;
use super::line_format::{LineContent, LineFormat};
use super::lines::TextLines;
use super::repairs::{FramePlace, FrameRepairs};
use super::strange::StrangeLines;
use crate::error::CanProblem;

#[derive(Debug)]
pub(super) struct LineReader<F> {
    lines: TextLines,
    format: F,
    strange: StrangeLines,
}

impl<F: LineFormat> LineReader<F> {
    pub(super) fn new(lines: TextLines, format: F) -> Self {
        Self { lines, format, strange: StrangeLines::new(F::EXPECTED, F::EXPECTED) }
    }
}

impl<F: LineFormat> FrameSource for LineReader<F> {
    fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        while self.lines.advance()? {
            let place = FramePlace::Line(self.lines.number());
            match self.format.line(self.lines.text()) {
                Ok(LineContent::Nothing) => {}
                // The last number of a line that is cut off is another number.
                Ok(_) | Err(_) if !self.lines.is_terminated() => repairs.cut_off = Some(place),
                Ok(LineContent::Event) => repairs.passed_over += 1,
                Ok(LineContent::Frame(frame)) => {
                    self.strange.any_understood = true;
                    return Ok(Some(frame));
                }
                Err(expected) => self.strange.count(&self.lines, expected, repairs)?,
            }
        }
        self.strange.end(&self.lines).map(|()| None)
    }

    fn progress(&self) -> f64 {
        self.lines.progress()
    }
}
