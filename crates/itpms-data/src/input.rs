//! Files in: opened, or why not. Used by every reader of this crate.

use std::fs::{self, File, Metadata};
use std::io::{self, Read as _};
use std::path::Path;

use crate::error::Problem;

/// Bytes of a line of text, at most: no row of numbers is longer; what is, is no text.
pub(crate) const MOST_OF_A_LINE: u64 = 1 << 20;

/// Bytes of a file that a person writes, at most: a vehicle, a map of signals.
const MOST_OF_A_TEXT: u64 = 1 << 20;

/// Whether this is the name that stands for standard input.
pub(crate) fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// The file of a name, `-` being standard input.
fn named(path: &Path) -> &Path {
    if is_stdin(path) { Path::new("/dev/stdin") } else { path }
}

/// What is under this name, if it is something to be read.
pub(crate) fn look(path: &Path) -> Result<Metadata, Problem> {
    let about = fs::metadata(named(path)).map_err(refused)?;
    if about.is_dir() { Err(Problem::IsDirectory) } else { Ok(about) }
}

/// The same for a drive log, which may be a folder of part files.
pub(crate) fn look_at_log(path: &Path) -> Result<Metadata, Problem> {
    #[cfg(feature = "parquet")]
    if crate::parquet_columns::is_folder_of_parts(path) {
        return fs::metadata(path).map_err(refused);
    }
    look(path)
}

/// Opens a file, or a pipe, for reading.
pub(crate) fn open(path: &Path) -> Result<(File, Metadata), Problem> {
    // Asked before it is opened: not every system opens a directory and then says so.
    let about = look(path)?;
    Ok((File::open(named(path)).map_err(refused)?, about))
}

/// Opens a file of a `format` that is not read from beginning to end. A pipe is refused before it is opened, which would wait
/// for someone who writes to it.
#[cfg(any(feature = "can", feature = "mdf4", feature = "parquet"))]
pub(crate) fn open_regular(path: &Path, format: &'static str) -> Result<(File, Metadata), Problem> {
    if look(path)?.is_file() { open(path) } else { Err(Problem::NotRegular(format)) }
}

/// All bytes of a file, or a pipe, that is to be `expected` and to have no more than `most`.
pub(crate) fn read(path: &Path, most: u64, expected: &'static str) -> Result<Vec<u8>, Problem> {
    read_after(path, most, expected, |_| Ok(()))
}

/// The same, if `check` likes the beginning, which is up to a MiB: what is nothing of the kind is not read to its end.
pub(crate) fn read_after(
    path: &Path,
    most: u64,
    expected: &'static str,
    check: impl Fn(&[u8]) -> Result<(), Problem>,
) -> Result<Vec<u8>, Problem> {
    let (mut file, about) = open(path)?;
    if about.is_file() && about.len() > most {
        return Err(Problem::TooLarge { found: about.len(), is_all: true, expected, most });
    }
    let mut bytes = Vec::new();
    // One more than is taken shows that there are more.
    let beginning = most.min(MOST_OF_A_TEXT) + 1;
    (&mut file).take(beginning).read_to_end(&mut bytes).map_err(Problem::Read)?;
    check(&bytes)?;
    if bytes.len() as u64 == beginning {
        file.take(most + 1 - beginning).read_to_end(&mut bytes).map_err(Problem::Read)?;
    }
    if bytes.len() as u64 > most {
        return Err(Problem::TooLarge { found: most, is_all: false, expected, most });
    }
    Ok(bytes)
}

/// The text of a file that a person writes.
pub(crate) fn read_text(path: &Path, expected: &'static str) -> Result<String, Problem> {
    let bytes = read(path, MOST_OF_A_TEXT, expected)?;
    String::from_utf8(bytes).map_err(|error| Problem::Read(io::Error::new(io::ErrorKind::InvalidData, error)))
}

fn refused(error: io::Error) -> Problem {
    match error.kind() {
        io::ErrorKind::NotFound => Problem::NotFound,
        _ => Problem::Read(error),
    }
}
