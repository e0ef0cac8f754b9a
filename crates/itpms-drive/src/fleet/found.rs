//! Which files are meant, in which order.

use std::cmp::Ordering;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use crate::error::DriveError;

/// A file that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// As it was named, or as the pattern gave it.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// When it was last changed: s and ns since 1970, as text.
    pub modified: String,
}

impl Found {
    fn of(path: &Path) -> Self {
        let about = path.metadata().ok();
        let changed = about.as_ref().and_then(|about| about.modified().ok()?.duration_since(UNIX_EPOCH).ok());
        Self {
            path: path.to_owned(),
            bytes: about.map_or(0, |about| about.len()),
            modified: changed.map(|t| format!("{}.{:09}", t.as_secs(), t.subsec_nanos())).unwrap_or_default(),
        }
    }

    /// The name by which it is known.
    #[must_use]
    pub fn name(&self) -> String {
        self.path.to_string_lossy().into_owned()
    }
}

/// The files that these names and patterns mean, each once, in natural order (`drive2` before `drive10`). What lies in
/// `out`, where the results go, is left out.
///
/// # Errors
/// A pattern that is none, or that fits no file.
pub fn files(patterns: &[String], out: &Path) -> Result<Vec<Found>, DriveError> {
    let real = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let own = real(out);
    let mut paths: Vec<PathBuf> = Vec::new();
    for pattern in patterns {
        if Path::new(pattern).is_file() {
            paths.push(pattern.into());
            continue;
        }
        let no_pattern = |error: glob::PatternError| DriveError::Mismatch(format!("{pattern}: {error}"));
        let before = paths.len();
        // What cannot be looked into holds no files for us.
        let entries = glob::glob(pattern).map_err(no_pattern)?.flatten();
        paths.extend(entries.filter(|path| path.is_file() && !real(path).starts_with(&own)));
        if paths.len() == before {
            return Err(DriveError::Mismatch(format!("{pattern}: no file fits, expected drive logs")));
        }
    }
    paths.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    let mut seen = HashSet::new();
    paths.retain(|path| seen.insert(real(path)));
    Ok(paths.iter().map(|path| Found::of(path)).collect())
}

/// Text in the order in which a person puts it: runs of digits count as numbers.
#[must_use]
pub fn natural(a: &str, b: &str) -> Ordering {
    let (mut x, mut y) = (a.as_bytes(), b.as_bytes());
    loop {
        let (Some(&p), Some(&q)) = (x.first(), y.first()) else {
            return x.len().cmp(&y.len()).then(a.cmp(b));
        };
        if p.is_ascii_digit() && q.is_ascii_digit() {
            let ((m, rest_x), (n, rest_y)) = (number(x), number(y));
            match m.len().cmp(&n.len()).then(m.cmp(n)) {
                Ordering::Equal => (x, y) = (rest_x, rest_y),
                other => return other,
            }
        } else if p != q {
            return p.cmp(&q);
        } else {
            (x, y) = (&x[1..], &y[1..]);
        }
    }
}

/// The digits at the beginning without leading zeros, and the rest.
fn number(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(text.len());
    let start = text[..end].iter().position(|byte| *byte != b'0').unwrap_or(end);
    (&text[start..end], &text[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count() {
        let mut names = ["d10.csv", "d2.csv", "d1.csv", "d02b.csv", "c99.csv", "d.csv"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["c99.csv", "d.csv", "d1.csv", "d2.csv", "d02b.csv", "d10.csv"]);
        assert_eq!(natural("a01", "a1"), Ordering::Less, "different names are never equal");
        assert_eq!(natural("2026-09-30", "2026-10-01"), Ordering::Less);
    }

    #[test]
    fn every_file_once_and_none_of_the_results() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
        std::fs::create_dir_all(at("out")).unwrap();
        for name in ["a10.csv", "a9.csv", "out/fleet.csv", "b.txt"] {
            std::fs::write(at(name), "x").unwrap();
        }
        let found =
            files(&[at("**/*.csv"), at("a9.csv"), at("out/../a9.csv")], Path::new(&at("./out"))).unwrap();
        let names: Vec<String> = found.iter().map(Found::name).collect();
        assert_eq!(names, [at("a9.csv"), at("a10.csv")]);
        assert!(found.iter().all(|file| file.bytes == 1 && !file.modified.is_empty()));
        let message = files(&[at("*.mf4")], Path::new("out")).unwrap_err().to_string();
        assert!(message.ends_with("*.mf4: no file fits, expected drive logs"), "{message}");
    }
}
