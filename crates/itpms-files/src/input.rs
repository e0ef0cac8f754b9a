//! Files in: opened, or why not. Used by every reader.

use std::fs::{self, File, Metadata};
use std::io::{self, Read as _};
use std::path::Path;

use crate::error::FileProblem;

/// Bytes of a line of text, at most: no row of numbers is longer; what is, is no text.
pub const MOST_OF_A_LINE: u64 = 1 << 20;

/// Bytes of a file that a person writes, at most: a vehicle, a map of signals.
const MOST_OF_A_TEXT: u64 = 1 << 20;

/// Whether this is the name that stands for standard input.
#[must_use]
pub fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// The file of a name, `-` being standard input.
fn named(path: &Path) -> &Path {
    if is_stdin(path) { Path::new("/dev/stdin") } else { path }
}

/// Metadata of the file of this name, if it can be read.
///
/// # Errors
/// Nothing is there, or a directory.
pub fn look(path: &Path) -> Result<Metadata, FileProblem> {
    let about = fs::metadata(named(path)).map_err(refused)?;
    if about.is_dir() { Err(FileProblem::IsDirectory) } else { Ok(about) }
}

/// Opens a file, or a pipe, for reading.
///
/// # Errors
/// It is not there, is a directory, or cannot be opened.
pub fn open(path: &Path) -> Result<(File, Metadata), FileProblem> {
    // Asked before it is opened: not every system opens a directory and then says so.
    let about = look(path)?;
    Ok((File::open(named(path)).map_err(refused)?, about))
}

/// Opens a file of a `format` that is not read from beginning to end. A pipe is refused before it is opened, which would wait
/// for someone who writes to it.
///
/// # Errors
/// It is not there, is no regular file, or cannot be opened.
pub fn open_regular(path: &Path, format: &'static str) -> Result<(File, Metadata), FileProblem> {
    if look(path)?.is_file() { open(path) } else { Err(FileProblem::NotRegular(format)) }
}

/// All bytes of a file, or a pipe, that is to be `expected` and to have no more than `most`.
///
/// # Errors
/// It cannot be read, or has more.
pub fn read(path: &Path, most: u64, expected: &'static str) -> Result<Vec<u8>, FileProblem> {
    read_after(path, most, expected, |_| Ok(()))
}

/// The same, if `check` likes the beginning, which is up to a MiB: what is nothing of the kind is not read to its end.
///
/// # Errors
/// As [`read`]; what `check` refuses.
pub fn read_after<E: From<FileProblem>>(
    path: &Path,
    most: u64,
    expected: &'static str,
    check: impl Fn(&[u8]) -> Result<(), E>,
) -> Result<Vec<u8>, E> {
    let (mut file, about) = open(path)?;
    if about.is_file() && about.len() > most {
        return Err(FileProblem::TooLarge { found: about.len(), is_all: true, expected, most }.into());
    }
    let mut bytes = Vec::new();
    // One more than is taken shows that there are more.
    let beginning = most.min(MOST_OF_A_TEXT) + 1;
    (&mut file).take(beginning).read_to_end(&mut bytes).map_err(FileProblem::Read)?;
    check(&bytes)?;
    if bytes.len() as u64 == beginning {
        file.take(most + 1 - beginning).read_to_end(&mut bytes).map_err(FileProblem::Read)?;
    }
    if bytes.len() as u64 > most {
        return Err(FileProblem::TooLarge { found: most, is_all: false, expected, most }.into());
    }
    Ok(bytes)
}

/// The text of a file that a person writes.
///
/// # Errors
/// It cannot be read, has more than a MiB, or is not UTF-8.
pub fn read_text(path: &Path, expected: &'static str) -> Result<String, FileProblem> {
    let bytes = read(path, MOST_OF_A_TEXT, expected)?;
    String::from_utf8(bytes)
        .map_err(|error| FileProblem::Read(io::Error::new(io::ErrorKind::InvalidData, error)))
}

/// Why a file cannot be looked at or opened.
#[must_use]
pub fn refused(error: io::Error) -> FileProblem {
    match error.kind() {
        io::ErrorKind::NotFound => FileProblem::NotFound,
        _ => FileProblem::Read(error),
    }
}
