//! A name that one program at a time may use: a file that is renamed over cannot be locked itself, one beside it can.
//!
//! Called by programs that keep a file for as long as they run. The lock goes with the program that holds it, however that
//! ends; what a killed one leaves of it is an unlocked file that the next one takes.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process;

use crate::atomic::{directory_of, forget_living, note_living};
use crate::error::{FileError, FileProblem};

/// The lock on a name.
#[derive(Debug)]
pub struct NameLock {
    path: PathBuf,
    /// Locked for as long as it is open.
    _file: File,
}

impl NameLock {
    /// Takes the lock on `target`, which need not be there. `None` on a file system that locks nothing.
    ///
    /// # Errors
    /// Another program has it, or its directory cannot be written.
    pub fn take(target: &Path) -> Result<Option<Self>, FileError> {
        let fail = |error| FileError::new(target, FileProblem::Write(error));
        let path = beside(target).map_err(fail)?;
        loop {
            let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = options.map_err(fail)?;
            match file.try_lock() {
                // The program before let it go and took its name away.
                Ok(()) if !is_named(&file, &path) => continue,
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(FileError::new(target, FileProblem::InUse { process: holder(&mut file) }));
                }
                Err(TryLockError::Error(_)) => return Ok(None),
            }
            // Who holds it is for the message alone.
            let _ = file.set_len(0).and_then(|()| write!(file, "{}", process::id()));
            note_living(&path);
            return Ok(Some(Self { path, _file: file }));
        }
    }
}

impl Drop for NameLock {
    fn drop(&mut self) {
        // While it is still locked, so that none but ours goes.
        let _ = fs::remove_file(&self.path);
        forget_living(&self.path);
    }
}

/// `.NAME.lock` in the directory of the file itself: a link and what it leads to are one.
fn beside(target: &Path) -> io::Result<PathBuf> {
    let file = match fs::canonicalize(target) {
        Ok(file) => file,
        Err(_) => fs::canonicalize(directory_of(target))?.join(target.file_name().unwrap_or_default()),
    };
    let mut name = std::ffi::OsString::from(".");
    name.push(file.file_name().unwrap_or_default());
    name.push(".lock");
    Ok(file.with_file_name(name))
}

/// Whether an open file is still the one under its name.
#[cfg(unix)]
fn is_named(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let same = |a: &fs::Metadata, b: &fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    matches!((&file.metadata(), &fs::metadata(path)), (Ok(a), Ok(b)) if same(a, b))
}

/// Other systems: a file that is open keeps its name.
#[cfg(not(unix))]
fn is_named(_file: &File, path: &Path) -> bool {
    path.exists()
}

fn holder(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.take(16).read_to_string(&mut text).ok()?;
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time_and_nothing_stays() {
        let dir = tempfile::tempdir().unwrap();
        let state = dir.path().join("car7.state");
        let first = NameLock::take(&state).unwrap().unwrap();
        let message = NameLock::take(&state).unwrap_err().to_string();
        let expected = format!("is used by another program (process {})", process::id());
        assert!(message.contains("car7.state: ") && message.contains(&expected), "{message}");
        assert!(NameLock::take(&dir.path().join("car8.state")).is_ok());
        drop(first);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
        // A killed program's lock is taken over.
        fs::write(dir.path().join(".car7.state.lock"), "4000000000").unwrap();
        drop(NameLock::take(&state).unwrap().unwrap());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
        assert!(NameLock::take(&dir.path().join("missing/car7.state")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_what_it_leads_to() {
        let dir = tempfile::tempdir().unwrap();
        let [state, link] = ["car7.state", "link.state"].map(|name| dir.path().join(name));
        fs::write(&state, "").unwrap();
        std::os::unix::fs::symlink(&state, &link).unwrap();
        let _held = NameLock::take(&state).unwrap().unwrap();
        assert!(NameLock::take(&link).is_err());
    }

    #[test]
    fn of_many_threads_one_at_a_time_has_it() {
        use std::sync::atomic::{AtomicU32, Ordering};
        let dir = tempfile::tempdir().unwrap();
        let state = dir.path().join("car7.state");
        let (inside, taken) = (AtomicU32::new(0), AtomicU32::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    while taken.load(Ordering::SeqCst) < 500 {
                        let Ok(Some(_lock)) = NameLock::take(&state) else { continue };
                        assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                        inside.fetch_sub(1, Ordering::SeqCst);
                        taken.fetch_add(1, Ordering::SeqCst);
                    }
                });
            }
        });
    }
}
