//! Files that people edit by hand and a command writes anew: what was there is kept beside it.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::exit::Failure;
use crate::screen::Screen;

/// Copies what is at `path` to the first free one of `path.before`, `path.before2` and so on, unless nothing is there or what would
/// be written: `text`. Errors: it cannot be read or copied.
pub fn keep(path: &Path, text: &str, screen: &Screen) -> Result<(), Failure> {
    let failed = |error| Failure::Usage(format!("{}: cannot be kept: {error}", path.display()));
    let about = match fs::metadata(path) {
        Ok(about) => about,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(failed(error)),
    };
    if !about.is_file() {
        return Ok(());
    }
    let now = fs::read(path).map_err(failed)?;
    if now.is_empty() || now == text.as_bytes() {
        return Ok(());
    }
    let Some(kept) = (1..1000).map(|number| beside(path, number)).find(|name| !name.exists()) else {
        return Err(Failure::Usage(format!(
            "{}: a thousand former ones lie beside it, expected some to be put away",
            path.display()
        )));
    };
    fs::copy(path, &kept).map_err(failed)?;
    screen.remark(format!("{}: what was in {} before", kept.display(), path.display()));
    Ok(())
}

fn beside(path: &Path, number: u32) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".before");
    if number > 1 {
        name.push(number.to_string());
    }
    name.into()
}
