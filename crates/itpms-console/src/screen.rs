//! What a person or a script gets to read: results on standard output, remarks on standard error.

use std::borrow::Cow;
use std::ffi::OsString;
use std::fmt::{Display, Write as _};
use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use anstream::{AutoStream, ColorChoice};
use clap::builder::styling::AnsiColor;

use crate::exit::Failure;
use crate::options::Speaking;
use crate::progress::Progress;

/// Whether standard output receives a file, `-o -`: then what a person gets to read goes to standard error.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// Whether a part of the result was lost, on any thread.
static LOST: AtomicBool = AtomicBool::new(false);

fn note(written: io::Result<()>) {
    if written.is_err_and(|error| error.kind() != ErrorKind::BrokenPipe) {
        LOST.store(true, Ordering::Relaxed);
    }
}

/// A text on one line, without anything that a terminal would obey: names of files, cars and signals are another's.
/// Such a character is written as JSON writes it, so that JSON stays JSON.
pub fn plain(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed)
}

fn escaped(text: &str, bad: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&bad) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if bad(c) {
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Control characters, and those that turn the direction of writing.
fn is_obeyed(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Characters of a line where there is no terminal.
const LINE: usize = 100;
/// A narrower terminal breaks lines itself.
const NARROW: usize = 40;

/// Broken at spaces into lines of so many characters; a longer word has a line of its own.
fn wrapped(text: &str, width: usize) -> String {
    const INDENT: &str = "    ";
    let (mut out, mut length) = (String::with_capacity(text.len() + 16), 0);
    for word in text.split(' ') {
        let characters = word.chars().count();
        if !out.is_empty() {
            if length + 1 + characters > width {
                out.push('\n');
                out.push_str(INDENT);
                length = INDENT.len();
            } else {
                out.push(' ');
                length += 1;
            }
        }
        out.push_str(word);
        length += characters;
    }
    out
}

/// Where a command speaks.
#[derive(Debug, Clone, Copy)]
pub struct Screen {
    quiet: bool,
    color: ColorChoice,
}

impl Screen {
    /// With `--quiet`, remarks and progress bars are left out; errors never are. `arguments`: of the command line, where an option of
    /// `-` says that a file goes to standard output.
    pub fn new(speaking: Speaking, arguments: impl IntoIterator<Item = OsString>) -> Self {
        let arguments: Vec<OsString> = arguments.into_iter().collect();
        let is_option = |argument: &OsString| argument.len() > 1 && argument.as_encoded_bytes()[0] == b'-';
        let apart = arguments.windows(2).any(|pair| is_option(&pair[0]) && pair[1] == "-");
        let joined = arguments
            .iter()
            .any(|argument| argument == "-o-" || argument.as_encoded_bytes().ends_with(b"=-"));
        TAKEN.store(apart || joined, Ordering::Relaxed);
        let color = match speaking.color {
            clap::ColorChoice::Always => ColorChoice::Always,
            clap::ColorChoice::Never => ColorChoice::Never,
            clap::ColorChoice::Auto => AutoStream::choice(&io::stderr()),
        };
        Self { quiet: speaking.quiet, color }
    }

    /// Whether remarks and progress bars are left out.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    fn say(&self, text: &str) {
        if TAKEN.load(Ordering::Relaxed) {
            let _ = writeln!(io::stderr(), "{text}");
        } else {
            note(writeln!(io::stdout(), "{text}"));
        }
    }

    /// A line of the result. A reader that has gone away (`| head`) is no reason to complain; one that cannot take it is, at
    /// the end ([`Screen::check`]).
    pub fn print(&self, line: impl Display) {
        self.say(&plain(&line.to_string()));
    }

    /// A sentence of the result for a person alone, broken at the terminal's width, or at 100 characters where there is none; what
    /// follows is indented.
    pub fn print_wrapped(&self, line: impl Display) {
        let width = terminal_size::terminal_size_of(io::stdout()).map_or(LINE, |(width, _)| width.0.into());
        self.say(&wrapped(&plain(&line.to_string()), width.max(NARROW)));
    }

    /// A result of several lines, such as a table or JSON.
    pub fn print_lines(&self, text: impl Display) {
        self.say(&escaped(&text.to_string(), |c| !matches!(c, '\n' | '\t') && is_obeyed(c)));
    }

    pub fn write(&self, bytes: &[u8]) {
        note(io::stdout().write_all(bytes));
    }

    /// Whether all of the result could be written so far. Errors: a part of it could not.
    pub fn check(&self) -> Result<(), Failure> {
        note(io::stdout().flush());
        if LOST.load(Ordering::Relaxed) {
            return Err(Failure::Usage("standard output: the result cannot be written to it".to_owned()));
        }
        Ok(())
    }

    /// What happened besides the result.
    pub fn remark(&self, line: impl Display) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{}", plain(&line.to_string()));
        }
    }

    /// What was repaired or looks odd, but did not stop us.
    pub fn warn(&self, line: impl Display) {
        self.alarm("warning", AnsiColor::Yellow, line);
    }

    /// The one message a failed command ends with.
    fn error(&self, line: impl Display) {
        self.alarm("error", AnsiColor::Red, line);
    }

    fn alarm(&self, kind: &str, color: AnsiColor, line: impl Display) {
        let style = color.on_default().bold();
        let mut stream = AutoStream::new(io::stderr(), self.color);
        let _ = writeln!(stream, "{style}{kind}:{style:#} {}", plain(&line.to_string()));
    }

    /// The end of the program: its exit code, after the one message of a command that failed.
    pub fn end(&self, result: Result<(), Failure>) -> ExitCode {
        match result.and_then(|()| self.check()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                self.error(&failure);
                failure.code()
            }
        }
    }

    /// A progress bar, unless it is to be quiet.
    pub fn progress(&self, label: &str) -> Progress {
        if self.quiet { Progress::hidden() } else { Progress::shown(label) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_is_broken_at_spaces_and_loses_none() {
        let text = "fl  138.9 kPa, sd 5.1; a_word_that_is_longer_than_a_line, and more";
        let broken = wrapped(text, 20);
        assert_eq!(
            broken,
            "fl  138.9 kPa, sd\n    5.1;\n    a_word_that_is_longer_than_a_line,\n    and more"
        );
        assert_eq!(wrapped(text, 200), text);
    }
}
