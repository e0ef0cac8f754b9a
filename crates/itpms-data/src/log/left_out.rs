//! Other files in a folder of part files. Called by the reader, which reads the parts alone.

use std::fs;
use std::path::Path;

/// Folders within folders, as for the parts.
const DEEPEST: usize = 8;
const NAMED: usize = 5;

/// A sentence about the files of a folder that are no parts of its table; `None` of a file, or if there are none. What begins with `_` or `.` says
/// something of the parts.
pub(super) fn of_folder(path: &Path) -> Option<String> {
    if !path.is_dir() {
        return None;
    }
    let mut names = Vec::new();
    let mut folders = vec![(path.to_owned(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        for entry in fs::read_dir(&folder).ok()?.flatten() {
            let file = entry.path();
            let name = entry.file_name().to_string_lossy().into_owned();
            let extension = file.extension().map(|extension| extension.to_string_lossy().to_lowercase());
            let is_part = matches!(extension.as_deref(), Some("parquet" | "pq" | "parq"));
            if name.starts_with(['_', '.']) {
                continue;
            } else if file.is_dir() && depth < DEEPEST {
                folders.push((file, depth + 1));
            } else if !is_part {
                names.push(super::shortened(&name));
            }
        }
    }
    names.sort();
    let more = names.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let named = names.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len() {
        0 => None,
        1 => Some(format!("1 file of the folder is no Parquet and was left out: {named}; read it by itself")),
        n => Some(format!(
            "{n} files of the folder are no Parquet and were left out: {named}{more}; read each by itself"
        )),
    }
}
