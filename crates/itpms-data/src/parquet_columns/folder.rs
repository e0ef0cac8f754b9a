//! The part files of a folder, and what the names of its folders say of them: `car=A/part-0.parquet`.
//!
//! Called by the reader of parts. A folder that is a table of a format with a log of its own is refused: which of its parts are valid
//! is not to be seen in them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{FileProblem, Problem};
use crate::log::Selection;

/// Folders within folders, at most: `year=2026/month=03/day=01` are three.
const DEEPEST: usize = 8;
/// Words in the names of keys that part a recording by its time.
const OF_TIME: [&str; 10] =
    ["year", "month", "week", "day", "date", "dt", "hour", "minute", "time", "timestamp"];

/// A part, and its keys with their values, from the outermost folder inwards.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) path: PathBuf,
    keys: Vec<(String, String)>,
}

/// The parts of a file or folder that are asked for, in the order of their names, and the selections that no key has answered. Errors: the
/// folder cannot be read or has another format's log; a key has several values, of which none is asked for, or not the one that is.
pub(super) fn parts(path: &Path, selections: &[Selection]) -> Result<(Vec<Part>, Vec<Selection>), Problem> {
    if !path.is_dir() {
        return Ok((vec![Part { path: path.to_owned(), keys: Vec::new() }], selections.to_vec()));
    }
    let mut parts = part_files(path)?;
    let within = |folder: &&Path| folder.starts_with(path);
    let folders: BTreeSet<&Path> =
        parts.iter().flat_map(|part| part.path.ancestors().skip(1).take_while(within)).collect();
    folders.into_iter().try_for_each(refuse_other_tables)?;
    let mut left = Vec::new();
    for selection in selections {
        let of_key = |part: &Part| part.value(selection.column()).map(|value| selection.takes(value));
        if !parts.iter().any(|part| of_key(part).is_some()) {
            left.push(selection.clone());
            continue;
        }
        parts.retain(|part| of_key(part) == Some(true));
        if parts.is_empty() {
            return Err(Selection::nowhere(std::slice::from_ref(selection)));
        }
    }
    let is_asked_for = |key: &str| selections.iter().any(|selection| selection.column() == key);
    let names: BTreeSet<&String> = parts.iter().flat_map(|part| &part.keys).map(|(key, _)| key).collect();
    for key in names {
        let values: BTreeSet<&str> = parts.iter().filter_map(|part| part.value(key)).collect();
        if values.len() < 2 || is_asked_for(key) || is_of_time(key) {
            continue;
        }
        let mut all: Vec<String> = values.iter().take(3).map(|value| format!("{key}={value}")).collect();
        if values.len() > all.len() {
            all.push(format!("{} more", values.len() - all.len()));
        }
        let (all, first) = (all.join(", "), values.first().copied().unwrap_or_default());
        return Err(Problem::Refused(format!(
            "the folder holds several recordings, {all}: say which one is meant, --where {key}={first} (--where {key}=* where all are of one drive)"
        )));
    }
    refuse_copies(&parts)?;
    Ok((parts, left))
}

/// A part that is there under two names would be two recordings of the same.
fn refuse_copies(parts: &[Part]) -> Result<(), Problem> {
    let mut by_length: BTreeMap<u64, Vec<&Path>> = BTreeMap::new();
    for part in parts {
        let Ok(about) = part.path.metadata() else { continue };
        let alike = by_length.entry(about.len()).or_default();
        if let Some(other) = alike.iter().find(|other| itpms_files::have_same_bytes(other, &part.path)) {
            let [one, other] = [*other, part.path.as_path()].map(Path::display);
            return Err(Problem::Refused(format!(
                "the parts {one} and {other} have the same bytes, expected each part once: move one of the two elsewhere"
            )));
        }
        alike.push(&part.path);
    }
    Ok(())
}

impl Part {
    fn value(&self, key: &str) -> Option<&str> {
        self.keys.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }
}

fn is_of_time(key: &str) -> bool {
    let key = key.to_lowercase();
    key.split(|c: char| !c.is_alphanumeric()).any(|word| OF_TIME.contains(&word))
}

/// Tables of Delta Lake, Iceberg and Hudi: parts that were overwritten lie beside the others.
fn refuse_other_tables(folder: &Path) -> Result<(), Problem> {
    let metadata = |folder: &Path| {
        let files = fs::read_dir(folder.join("metadata")).into_iter().flatten().flatten();
        files
            .map(|entry| entry.path())
            .filter(|path| path.to_string_lossy().ends_with(".metadata.json"))
            .max()
    };
    // Iceberg's parts lie in a folder of their own beside its log.
    let around = || folder.canonicalize().ok().and_then(|path| path.parent().map(Path::to_owned));
    let (format, way_out) = if folder.join("_delta_log").is_dir() {
        let line = format!(
            "python3 -c \"import deltalake, pyarrow.parquet as pq; pq.write_table(deltalake.DeltaTable('{}').to_pyarrow_table().sort_by('time_s'), 'drive.parquet')\"",
            folder.display()
        );
        ("Delta Lake", line)
    } else if let Some(newest) = metadata(folder).or_else(|| around().and_then(|folder| metadata(&folder))) {
        let line = format!(
            "python3 -c \"from pyiceberg.table import StaticTable; import pyarrow.parquet as pq; pq.write_table(StaticTable.from_metadata('{}').scan().to_arrow().sort_by('time_s'), 'drive.parquet')\"",
            newest.display()
        );
        ("Iceberg", line)
    } else if folder.join(".hoodie").is_dir() {
        ("Hudi", "spark.read.format(\"hudi\").load(...).orderBy(\"time_s\").toPandas().to_parquet(\"drive.parquet\")".to_owned())
    } else {
        return Ok(());
    };
    Err(Problem::Elsewhere(format!(
        "a table of {format}, where parts that were overwritten lie beside valid ones and its log alone knows which; expected one Parquet file, which \
         its library writes, sorted by its clock: {way_out}"
    )))
}

/// The Parquet files below a folder, in the order of their names. What begins with `_` or `.` is no part but says something of
/// the others, as `_SUCCESS` does.
pub(super) fn part_files(folder: &Path) -> Result<Vec<Part>, Problem> {
    let mut files = Vec::new();
    let mut folders = vec![(folder.to_owned(), 0, Vec::new())];
    while let Some((folder, depth, keys)) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(FileProblem::Read)? {
            let path = entry.map_err(FileProblem::Read)?.path();
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
            if name.is_empty() || name.starts_with(['_', '.']) {
                continue;
            } else if path.is_dir() && depth < DEEPEST {
                let mut keys = keys.clone();
                keys.extend(name.split_once('=').map(|(key, value)| (unescaped(key), unescaped(value))));
                folders.push((path, depth + 1, keys));
            } else if path.is_file() && matches!(extension.as_deref(), Some("parquet" | "pq" | "parq")) {
                files.push(Part { path, keys: keys.clone() });
            }
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

/// `%20` and the like, as names of folders have what file systems do not allow.
fn unescaped(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let code = || u8::from_str_radix(std::str::from_utf8(after.get(..2)?).ok()?, 16).ok();
        let escaped = code().filter(|_| *first == b'%');
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_keys_and_their_values() {
        assert_eq!(unescaped("car%20a%2Fb%"), "car a/b%");
        assert!(is_of_time("year") && is_of_time("drive_date") && is_of_time("event-hour"));
        assert!(!is_of_time("car") && !is_of_time("sunday") && !is_of_time("bucket"));
    }
}
