//! A file that is either complete under its name or not there: written beside its target, renamed at the end.
//!
//! Used by every writer of results and logs; knows nothing of formats.
//!
//! Also after a power cut: the bytes are on the disk before the name is theirs, and the directory is ordered to be written
//! after it. What a killed program left beside its target is removed by the next one that writes there.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{FileError, FileProblem};
use crate::leftovers;

/// An output in the making.
///
/// Devices and pipes (`/dev/stdout`, `/dev/full`) have no place beside them and are written directly.
#[derive(Debug)]
pub struct AtomicFile {
    target: PathBuf,
    /// Where the bytes go until [`AtomicFile::commit`]; `None` for a device, which receives them at once.
    temporary: Option<Temporary>,
    file: BufWriter<File>,
}

/// A file that is removed when dropped under its temporary name.
#[derive(Debug)]
struct Temporary {
    path: PathBuf,
    /// The target with links resolved, so that a link stays one.
    destination: PathBuf,
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After a successful rename there is nothing under this name, which is as good as removed.
        let _ = fs::remove_file(&self.path);
        forget_living(&self.path);
    }
}

/// A folder that was made for files to come: it goes again if it is dropped, or abandoned, before any is there.
#[derive(Debug)]
pub struct NewFolder {
    path: PathBuf,
}

impl NewFolder {
    /// Makes the folder, and those above it.
    ///
    /// # Errors
    /// It cannot be made there.
    pub fn create(path: &Path) -> io::Result<Self> {
        fs::create_dir_all(path)?;
        note_living(path);
        Ok(Self { path: path.to_owned() })
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        // Does nothing to a folder that holds something.
        let _ = fs::remove_dir(&self.path);
        forget_living(&self.path);
    }
}

/// What goes with this process: its temporaries and locks, and folders that are empty without them.
fn living() -> MutexGuard<'static, Vec<PathBuf>> {
    static LIVING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    LIVING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Adds to what goes with this process.
pub(crate) fn note_living(path: &Path) {
    living().push(path.to_owned());
}

pub(crate) fn forget_living(path: &Path) {
    living().retain(|living| living != path);
}

/// Removes every unfinished file of this process, and the folders that it made and that hold nothing else. For a program that is about to end while another of its threads waits for
/// something that may never come, and can no longer drop what it holds.
pub fn abandon_all() {
    // The newest first: a folder after what was to be in it.
    for path in living().drain(..).rev() {
        let _ = if path.is_dir() { fs::remove_dir(path) } else { fs::remove_file(path) };
    }
}

impl AtomicFile {
    /// Starts the file that will be called `target`.
    ///
    /// # Errors
    /// The target is a directory or read-only, its directory does not exist or cannot be written.
    pub fn create(target: &Path) -> Result<Self, FileError> {
        let fail = |problem| FileError::new(target, problem);
        // What everybody calls standard output.
        let target = if target == Path::new("-") { Path::new("/dev/stdout") } else { target };
        match fs::metadata(target) {
            Ok(existing) if existing.is_dir() => return Err(fail(FileProblem::IsDirectory)),
            Ok(existing) if !existing.is_file() || is_device_path(target) => {
                let file =
                    OpenOptions::new().write(true).open(target).map_err(|e| fail(FileProblem::Write(e)))?;
                return Ok(Self { target: target.to_owned(), temporary: None, file: BufWriter::new(file) });
            }
            Ok(existing) if existing.permissions().readonly() => {
                let error = io::Error::new(io::ErrorKind::PermissionDenied, "the existing file is read-only");
                return Err(fail(FileProblem::Write(error)));
            }
            _ => {}
        }
        let destination = fs::canonicalize(target).unwrap_or_else(|_| behind_links(target));
        let directory = directory_of(&destination);
        let Some(name) = destination.file_name() else { return Err(fail(FileProblem::IsDirectory)) };
        if !directory.exists() {
            return Err(fail(FileProblem::NoDirectory(directory.to_owned())));
        }
        let (path, file) = create_beside(directory, name).map_err(|error| fail(FileProblem::Write(error)))?;
        leftovers::remove(directory, name, &path);
        // From here on the temporary removes itself.
        note_living(&path);
        let temporary = Temporary { path, destination };
        if let Ok(existing) = fs::metadata(&temporary.destination) {
            // The new content keeps the old file's mode; failing to is no reason not to write.
            let _ = fs::set_permissions(&temporary.path, existing.permissions());
        }
        Ok(Self { target: target.to_owned(), temporary: Some(temporary), file: BufWriter::new(file) })
    }

