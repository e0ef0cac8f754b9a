//! A folder that receives several files at the end of a command: known to be usable before the work begins, filled only
//! when all is complete.
//!
//! Used by the commands that make a page with its data.

use std::io;
use std::path::{Path, PathBuf};

use itpms_data::out::{AtomicFile, NewFolder};

use crate::exit::Failure;

/// The folder of a command's results.
pub(crate) struct Folder {
    path: PathBuf,
    /// Where it was made here: goes again if nothing gets into it.
    _made: Option<NewFolder>,
}

impl Folder {
    /// Makes the folder where there is none, and tries whether a file can be written into it.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let fail = |error: io::Error| Failure::Directory(path.to_owned(), error);
        if path.exists() && !path.is_dir() {
            let error = io::Error::new(io::ErrorKind::NotADirectory, "it is a file, expected a directory");
            return Err(fail(error));
        }
        let made = (!path.exists()).then(|| NewFolder::create(path)).transpose().map_err(fail)?;
        let folder = Self { path: path.to_owned(), _made: made };
        // Gone again at once.
        AtomicFile::create(&path.join("index.html"))?;
        Ok(folder)
    }

    /// Where a file of this name will be.
    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Names and contents; the files get their names when all are complete.
    pub(crate) fn fill(&self, contents: impl IntoIterator<Item = (String, String)>) -> Result<(), Failure> {
        let mut files = Vec::new();
        for (name, content) in contents {
            let mut file = AtomicFile::create(&self.at(&name))?;
            file.append(content.as_bytes())?;
            file.settle()?;
            files.push(file);
        }
        for file in files {
            file.commit()?;
        }
        Ok(())
    }
}
