//! Text files in, up to a limit: what a path leads to may be anything.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

/// The text of a file of at most `most` bytes.
pub(crate) fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let refused = |found: String| {
        io::Error::new(io::ErrorKind::FileTooLarge, format!("has {found} bytes, expected at most {most}"))
    };
    let file = File::open(path)?;
    let about = file.metadata()?;
    if about.is_file() && about.len() > most {
        return Err(refused(about.len().to_string()));
    }
    let mut text = String::new();
    let mut limited = file.take(most + 1);
    limited.read_to_string(&mut text)?;
    if limited.limit() == 0 { Err(refused(format!("more than {most}"))) } else { Ok(text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_of_the_limit_is_read_and_one_byte_more_is_refused_with_the_size() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("scenario.toml");
        std::fs::write(&path, "0123456789").unwrap();
        assert_eq!(read_text(&path, 10).unwrap(), "0123456789");
        assert_eq!(read_text(&path, 9).unwrap_err().to_string(), "has 10 bytes, expected at most 9");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_has_no_end_is_refused_at_the_limit() {
        let text = read_text(Path::new("/dev/zero"), 1 << 20).unwrap_err().to_string();
        assert_eq!(text, "has more than 1048576 bytes, expected at most 1048576");
    }
}
