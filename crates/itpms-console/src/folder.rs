//! A folder that receives several files at the end of a command: known to be usable before the work begins, filled only
//! when all is complete.
//!
//! Used by the commands that make a page with its data.

use std::path::{Path, PathBuf};
use std::{fs, io};

use itpms_data::out::{AtomicFile, NewFolder};

use crate::exit::Failure;
use crate::former;
use crate::screen::Screen;

const PAGE: &str = "index.html";

/// The folder of a command's results.
pub struct Folder {
    path: PathBuf,
    /// Where it was made here: goes again if nothing gets into it.
    _made: Option<NewFolder>,
}

impl Folder {
    /// Makes the folder where there is none, and tries whether a file can be written into it.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let fail = |error: io::Error| Failure::Directory(path.to_owned(), error);
        if path.exists() && !path.is_dir() {
            let error = io::Error::new(io::ErrorKind::NotADirectory, "it is a file, expected a directory");
            return Err(fail(error));
        }
        let made = (!path.exists()).then(|| NewFolder::create(path)).transpose().map_err(fail)?;
        let folder = Self { path: path.to_owned(), _made: made };
        // Gone again at once.
        AtomicFile::create(&path.join(PAGE))?;
        Ok(folder)
    }

    /// Where a file of this name will be.
    pub fn at(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Names and contents; the files get their names when all are complete. A page that is there and has another title is
    /// another's, and is kept beside the new one.
    pub fn fill(
        &self,
        contents: impl IntoIterator<Item = (String, String)>,
        screen: &Screen,
    ) -> Result<(), Failure> {
        let mut files = Vec::new();
        for (name, content) in contents {
            let there = fs::read(self.at(&name)).unwrap_or_default();
            if name == PAGE && title(&String::from_utf8_lossy(&there)) != title(&content) {
                former::keep(&self.at(&name), &content, screen)?;
            }
            files.push(AtomicFile::settled(&self.at(&name), content.as_bytes())?);
        }
        for file in files {
            file.commit()?;
        }
        Ok(())
    }
}

fn title(page: &str) -> Option<&str> {
    page.split_once("<title>")?.1.split_once("</title>").map(|(title, _)| title)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]
mod tests {
    use super::*;
    use crate::options::Speaking;

    #[test]
    fn somebody_elses_page_is_kept_and_ones_own_is_written_anew() {
        let dir = tempfile::tempdir().unwrap();
        let page = |title: &str, text: &str| format!("<html><title>{title}</title>{text}</html>");
        fs::write(dir.path().join(PAGE), page("Holidays", "1998")).unwrap();
        let fill = |text: &str| {
            let folder = Folder::open(dir.path()).unwrap();
            folder
                .fill(
                    [(PAGE.to_owned(), page("Study", text))],
                    &Screen::new(Speaking { quiet: true, color: clap::ColorChoice::Never }, []),
                )
                .unwrap();
        };
        fill("one");
        fill("two");
        let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
        assert_eq!(read(PAGE), page("Study", "two"));
        assert_eq!(read("index.html.before"), page("Holidays", "1998"));
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }
}
