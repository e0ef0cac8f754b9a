//! Which files are meant, in which order.

use std::cmp::Ordering;
use std::collections::HashSet;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use crate::error::DriveError;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// As it was named, or as the pattern gave it.
    pub path: PathBuf,
    pub bytes: u64,
    /// When it was last changed: s and ns since 1970, as text.
    pub modified: String,
    /// Why it cannot be a drive, whatever is in it.
    pub unusable: Option<&'static str>,
    /// The table of tooth pulses beside it.
    pub pulses: Option<Beside>,
}

/// The table of tooth pulses of a drive `NAME.*`: `NAME.pulses.csv` or `NAME.pulses.parquet` in the same folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Beside {
    pub path: PathBuf,
    /// Its length and when it was last changed, as text.
    pub version: String,
}

impl Beside {
    /// The table, and whether there is a second one.
    fn of(drive: &Path) -> (Option<Self>, bool) {
        let packed = drive.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
        let drive = if packed { drive.with_extension("") } else { drive.to_owned() };
        let mut there = ["csv", "parquet"].into_iter().filter_map(|format| {
            let path = drive.with_extension(format!("pulses.{format}"));
            let about = path.metadata().ok().filter(Metadata::is_file)?;
            Some(Self { version: format!("{} {}", about.len(), changed(&about)), path })
        });
        (there.next(), there.next().is_some())
    }
}

/// When it was last changed: s and ns since 1970, as text.
fn changed(about: &Metadata) -> String {
    let since = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since.map(|t| format!("{}.{:09}", t.as_secs(), t.subsec_nanos())).unwrap_or_default()
}

impl Found {
    fn of(path: &Path) -> Self {
        let about = path.metadata().ok();
        let (pulses, two) = Beside::of(path);
        let unusable = match &about {
            // Its results are kept under its name, in text.
            _ if path.to_str().is_none() => Some("its name is not UTF-8, expected a name that is"),
            None => Some("leads to no file, expected a drive log"),
            Some(about) if !about.is_file() => Some("is a device or a pipe, expected a regular file"),
            Some(_) if two => Some(
                "has two tables of tooth pulses beside it, .pulses.csv and .pulses.parquet, expected one",
            ),
            Some(_) => None,
        };
        Self {
            path: path.to_owned(),
            bytes: about.as_ref().map_or(0, Metadata::len),
            modified: about.as_ref().map(changed).unwrap_or_default(),
            unusable,
            pulses,
        }
    }

    pub fn name(&self) -> String {
        self.path.to_string_lossy().into_owned()
    }
}

/// The files that these names and patterns mean, each once, in natural order (`drive2` before `drive10`). What lies in `out`, where the
/// results go, is left out, by whatever links it is reached; folders are, too. What else is no file is among them, with the reason. A table
/// of tooth pulses belongs to the drive beside it and is no drive. Errors: a pattern that is none, or that fits no file.
pub fn files(patterns: &[PathBuf], out: &Path) -> Result<Vec<Found>, DriveError> {
    let own = real(out);
    let mut paths: Vec<PathBuf> = Vec::new();
    for pattern in patterns {
        let refuse = |why: String| DriveError::Mismatch(format!("{}: {why}", pattern.display()));
        let fitting = match pattern.to_str() {
            Some(text) if fs::symlink_metadata(pattern).is_err() => {
                fitting(text).map_err(|error| refuse(error.to_string()))?
            }
            _ => vec![pattern.clone()],
        };
        let before = paths.len();
        paths.extend(fitting.into_iter().filter(|path| !path.is_dir() && !real(path).starts_with(&own)));
        if paths.len() == before {
            return Err(refuse("no file fits, expected drive logs".to_owned()));
        }
    }
    paths.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    let mut seen = HashSet::new();
    paths.retain(|path| seen.insert(real(path)));
    let mut found: Vec<Found> = paths.iter().map(|path| Found::of(path)).collect();
    let tables: HashSet<PathBuf> =
        found.iter().filter_map(|file| Some(real(&file.pulses.as_ref()?.path))).collect();
    found.retain(|file| !tables.contains(&real(&file.path)));
    Ok(found)
}

/// The files that a pattern matches. Patterns are text; names that are not are matched as they are displayed.
fn fitting(pattern: &str) -> Result<Vec<PathBuf>, glob::PatternError> {
    // A folder that cannot be read is taken for empty.
    let mut paths: Vec<PathBuf> = glob::glob(pattern)?.flatten().collect();
    let (folders, name) = pattern.rsplit_once('/').map_or((".", pattern), |(folder, name)| (folder, name));
    let name = glob::Pattern::new(name)?;
    for folder in glob::glob(if folders.is_empty() { "/" } else { folders })?.flatten() {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let odd = entries.filter(|entry| entry.file_name().to_str().is_none());
        paths.extend(
            odd.filter(|entry| name.matches(&entry.file_name().to_string_lossy())).map(|entry| entry.path()),
        );
    }
    Ok(paths)
}

