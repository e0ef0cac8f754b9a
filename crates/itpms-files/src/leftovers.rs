//! Temporary files of programs that were killed while they wrote: found by their names, known by not being locked.
//!
//! Called by [`AtomicFile`](super::AtomicFile) alone. Tidying up never fails and never stops a writer: what cannot be
//! known to be a leftover stays.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::Path;

use crate::checksum::crc64;

/// How a temporary's name ends.
pub(crate) const SUFFIX: &str = ".tmp";

/// Bytes of a name that has room for what a temporary's has more, in the 255 that file systems give.
const LONGEST: usize = 220;

/// How the names of the temporaries of `name` begin; process id, a dash and a number follow.
pub(crate) fn prefix(name: &OsStr) -> OsString {
    let mut prefix = OsString::from(".");
    if name.len() > LONGEST {
        prefix.push(format!("{:016x}", crc64(&[name.as_encoded_bytes()])));
    } else {
        prefix.push(name);
    }
    prefix.push(".");
    prefix
}

/// Locks a temporary that has just been made; false if it was taken for a leftover meanwhile.
pub(crate) fn claim(file: &File, path: &Path) -> bool {
    match file.try_lock() {
        // Whoever tidied up held the lock and let it go, but the name is gone.
        Ok(()) => path.exists(),
        Err(TryLockError::WouldBlock) => false,
        // A file system without locks: no one tidies up there either.
        Err(TryLockError::Error(_)) => true,
    }
}

/// Removes the temporaries of `name` in `directory` that no living program writes, except `own`.
pub(crate) fn remove(directory: &Path, name: &OsStr, own: &Path) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    let prefix = prefix(name);
    for entry in entries.flatten() {
        let path = entry.path();
        let regular = entry.file_type().is_ok_and(|kind| kind.is_file());
        if regular && path != own && is_temporary(&entry.file_name(), &prefix) {
            remove_unlocked(&path);
        }
    }
}

fn remove_unlocked(path: &Path) {
    // Opened for writing, as some file systems lock nothing else; not created, not truncated.
    let Ok(file) = OpenOptions::new().write(true).open(path) else { return };
    if file.try_lock().is_ok() {
        let _ = fs::remove_file(path);
    }
}

/// Whether a name is `prefix`, digits, a dash, digits, and [`SUFFIX`].
fn is_temporary(name: &OsStr, prefix: &OsStr) -> bool {
    let rest = name.as_encoded_bytes().strip_prefix(prefix.as_encoded_bytes());
    let Some(middle) = rest.and_then(|rest| rest.strip_suffix(SUFFIX.as_bytes())) else { return false };
    let digits = |part: &[u8]| !part.is_empty() && part.iter().all(u8::is_ascii_digit);
    middle.iter().position(|byte| *byte == b'-').is_some_and(|dash| {
        let (process, number) = middle.split_at(dash);
        digits(process) && number.get(1..).is_some_and(digits)
    })
}
