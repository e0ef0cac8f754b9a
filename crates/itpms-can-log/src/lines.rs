//! The lines of a text log, one at a time in a bounded buffer. Called by the readers of text beside it; knows nothing
//! of frames but their bytes.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

use itpms_files::FileProblem;

use super::digits::{self, Base};
use super::frame::Payload;
use crate::error::CanProblem;

/// Bytes of a line that are kept. The longest line a logger writes has less than 500; of a longer one the rest is passed over.
const KEPT: u64 = 4096;
/// Bytes of a line that are passed over, at most. A power cut may leave zeros in a log by the megabyte; what goes on for longer
/// has no lines.
const LONGEST: u64 = 1 << 26;

/// Lines of a file, as bytes: logs are not always UTF-8.
#[derive(Debug)]
pub(super) struct TextLines {
    input: BufReader<File>,
    line: Vec<u8>,
    number: u64,
    position: u64,
    bytes: u64,
    is_terminated: bool,
}

impl TextLines {
    pub(super) fn new(file: File, bytes: u64) -> Self {
        let input = BufReader::with_capacity(1 << 16, file);
        Self { input, line: Vec::new(), number: 0, position: 0, bytes, is_terminated: true }
    }

    /// The first kilobytes of the file, before a line is taken.
    pub(super) fn beginning(&mut self) -> Result<&[u8], CanProblem> {
        let ahead = self.input.fill_buf().map_err(FileProblem::Read)?;
        Ok(ahead.strip_prefix(b"\xef\xbb\xbf").unwrap_or(ahead))
    }

    /// Goes to the next line; false at the end.
    pub(super) fn advance(&mut self) -> Result<bool, CanProblem> {
        self.line.clear();
        let mut kept = (&mut self.input).take(KEPT);
        let length = kept.read_until(b'\n', &mut self.line).map_err(FileProblem::Read)? as u64;
        if length == 0 {
            return Ok(false);
        }
        self.number += 1;
        self.position += length;
        self.is_terminated = self.line.ends_with(b"\n");
        if !self.is_terminated && length == KEPT {
            self.skip_rest()?;
        }
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            // The byte order mark with which some programs begin a text file.
            self.line.drain(..3);
        }
        Ok(true)
    }

    /// Passes over what a long line has left.
    fn skip_rest(&mut self) -> Result<(), CanProblem> {
        let most = self.position + LONGEST;
        loop {
            if self.position > most {
                return Err(FileProblem::LongLine { line: self.number, most: LONGEST }.into());
            }
            let ahead = self.input.fill_buf().map_err(FileProblem::Read)?;
            if ahead.is_empty() {
                return Ok(());
            }
            let end = ahead.iter().position(|byte| *byte == b'\n');
            let used = end.map_or(ahead.len(), |end| end + 1);
            self.input.consume(used);
            self.position += used as u64;
            if end.is_some() {
                self.is_terminated = true;
                return Ok(());
            }
        }
    }

    pub(super) fn text(&self) -> &[u8] {
        self.line.trim_ascii_end()
    }

    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Whether it ends with a line end; only the last one of a file may not.
    pub(super) fn is_terminated(&self) -> bool {
        self.is_terminated
    }

    /// How much of the file has been read, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        (self.position as f64 / self.bytes.max(1) as f64).min(1.0)
    }
}

/// The words of a line, separated by blanks and tabs.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    pub(super) fn bytes(&mut self, length: usize, base: Base) -> Option<Payload> {
        let mut payload = Payload::EMPTY;
        for _ in 0..length {
            let byte = u8::try_from(digits::unsigned(self.next()?, base)?).ok()?;
            if !payload.push(byte) {
                return None;
            }
        }
        Some(payload)
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest.trim_ascii()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let text = self.rest.trim_ascii_start();
        let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

pub(super) fn beginning(line: &[u8]) -> String {
    const MOST: usize = 60;
    let line = line.trim_ascii();
    let text = String::from_utf8_lossy(line.get(..MOST).unwrap_or(line));
    if line.len() > MOST { format!("{text}...") } else { text.into_owned() }
}
