//! Lines of candump from text, wherever it comes from: frames out, what is no frame counted.
//!
//! Called by the sources that read text; keeps nothing but what it has reported already.

use std::time::Instant;

use itpms_data::can::candump::{LineProblem, parse_line};

use crate::input::{Input, Note, NoteSink};

pub(super) struct Lines {
    name: String,
    notes: NoteSink,
    complained: bool,
}

impl Lines {
    pub(super) fn new(name: &str, notes: NoteSink) -> Self {
        Self { name: name.to_owned(), notes, complained: false }
    }

    /// The content of a line; `None` for a blank one. The first that is not understood is reported; all are counted.
    pub(super) fn take(&mut self, line: &[u8], arrived: Instant) -> Option<Input> {
        // Bytes that are no text hold no frame, either: the replacement characters see to that.
        match parse_line(&String::from_utf8_lossy(line)) {
            Ok(line) => Some(Input::Frame { frame: line.frame, arrived }),
            Err(LineProblem::Blank) => None,
            Err(LineProblem::Lost(count)) => Some(Input::Lost(count)),
            Err(problem) => {
                if !std::mem::replace(&mut self.complained, true) {
                    let text = format!("{}: {problem}; such lines are counted from now on", self.name);
                    (self.notes)(Note::Warning(text));
                }
                Some(Input::Malformed(1))
            }
        }
    }
}
