//! The names of files in and out of a command: none may be written that is read, and none twice.

use std::fs;
use std::path::{Path, PathBuf};

use crate::exit::Failure;

/// Refuses an output that is one of the inputs (each with a word for what it is), or two outputs of one name, however it is
/// spelled. Devices and `-` may be given as often as one likes.
pub fn check(inputs: &[(Option<&Path>, &str)], outputs: &[Option<&Path>]) -> Result<(), Failure> {
    let outputs: Vec<&Path> = outputs.iter().copied().flatten().filter(|path| !is_stream(path)).collect();
    for (i, output) in outputs.iter().enumerate() {
        let (name, file) = (output.display(), real(output));
        for (input, what) in inputs {
            if input.is_some_and(|input| real(input) == file) {
                return Err(Failure::Usage(format!(
                    "{name}: is {what} itself, expected another name to write to"
                )));
            }
        }
        if outputs[..i].iter().any(|other| real(other) == file) {
            return Err(Failure::Usage(format!(
                "{name}: is given for two outputs, expected a name for each"
            )));
        }
    }
    Ok(())
}

fn is_stream(path: &Path) -> bool {
    path == Path::new("-") || fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir())
}

/// The file behind a name, or for one that is not there yet its folder's and its own name.
fn real(path: &Path) -> PathBuf {
    let folder = || {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(parent).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(folder).unwrap_or_else(|| path.to_owned())
}