    /// The complete file, to be [committed](Self::commit) together with others.
    ///
    /// # Errors
    /// As for [`create`](Self::create) and [`settle`](Self::settle).
    pub fn settled(target: &Path, bytes: &[u8]) -> Result<Self, FileError> {
        let mut file = Self::create(target)?;
        file.append(bytes)?;
        file.settle()?;
        Ok(file)
    }

    /// The same with its name.
    ///
    /// # Errors
    /// As for [`create`](Self::create) and [`commit`](Self::commit).
    pub fn save(target: &Path, bytes: &[u8]) -> Result<(), FileError> {
        let mut file = Self::create(target)?;
        file.append(bytes)?;
        file.commit()
    }

    /// The name the file will have.
    #[must_use]
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Whether the target is a device or a pipe rather than a file.
    #[must_use]
    pub fn is_device(&self) -> bool {
        self.temporary.is_none()
    }

    /// Adds bytes.
    ///
    /// # Errors
    /// The disk is full or the device gone.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), FileError> {
        self.file.write_all(bytes).map_err(|error| FileError::new(&self.target, FileProblem::Write(error)))
    }

    /// Replaces bytes that were added before, beginning `at` bytes from the start; what is added next goes to the end
    /// again. For formats whose head says what only their end knows.
    ///
    /// # Errors
    /// A device or pipe, which forgets; bytes that were not added yet; the disk is full.
    pub fn replace(&mut self, at: u64, bytes: &[u8]) -> Result<(), FileError> {
        let replaced = |file: &mut BufWriter<File>| {
            let end = file.stream_position()?;
            if at.checked_add(bytes.len() as u64).is_none_or(|last| last > end) {
                return Err(io::Error::new(io::ErrorKind::InvalidInput, "replaces what is not there"));
            }
            file.seek(SeekFrom::Start(at))?;
            file.write_all(bytes)?;
            file.seek(SeekFrom::Start(end)).map(drop)
        };
        let done = if self.is_device() {
            Err(io::Error::new(io::ErrorKind::NotSeekable, "a device or pipe cannot be written twice"))
        } else {
            replaced(&mut self.file)
        };
        done.map_err(|error| FileError::new(&self.target, FileProblem::Write(error)))
    }

    /// Brings everything written so far onto the disk. After this, [`AtomicFile::commit`] is a rename; with several
    /// outputs, settle all of them before the first is committed.
    ///
    /// # Errors
    /// The disk is full or the device gone.
    pub fn settle(&mut self) -> Result<(), FileError> {
        self.file
            .flush()
            .and_then(|()| if self.is_device() { Ok(()) } else { self.file.get_ref().sync_all() })
            .map_err(|error| FileError::new(&self.target, FileProblem::Write(error)))
    }

    /// Completes the file and gives it its name. When this returns without an error, a power cut no longer takes the
    /// file away; when the power fails before, the old one is still there.
    ///
    /// # Errors
    /// The disk is full, or the directory no longer lets the file be renamed.
    pub fn commit(mut self) -> Result<(), FileError> {
        self.settle()?;
        match &self.temporary {
            None => Ok(()),
            Some(temporary) => fs::rename(&temporary.path, &temporary.destination)
                .and_then(|()| sync_directory(&temporary.destination))
                .map_err(|error| FileError::new(&self.target, FileProblem::Write(error))),
        }
    }
}

/// For writers that want an [`io::Write`]; the caller adds the name to the error.
impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// `/dev/stdout` and the like may lead to a regular file that another process holds open: renaming over it would
/// leave that process with the old one.
fn is_device_path(path: &Path) -> bool {
    path.starts_with("/dev") || path.starts_with("/proc")
}

/// Puts the new name of a file onto the disk: a name lives in its directory.
#[cfg(unix)]
fn sync_directory(file: &Path) -> io::Result<()> {
    match File::open(directory_of(file))?.sync_all() {
        // Some network file systems know no such thing; they write names at once.
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
        other => other,
    }
}

/// Other systems: a directory cannot be opened as a file; the system's journal has to do.
#[cfg(not(unix))]
fn sync_directory(_file: &Path) -> io::Result<()> {
    Ok(())
}

/// Where a link leads at whose end nothing is yet; a name that is no link is its own.
fn behind_links(path: &Path) -> PathBuf {
    // As many links in a row as a system follows.
    const MOST: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST {
        let Ok(next) = fs::read_link(&path) else { break };
        path = directory_of(&path).join(next);
    }
    path
}

