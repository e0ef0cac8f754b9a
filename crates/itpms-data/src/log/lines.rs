//! The lines of a text table: plain, in UTF-16 or behind gzip, without comments, blank lines and what a power cut leaves.
//!
//! A line is a row, as everywhere with measurements; therefore lines are split here, and every message can name the line an editor
//! shows. (General CSV readers count records, and lose count at comments and blank lines.)

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};

use itpms_files::input::MOST_OF_A_LINE;

use super::packed::{GZIP, Packed};
use super::wide::{Order, Wide};
use crate::error::{FileProblem, Problem};

const MOST_ZEROS: u64 = 1 << 26;
/// Bytes read at a time.
const BUFFER: usize = 1 << 16;

pub(crate) struct Lines {
    input: Input,
    /// Another hold on the file, for where in it reading is.
    file: Option<File>,
    line: Vec<u8>,
    number: u64,
    /// The last comment before the first line that is none.
    comment: Option<(Vec<u8>, u64)>,
    is_before_text: bool,
    /// Lines that are handed out once more, each with its number.
    again: VecDeque<(Vec<u8>, u64)>,
    /// Bytes of zeros that were passed over, which no logger writes and a power cut leaves.
    zeros: u64,
}

/// The bytes of the text.
enum Input {
    Plain(BufReader<File>),
    Packed(Box<BufReader<Packed>>),
    Wide(Box<BufReader<Wide<BufReader<File>>>>),
}

impl Read for Input {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Input::Plain(input) => input.read(bytes),
            Input::Packed(input) => input.read(bytes),
            Input::Wide(input) => input.read(bytes),
        }
    }
}

impl BufRead for Input {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        match self {
            Input::Plain(input) => input.fill_buf(),
            Input::Packed(input) => input.fill_buf(),
            Input::Wide(input) => input.fill_buf(),
        }
    }

    fn consume(&mut self, count: usize) {
        match self {
            Input::Plain(input) => input.consume(count),
            Input::Packed(input) => input.consume(count),
            Input::Wide(input) => input.consume(count),
        }
    }
}

impl std::fmt::Debug for Lines {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lines").field("number", &self.number).finish_non_exhaustive()
    }
}

impl Lines {
    pub(crate) fn new(file: File) -> Self {
        let probe = file.try_clone().ok();
        let mut plain = BufReader::with_capacity(BUFFER, file);
        // What cannot be read is reported with the first line.
        let first = plain.fill_buf().unwrap_or_default();
        let (packed, wide) = (first.starts_with(GZIP), Order::of(first));
        let input = match wide {
            _ if packed => Input::Packed(Box::new(BufReader::with_capacity(BUFFER, Packed::new(plain)))),
            Some(order) => Input::Wide(Box::new(BufReader::with_capacity(BUFFER, Wide::new(plain, order)))),
            None => Input::Plain(plain),
        };
        Self {
            input,
            file: probe,
            line: Vec::new(),
            number: 0,
            comment: None,
            is_before_text: true,
            again: VecDeque::new(),
            zeros: 0,
        }
    }

    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Bytes of the file that were read so far.
    pub(crate) fn position(&self) -> u64 {
        self.file.as_ref().and_then(|mut file| file.stream_position().ok()).unwrap_or(0)
    }

    /// Goes to the next line that is neither blank nor a comment; false at the end.
    pub(crate) fn advance(&mut self) -> Result<bool, Problem> {
        if let Some((line, number)) = self.again.pop_front() {
            (self.line, self.number) = (line, number);
            return Ok(true);
        }
        loop {
            self.line.clear();
            let mut limited = (&mut self.input).take(MOST_OF_A_LINE);
            let length = limited.read_until(b'\n', &mut self.line).map_err(FileProblem::Read)? as u64;
            if length == 0 {
                return Ok(false);
            }
            let kept = self.line.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
            if kept < self.line.len() {
                self.zeros += (self.line.len() - kept) as u64;
                self.line.truncate(kept);
                self.bound_zeros()?;
                if kept == 0 {
                    continue;
                }
            }
            self.number += 1;
            if kept as u64 == MOST_OF_A_LINE {
                return Err(FileProblem::LongLine { line: self.number, most: MOST_OF_A_LINE }.into());
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                // The byte order mark with which some programs begin a text file.
                self.line.drain(..3);
            }
            if self.number == 1 && (self.line.starts_with(b"\xff\xfe") || self.line.starts_with(b"\xfe\xff"))
            {
                return Err(
                    "the packed text is UTF-16, expected UTF-8: unpack it (gunzip), then it is read".into()
                );
            }
            match self.text().first() {
                None => {}
                Some(b'#') if self.is_before_text => self.comment = Some(self.present()),
                Some(b'#') => {}
                Some(_) => {
                    self.is_before_text = false;
                    return Ok(true);
                }
            }
        }
    }

    pub(crate) fn present(&self) -> (Vec<u8>, u64) {
        (self.line.clone(), self.number)
    }

    /// The next lines are these, the last that were handed out.
    pub(crate) fn put_back(&mut self, lines: impl IntoIterator<Item = (Vec<u8>, u64)>) {
        self.again.extend(lines);
    }

    /// The last comment before the first line, without its sign, and its number.
    pub(crate) fn comment(&self) -> Option<(Vec<u8>, u64)> {
        let (line, number) = self.comment.as_ref()?;
        let sign = line.iter().position(|byte| *byte == b'#')?;
        Some((line[sign + 1..].to_vec(), *number))
    }

    pub(crate) fn text(&self) -> &[u8] {
        self.line.trim_ascii()
    }

    pub(crate) fn is_terminated(&self) -> bool {
        self.line.ends_with(b"\n")
    }

    /// Whether the end of the text is missing: zeros stand there, or the file behind gzip has none.
    pub(crate) fn lacks_its_end(&self) -> bool {
        self.zeros > 0 || matches!(&self.input, Input::Packed(input) if input.get_ref().is_cut_off)
    }

    /// A file of nothing but zeros is no text, and after the text they have an end.
    fn bound_zeros(&self) -> Result<(), Problem> {
        let most = if self.number == 0 { MOST_OF_A_LINE } else { MOST_ZEROS };
        if self.zeros >= most {
            Err(FileProblem::LongLine { line: self.number + 1, most }.into())
        } else {
            Ok(())
        }
    }
}
