//! The lines of a text log that are not understood: counted, and the first one kept for the message should none be understood. Called by
//! the readers of text logs.

use crate::error::CanProblem;
use crate::lines::{TextLines, beginning};
use crate::repairs::{FramePlace, FrameRepairs};

/// Lines without any meaning after which a file is given up.
const MOST_LINES_OF_NOTHING: u64 = 10_000;

#[derive(Debug)]
pub(crate) struct StrangeLines {
    /// Expected of an empty file, and of a line.
    empty: &'static str,
    expected: &'static str,
    first: Option<(u64, String)>,
    pub(crate) any_understood: bool,
}

impl StrangeLines {
    pub(crate) fn new(empty: &'static str, expected: &'static str) -> Self {
        Self { empty, expected, first: None, any_understood: false }
    }

    /// Keeps the present line, as long as none was understood.
    pub(crate) fn remember(&mut self, lines: &TextLines) {
        if !self.any_understood {
            self.first.get_or_insert_with(|| (lines.number(), beginning(lines.text())));
        }
    }

    /// Counts the present line, in whose place something was expected.
    pub(crate) fn count(
        &mut self,
        lines: &TextLines,
        expected: &'static str,
        repairs: &mut FrameRepairs,
    ) -> Result<(), CanProblem> {
        let (number, text) = (lines.number(), lines.text());
        repairs.not_understood(FramePlace::Line(number), format!("{:?}", beginning(text)), expected);
        self.remember(lines);
        if number >= MOST_LINES_OF_NOTHING { self.end(lines) } else { Ok(()) }
    }

    /// The file ends here. Errors: none of its lines was understood.
    pub(crate) fn end(&self, lines: &TextLines) -> Result<(), CanProblem> {
        if self.any_understood {
            return Ok(());
        }
        Err(match &self.first {
            None => CanProblem::Empty { expected: self.empty },
            Some((line, found)) => CanProblem::NothingUnderstood {
                lines: lines.number(),
                line: *line,
                found: found.clone(),
                expected: self.expected,
            },
        })
    }
}
