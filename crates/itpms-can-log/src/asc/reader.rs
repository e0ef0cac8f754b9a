//! An ASC file as frames. Called by `FrameReader`; keeps what the lines have stated of base, date and stamps.

use super::parse::{AscLine, EXPECTED, Stamps, parse};
use crate::digits::Base;
use crate::error::CanProblem;
use crate::frame::CanFrame;
use crate::frame_source::FrameSource;
use crate::lines::TextLines;
use crate::repairs::{FramePlace, FrameRepairs};
use crate::strange::StrangeLines;

/// Expected of an empty file.
const EMPTY: &str = "a header that begins with date and lines such as 0.25 1 123 Rx d 2 DE AD";

#[derive(Debug)]
pub(crate) struct AscReader {
    lines: TextLines,
    base: Base,
    stamps: Stamps,
    /// Seconds since 1970 from which absolute stamps count; 0 until a date is known.
    start_s: f64,
    /// Sum of the stamps, where they are differences; else the last one.
    stamp_s: f64,
    /// Date of a block that began after a stamp, until the next stamp says whether it counts.
    block_s: Option<f64>,
    any_stamp: bool,
    strange: StrangeLines,
}

impl AscReader {
    pub(crate) fn new(lines: TextLines) -> Self {
        Self {
            lines,
            base: Base::Hexadecimal,
            stamps: Stamps::Absolute,
            start_s: 0.0,
            stamp_s: 0.0,
            block_s: None,
            any_stamp: false,
            strange: StrangeLines::new(EMPTY, EXPECTED),
        }
    }

    /// Takes in what a line says; its frame if it is one.
    fn understood(&mut self, line: AscLine, repairs: &mut FrameRepairs) -> Option<CanFrame> {
        // Neither a comment nor a number at the beginning of a line makes a file an ASC file.
        match line {
            AscLine::Nothing => {}
            AscLine::Event(_) => self.strange.remember(&self.lines),
            _ => self.strange.any_understood = true,
        }
        match line {
            AscLine::Nothing => {}
            AscLine::Base { base, stamps } => (self.base, self.stamps) = (base, stamps),
            AscLine::Date(Some(date_s)) | AscLine::Block(Some(date_s)) if !self.any_stamp => {
                self.start_s = date_s
            }
            AscLine::Block(date_s) if self.any_stamp => self.block_s = date_s,
            AscLine::Date(Some(_)) | AscLine::Block(_) => {}
            AscLine::Date(None) => repairs.assume(format!(
                "line {}: the date is not understood; times count from the beginning of the log",
                self.lines.number()
            )),
            AscLine::Event(stamp_s) => {
                repairs.passed_over += 1;
                self.time_s(stamp_s);
            }
            AscLine::Frame(mut frame) => {
                frame.time_s = self.time_s(frame.time_s);
                return Some(frame);
            }
        }
        None
    }

    fn time_s(&mut self, stamp_s: f64) -> f64 {
        let block_s = self.block_s.take();
        match self.stamps {
            Stamps::Relative => self.stamp_s += stamp_s,
            Stamps::Absolute => {
                // After a trigger the stamps go on, or begin again with a date of their own.
                if let (Some(block_s), true) = (block_s, stamp_s < self.stamp_s) {
                    self.start_s = block_s;
                }
                self.stamp_s = stamp_s;
            }
        }
        self.any_stamp = true;
        self.start_s + self.stamp_s
    }
}

impl FrameSource for AscReader {
    fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        while self.lines.advance()? {
            match parse(self.lines.text(), self.base) {
                // The last number of a frame that is cut off is another number, and a stamp alone is no event.
                Ok(AscLine::Frame(_) | AscLine::Event(_)) if !self.lines.is_terminated() => {
                    repairs.cut_off = Some(FramePlace::Line(self.lines.number()));
                }
                Ok(line) => {
                    if let Some(frame) = self.understood(line, repairs) {
                        return Ok(Some(frame));
                    }
                }
                Err(_) if !self.lines.is_terminated() && self.strange.any_understood => {
                    repairs.cut_off = Some(FramePlace::Line(self.lines.number()));
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
