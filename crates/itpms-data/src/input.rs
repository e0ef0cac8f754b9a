//! Files in: opened, or why not. Used by every reader of this crate.

use std::fs::{self, File, Metadata};
use std::io::{self, Read as _};
use std::path::Path;

use crate::error::Problem;

/// Opens a file, or a pipe, for reading.
pub(crate) fn open(path: &Path) -> Result<(File, Metadata), Problem> {
    // Asked before it is opened: not every system opens a directory and then says so.
    let about = fs::metadata(path).map_err(refused)?;
    if about.is_dir() {
        return Err(Problem::IsDirectory);
    }
    Ok((File::open(path).map_err(refused)?, about))
}

/// All bytes of a file that is to have no more than `most`; else `too_large` makes a problem of its length.
pub(crate) fn read(
    path: &Path,
    most: u64,
    too_large: impl FnOnce(u64) -> Problem,
) -> Result<Vec<u8>, Problem> {
    let (file, about) = open(path)?;
    let mut bytes = Vec::new();
    // One more than is taken shows that there are more.
    file.take(most + 1).read_to_end(&mut bytes).map_err(Problem::Read)?;
    if bytes.len() as u64 > most {
        return Err(too_large(about.len().max(most + 1)));
    }
    Ok(bytes)
}

fn refused(error: io::Error) -> Problem {
    match error.kind() {
        io::ErrorKind::NotFound => Problem::NotFound,
        _ => Problem::Read(error),
    }
}
