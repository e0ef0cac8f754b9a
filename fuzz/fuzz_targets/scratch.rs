//! The readers open files: a place in memory, where there is one, to put an input.

use std::{fs, process};
use std::path::{Path, PathBuf};

/// A new file with these bytes under a name of this process.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let memory = Path::new("/dev/shm");
    let directory = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
    let path = directory.join(format!("itpms-fuzz-{}-{name}", process::id()));
    let _ = fs::remove_file(&path);
    fs::write(&path, bytes).expect("the directory for temporary files can be written");
    path
}
