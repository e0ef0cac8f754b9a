//! What can be wrong with any file, whatever its format: in one sentence that is complete and can be printed as it is.

use std::path::{Path, PathBuf};
use std::{fmt, io};

use thiserror::Error;

/// A file that could not be used, and why.
#[derive(Debug, Error)]
#[error("{}", sentence(path, problem))]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: FileProblem,
}

impl FileError {
    /// The error of this file.
    #[must_use]
    pub fn new(path: &Path, problem: FileProblem) -> Self {
        Self { path: path.to_owned(), problem }
    }
}

/// One kind of problem that a file of any format may have.
#[derive(Debug, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say it")]
pub enum FileProblem {
    #[error("no such file")]
    NotFound,
    #[error("is a directory, expected a file")]
    IsDirectory,
    #[error("cannot be read: {0}")]
    Read(io::Error),
    #[error("cannot be written: {0}")]
    Write(io::Error),
    #[error("is used by another program{}, expected one at a time", by(.process))]
    InUse { process: Option<u32> },
    #[error("cannot be written: the directory {} does not exist", .0.display())]
    NoDirectory(PathBuf),
    #[error("has {}{found} bytes, expected {expected} of at most {most}", if *.is_all { "" } else { "more than " })]
    TooLarge { found: u64, is_all: bool, expected: &'static str, most: u64 },
    #[error("line {line} is longer than {most} bytes, expected lines of text")]
    LongLine { line: u64, most: u64 },
    #[error("is a pipe or a device, expected a regular file: {0} is read in several places")]
    NotRegular(&'static str),
    #[error("{found}, expected {expected}")]
    UnknownExtension { found: String, expected: String },
}

impl FileProblem {
    /// The problem of a file whose extension is none of those `expected`.
    #[must_use]
    pub fn unknown_extension(path: &Path, expected: &str) -> Self {
        let found = match path.extension() {
            Some(extension) => {
                format!("unknown file extension .{}", extension.to_string_lossy().to_lowercase())
            }
            None => "no file extension".to_owned(),
        };
        Self::UnknownExtension { found, expected: expected.to_owned() }
    }
}

/// Characters of a refusal; what stands in the middle of a longer one says least.
const MOST_CHARACTERS: usize = 400;
const OF_ITS_END: usize = 150;

/// The file and what is wrong with it, in at most 400 characters: the message of every error of a file.
#[must_use]
pub fn sentence(path: &Path, problem: &impl fmt::Display) -> String {
    let message = format!("{}: {problem}", path.display());
    let characters = message.chars().count();
    if characters <= MOST_CHARACTERS {
        return message;
    }
    let beginning: String = message.chars().take(MOST_CHARACTERS - OF_ITS_END - 5).collect();
    let end: String = message.chars().skip(characters - OF_ITS_END).collect();
    // Whole words of both.
    let beginning = beginning.rsplit_once(' ').map_or(beginning.as_str(), |(words, _)| words);
    let end = end.split_once(' ').map_or(end.as_str(), |(_, words)| words);
    format!("{beginning} ... {end}")
}

fn by(process: &Option<u32>) -> String {
    process.map(|process| format!(" (process {process})")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_sentence_loses_whole_words_of_its_middle() {
        let words: Vec<String> = (0..200).map(|i| format!("word{i}")).collect();
        let text = sentence(Path::new("log.csv"), &words.join(" "));
        assert!(text.chars().count() <= MOST_CHARACTERS);
        let (beginning, end) = text.split_once(" ... ").unwrap();
        let whole = |word: &str| words.iter().any(|other| other == word);
        assert!(beginning.split(' ').skip(1).chain(end.split(' ')).all(whole), "{text}");
    }
}