/// The file behind a name, through all links; of a name without a file what its folder's is.
fn real(path: &Path) -> PathBuf {
    let beside = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(beside).unwrap_or_else(|| path.to_owned())
}

/// Text in the order in which a person puts it: runs of digits count as numbers.
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
        let at = |name: &str| dir.path().join(name);
        std::fs::create_dir_all(at("out")).unwrap();
        for name in ["a10.csv", "a9.csv", "out/fleet.csv", "b.txt"] {
            std::fs::write(at(name), "x").unwrap();
        }
        let found = files(&[at("**/*.csv"), at("a9.csv"), at("out/../a9.csv")], &at("./out")).unwrap();
        let names: Vec<PathBuf> = found.iter().map(|file| file.path.clone()).collect();
        assert_eq!(names, [at("a9.csv"), at("a10.csv")]);
        assert!(found.iter().all(|file| file.bytes == 1 && !file.modified.is_empty()));
        assert!(found.iter().all(|file| file.unusable.is_none()));
        let message = files(&[at("*.mf4")], Path::new("out")).unwrap_err().to_string();
        assert!(message.ends_with("*.mf4: no file fits, expected drive logs"), "{message}");
    }

    #[test]
    fn a_table_of_pulses_belongs_to_the_drive_beside_it() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        for name in ["a.csv", "a.pulses.csv", "b.csv.gz", "b.pulses.parquet", "c.pulses.csv", "d.csv"] {
            std::fs::write(at(name), "x").unwrap();
        }
        let every = || files(&[at("*")], &at("out")).unwrap();
        let beside = |file: &Found| file.pulses.as_ref().map(|table| table.path.clone());
        let found: Vec<_> = every().iter().map(|file| (file.path.clone(), beside(file))).collect();
        let expected = [
            (at("a.csv"), Some(at("a.pulses.csv"))),
            (at("b.csv.gz"), Some(at("b.pulses.parquet"))),
            // Of no drive: it will be refused as one.
            (at("c.pulses.csv"), None),
            (at("d.csv"), None),
        ];
        assert_eq!(found, expected);
        assert!(every().iter().all(|file| file.unusable.is_none()));
        // Another table is other pulses, and two are one too many.
        let before = every()[0].pulses.clone();
        std::fs::write(at("a.pulses.csv"), "xy").unwrap();
        assert_ne!(every()[0].pulses, before);
        std::fs::write(at("a.pulses.parquet"), "x").unwrap();
        assert!(every()[0].unusable.unwrap().contains("two tables of tooth pulses"));
    }

    /// Files that are no drives are named, and the program's own output is not read.
    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_named_and_links_lead_to_no_results() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        std::fs::create_dir_all(at("out/estimates")).unwrap();
        std::fs::create_dir_all(at("logs/folder.csv")).unwrap();
        for name in ["out/estimates/a.csv", "logs/a.csv"] {
            std::fs::write(at(name), "x").unwrap();
        }
        symlink(dir.path(), at("logs/up")).unwrap();
        symlink("/nowhere", at("logs/dangling.csv")).unwrap();
        symlink("/dev/null", at("logs/device.csv")).unwrap();
        let odd = dir.path().join("logs").join(OsStr::from_bytes(b"b\xff.csv"));
        std::fs::write(&odd, "x").unwrap();
        // As a shell passes them on, and as a pattern.
        let named = [at("logs/up/out/estimates/a.csv"), at("logs/a.csv"), at("logs/*.csv")];
        for patterns in [&named[1..3], &named[2..3]] {
            let found = files(patterns, &at("out")).unwrap();
            assert!(found.iter().all(|file| !real(&file.path).starts_with(real(&at("out")))), "{found:?}");
            assert!(found.iter().any(|file| file.path == at("logs/a.csv") && file.unusable.is_none()));
        }
        let found = files(&[at("logs/*.csv")], &at("out")).unwrap();
        let why = |path: &Path| found.iter().find(|file| file.path == path).unwrap().unusable.unwrap();
        assert_eq!(found.len(), 4);
        assert!(why(&at("logs/dangling.csv")).contains("no file"));
        assert!(why(&at("logs/device.csv")).contains("device"));
        assert!(why(&odd).contains("UTF-8"));
        assert!(files(&[at("logs/up/out/estimates/a.csv")], &at("out")).is_err());
    }
}