pub(crate) fn directory_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A new file `.NAME.PID-N.tmp` in `directory`, locked for as long as it is open.
fn create_beside(directory: &Path, name: &OsStr) -> io::Result<(PathBuf, File)> {
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    loop {
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let mut temporary = leftovers::prefix(name);
        temporary.push(format!("{}-{number}{}", process::id(), leftovers::SUFFIX));
        let path = directory.join(temporary);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) if leftovers::claim(&file, &path) => return Ok((path, file)),
            // One who tidies up took it for a leftover before it was locked: take the next number.
            Ok(_) => {}
            // Left over from a killed run with the same process id: the same.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn nothing_is_there_before_commit_and_nothing_is_left_after_drop() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("est.csv");
        let mut file = AtomicFile::create(&target).unwrap();
        file.append(b"half a result").unwrap();
        assert!(!target.exists());
        drop(file);
        assert_eq!(names(dir.path()), Vec::<String>::new());

        let mut file = AtomicFile::create(&target).unwrap();
        file.append(b"all of it").unwrap();
        file.commit().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"all of it");
        assert_eq!(names(dir.path()), ["est.csv"]);
    }

    #[test]
    fn what_was_added_can_be_replaced_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("counted.bin");
        let mut file = AtomicFile::create(&target).unwrap();
        file.append(b"0 rows: a, b").unwrap();
        file.replace(0, b"2").unwrap();
        file.append(b", end").unwrap();
        assert!(file.replace(17, b"x").is_err());
        assert!(file.replace(u64::MAX, b"x").is_err());
        file.commit().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"2 rows: a, b, end");
    }

    #[test]
    fn an_older_result_stays_until_the_new_one_is_complete() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("est.csv");
        fs::write(&target, "old").unwrap();
        let mut file = AtomicFile::create(&target).unwrap();
        file.append(b"new").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"old");
        drop(file);
        assert_eq!(fs::read(&target).unwrap(), b"old");
    }

    #[test]
    fn what_a_killed_program_left_is_removed_and_what_a_living_one_writes_is_not() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("est.csv");
        let leftover = dir.path().join(".est.csv.4000000000-7.tmp");
        let others =
            [".est.csv.notes.tmp", ".est.csv.1-.tmp", ".other.csv.4000000000-7.tmp", "est.csv.1-1.tmp"];
        fs::write(&leftover, "half").unwrap();
        others.iter().for_each(|name| fs::write(dir.path().join(name), "").unwrap());
        let mut living = AtomicFile::create(&target).unwrap();
        assert!(!leftover.exists());
        living.append(b"the first").unwrap();
        let mut second = AtomicFile::create(&target).unwrap();
        second.append(b"the second").unwrap();
        second.commit().unwrap();
        living.commit().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"the first");
        let mut left = names(dir.path());
        left.sort();
        let mut expected = [&others[..], &["est.csv"]].concat();
        expected.sort_unstable();
        assert_eq!(left, expected);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_and_the_mode_is_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let dir = tempfile::tempdir().unwrap();
        let (real, link) = (dir.path().join("real.csv"), dir.path().join("link.csv"));
        fs::write(&real, "old").unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&real, &link).unwrap();
        let mut file = AtomicFile::create(&link).unwrap();
        file.append(b"new").unwrap();
        file.commit().unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
        // Also where it leads to nothing yet.
        let ahead = dir.path().join("ahead.csv");
        symlink("later.csv", &ahead).unwrap();
        AtomicFile::create(&ahead).unwrap().commit().unwrap();
        assert!(fs::symlink_metadata(&ahead).unwrap().file_type().is_symlink());
        assert!(dir.path().join("later.csv").is_file());
        assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[test]
    fn places_that_cannot_be_written_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let message = |path: &Path| AtomicFile::create(path).unwrap_err().to_string();
        assert!(message(dir.path()).ends_with("is a directory, expected a file"));
        // As long as a name may be: what is added to it meanwhile is not.
        let long = dir.path().join("n".repeat(251) + ".csv");
        AtomicFile::create(&long).unwrap().commit().unwrap();
        assert!(long.exists());
        let orphan = dir.path().join("missing").join("est.csv");
        let text = message(&orphan);
        assert!(text.contains("est.csv") && text.ends_with("missing does not exist"), "{text}");

        let locked = dir.path().join("locked.csv");
        fs::write(&locked, "").unwrap();
        let mut permissions = fs::metadata(&locked).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&locked, permissions).unwrap();
        assert!(message(&locked).contains("read-only"));
        assert!(message(&dir.path().join("locked.csv").join("est.csv")).contains("cannot be written"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_with_the_files_name() {
        let mut file = AtomicFile::create(Path::new("/dev/full")).unwrap();
        assert!(file.is_device());
        file.append(b"a few bytes that stay in the buffer").unwrap();
        let text = file.commit().unwrap_err().to_string();
        assert!(text.starts_with("/dev/full: cannot be written: No space left"), "{text}");
    }
}
