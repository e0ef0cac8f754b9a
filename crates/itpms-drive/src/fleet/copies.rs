//! Files that hold a drive once more, packed. It would count twice, as a drive, as a day, and as a calibration.
//!
//! Called where files are given to their cars. Two cars may have the same file: which of them it is of is not to be seen here.

use super::found::Found;

/// Why a file is left out beside these others of its car, as what follows "drive2.csv: "; `None` of a drive of its own. Of
/// `drive.csv` and `drive.csv.gz` the one counts that is not packed.
pub(super) fn copy_of<'a>(file: &Found, others: impl Iterator<Item = &'a Found>) -> Option<String> {
    let packed = file.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let unpacked = packed.then(|| file.path.with_extension(""));
    for other in others {
        if unpacked.as_ref() == Some(&other.path) {
            return Some(format!("is {} once more, packed: left out", other.path.display()));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::found;
    use super::*;

    #[test]
    fn a_drive_that_is_there_twice_counts_once() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        for (name, text) in [
            ("a.csv", "one drive"),
            ("b.csv", "two drive"),
            ("b.csv.gz", "packed"),
            ("c.csv.gz", "another"),
            ("d.csv", ""),
            ("e.csv", ""),
        ] {
            std::fs::write(at(name), text).unwrap();
        }
        let files = found::files(&[at("*")], &at("out")).unwrap();
        let why = |name: &str| {
            let place = files.iter().position(|file| file.path == at(name)).unwrap();
            copy_of(&files[place], files[..place].iter())
        };
        let packed = format!("is {} once more, packed: left out", at("b.csv").display());
        assert_eq!(why("b.csv.gz"), Some(packed));
        for name in ["a.csv", "b.csv", "c.csv.gz", "d.csv", "e.csv"] {
            assert_eq!(why(name), None, "{name}");
        }
    }
}
