//! A file of lines that only grows: a line that was appended is on the disk, and one that a killed program or a power cut
//! left in the middle is gone when the file is opened again.
//!
//! Called by computations of many hours that go on where they were stopped. One program at a time: the file is locked.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{DataError, FileProblem};

/// A growing file of lines.
#[derive(Debug)]
pub struct Ledger {
    path: PathBuf,
    file: File,
}

impl Ledger {
    /// Opens or begins the file; gives its complete lines, and cuts off what is left of an unfinished one.
    /// Errors: it cannot be read or written, or another program has it open.
    pub fn open(path: &Path) -> Result<(Self, Vec<String>), DataError> {
        let fail = |error| DataError::new(path, FileProblem::Write(error));
        let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = options.map_err(fail)?;
        file.try_lock().map_err(|error| match error {
            TryLockError::Error(error) => fail(error),
            TryLockError::WouldBlock => {
                fail(io::Error::new(io::ErrorKind::WouldBlock, "another program is writing it"))
            }
        })?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(|error| DataError::new(path, FileProblem::Read(error)))?;
        let complete = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        if complete < bytes.len() {
            file.set_len(complete as u64).map_err(fail)?;
            file.sync_data().map_err(fail)?;
        }
        file.seek(SeekFrom::Start(complete as u64)).map_err(fail)?;
        bytes.truncate(complete);
        // A line that is no text any more is the reader's to judge, like one with another digit.
        let lines = String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect();
        Ok((Self { path: path.to_owned(), file }, lines))
    }

    /// Appends a line; when this returns, it is on the disk.
    pub fn append(&mut self, line: &str) -> Result<(), DataError> {
        let fail = |error| DataError::new(&self.path, FileProblem::Write(error));
        if line.contains('\n') {
            return Err(fail(io::Error::new(io::ErrorKind::InvalidInput, "a line break within a line")));
        }
        // One write, so that a reader sees a line or none.
        self.file.write_all(format!("{line}\n").as_bytes()).map_err(fail)?;
        self.file.sync_data().map_err(fail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_and_a_torn_one_goes() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("hours.jsonl");
        let (mut ledger, lines) = Ledger::open(&path).unwrap();
        assert!(lines.is_empty());
        ledger.append("one").unwrap();
        ledger.append("two").unwrap();
        assert!(ledger.append("a\nb").is_err());
        drop(ledger);
        let whole = std::fs::read(&path).unwrap();
        // Killed after any byte of a third line.
        for torn in ["", "t", "three"] {
            std::fs::write(&path, [whole.as_slice(), torn.as_bytes()].concat()).unwrap();
            let (mut ledger, lines) = Ledger::open(&path).unwrap();
            assert_eq!(lines, ["one", "two"]);
            ledger.append("3").unwrap();
            drop(ledger);
            assert_eq!(std::fs::read_to_string(&path).unwrap(), "one\ntwo\n3\n");
        }
    }

    #[test]
    fn one_program_at_a_time() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("hours.jsonl");
        let first = Ledger::open(&path).unwrap();
        let message = Ledger::open(&path).unwrap_err().to_string();
        assert!(message.contains("another program is writing it"), "{message}");
        drop(first);
        assert!(Ledger::open(&path).is_ok());
        assert!(Ledger::open(&dir.path().join("missing/hours.jsonl")).is_err());
    }
}
