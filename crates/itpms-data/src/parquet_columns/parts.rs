//! A Parquet table that is one file, or a folder of part files as Spark, Dask and DuckDB leave it: one after the other, or
//! interleaved, in the order of the clock.
//!
//! A part is open from when the clock has come to its first row until its last, so that of a thousand parts in a row one is
//! held at a time. Called by the reader and by the list of drive logs; knows of columns no more than their names.

use std::fs;
use std::path::{Path, PathBuf};

use itpms_files::input;

use super::{Meaning, ParquetColumns};
use crate::error::{FileProblem, Place, Problem};

/// Folders within folders, at most: `year=2026/month=03/day=01` are three.
const DEEPEST: usize = 8;

/// A file or a folder of files.
pub(crate) struct ParquetParts {
    /// The first part, for what its columns are.
    first: ParquetColumns,
    /// Names of the chosen columns.
    chosen: Vec<String>,
    /// Which of the chosen ones is the clock.
    clock: Option<usize>,
    /// The parts that are still to be opened, by the time of their first row, the latest first.
    waiting: Vec<(f64, PathBuf)>,
    open: Vec<Open>,
    /// Which of the open ones the present row is from.
    now: usize,
    rows: u64,
    rows_read: u64,
}

/// A part that is read.
struct Open {
    /// Within a folder, its name.
    name: Option<String>,
    columns: ParquetColumns,
    clock: Option<usize>,
    /// The time of its next row, or, where that has none, of the row before.
    time_s: f64,
}

impl std::fmt::Debug for ParquetParts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetParts").field("chosen", &self.chosen).finish_non_exhaustive()
    }
}

/// Whether this is a folder in which the parts of a Parquet table lie.
pub(crate) fn is_folder_of_parts(path: &Path) -> bool {
    path.is_dir() && part_files(path).is_ok_and(|files| !files.is_empty())
}

impl ParquetParts {
    /// Opens a file or a folder.
    ///
    /// # Errors
    /// It cannot be read, or is no Parquet.
    pub(crate) fn open(path: &Path) -> Result<Self, Problem> {
        let files = if path.is_dir() { part_files(path)? } else { vec![path.to_owned()] };
        let Some(first) = files.first() else { return Err(FileProblem::IsDirectory.into()) };
        Ok(Self {
            first: opened(first)?,
            chosen: Vec::new(),
            clock: None,
            waiting: files.into_iter().map(|file| (f64::NEG_INFINITY, file)).collect(),
            open: Vec::new(),
            now: 0,
            rows: 0,
            rows_read: 0,
        })
    }

    /// The names of all columns.
    pub(crate) fn names(&self) -> &[String] {
        self.first.names()
    }

    /// What a column holds.
    ///
    /// # Errors
    /// No numbers and no times.
    pub(crate) fn meaning(&self, leaf: usize) -> Result<Meaning, Problem> {
        self.first.meaning(leaf)
    }

    /// What a column holds that is given as the clock.
    ///
    /// # Errors
    /// No numbers, no times and no text of times.
    pub(crate) fn clock_meaning(&self, leaf: usize) -> Result<Meaning, Problem> {
        self.first.clock_meaning(leaf)
    }

    /// Reads these columns of numbers, and if it is among them `clock`, whose times come in s.
    ///
    /// # Errors
    /// One holds something else, or a part has not the columns of the first.
    pub(crate) fn choose(&mut self, leaves: &[usize], clock: Option<usize>) -> Result<(), Problem> {
        self.chosen = leaves.iter().map(|leaf| self.names()[*leaf].clone()).collect();
        self.clock = leaves.iter().position(|leaf| Some(*leaf) == clock);
        let is_folder = self.waiting.len() > 1;
        let mut waiting = Vec::new();
        for (_, path) in std::mem::take(&mut self.waiting) {
            let part = Open::new(&path, is_folder, &self.chosen, self.clock)?;
            self.rows += part.columns.rows();
            // Of one part the first row is early enough.
            let first_s = if is_folder { part.first_s()? } else { Some(f64::NEG_INFINITY) };
            waiting.extend(first_s.map(|first_s| (first_s, path)));
        }
        // Parts that begin at the same time stay in the order of their names.
        waiting.reverse();
        waiting.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        self.waiting = waiting;
        Ok(())
    }

    /// Share of the table that has been read, 0 to 1.
    pub(crate) fn progress(&self) -> f64 {
        (self.rows_read as f64 / self.rows.max(1) as f64).min(1.0)
    }

    /// Goes to the next row, by the clock; `None` after the last.
    ///
    /// # Errors
    /// A part cannot be read on.
    pub(crate) fn advance(&mut self) -> Result<Option<Place>, Problem> {
        if let Some(part) = self.open.get_mut(self.now)
            && !part.advance()?
        {
            self.open.remove(self.now);
        }
        loop {
            let times = self.open.iter().map(|part| part.time_s).enumerate();
            let earliest = times.min_by(|(_, a), (_, b)| a.total_cmp(b));
            match (earliest, self.waiting.last()) {
                (Some((now, time_s)), next) if next.is_none_or(|(first_s, _)| time_s < *first_s) => {
                    self.now = now;
                    self.rows_read += 1;
                    return Ok(Some(Place::Row(self.rows_read)));
                }
                (_, None) => return Ok(None),
                (_, Some(_)) => self.open_next()?,
            }
        }
    }

    /// What the row has in the columns, in the order in which they were chosen; NaN where nothing finite is.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        self.open.get(self.now).into_iter().flat_map(|part| part.columns.values())
    }

    fn open_next(&mut self) -> Result<(), Problem> {
        let is_folder = self.waiting.len() + self.open.len() > 1 || self.rows_read > 0;
        if let Some((_, path)) = self.waiting.pop() {
            let mut part = Open::new(&path, is_folder, &self.chosen, self.clock)?;
            if part.advance()? {
                self.open.push(part);
            }
        }
        Ok(())
    }
}

impl Open {
    fn new(path: &Path, is_folder: bool, chosen: &[String], clock: Option<usize>) -> Result<Self, Problem> {
        let name = path.file_name().filter(|_| is_folder).map(|name| name.to_string_lossy().into_owned());
        let of_part = |problem| in_part(name.as_ref(), problem);
        let mut columns = opened(path).map_err(of_part)?;
        for (place, column) in chosen.iter().enumerate() {
            let leaf = columns.names().iter().position(|name| name == column);
            let missing = || Problem::MissingColumn { column: column.clone(), nearest: None };
            let leaf = leaf.ok_or_else(missing).map_err(of_part)?;
            let is_clock = clock == Some(place);
            if is_clock { columns.choose_clock(leaf) } else { columns.choose(leaf) }.map_err(of_part)?;
        }
        Ok(Self { name, columns, clock, time_s: f64::NEG_INFINITY })
    }

    /// The time of the first row that has one; `None` without a row.
    fn first_s(mut self) -> Result<Option<f64>, Problem> {
        let mut has_rows = false;
        while self.time_s == f64::NEG_INFINITY && self.advance()? {
            has_rows = true;
        }
        Ok(has_rows.then_some(self.time_s))
    }

    fn advance(&mut self) -> Result<bool, Problem> {
        let there = self.columns.advance().map_err(|problem| in_part(self.name.as_ref(), problem))?;
        if there.is_none() {
            return Ok(false);
        }
        let time_s = self.clock.and_then(|place| self.columns.values().nth(place));
        self.time_s = time_s.filter(|time_s| time_s.is_finite()).unwrap_or(self.time_s);
        Ok(true)
    }
}

fn opened(path: &Path) -> Result<ParquetColumns, Problem> {
    ParquetColumns::open(input::open_regular(path, "Parquet")?.0)
}

/// The problem, and in which part of a folder it is.
fn in_part(name: Option<&String>, problem: Problem) -> Problem {
    match name {
        Some(part) => Problem::InPart { part: part.clone(), problem: Box::new(problem) },
        None => problem,
    }
}

/// The Parquet files below a folder, in the order of their names. What begins with `_` or `.` is no part but says something of
/// the others, as `_SUCCESS` does.
fn part_files(folder: &Path) -> Result<Vec<PathBuf>, Problem> {
    let mut files = Vec::new();
    let mut folders = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(FileProblem::Read)? {
            let path = entry.map_err(FileProblem::Read)?.path();
            let hidden = path.file_name().is_none_or(|name| name.to_string_lossy().starts_with(['_', '.']));
            let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
            if hidden {
                continue;
            } else if path.is_dir() && depth < DEEPEST {
                folders.push((path, depth + 1));
            } else if path.is_file() && matches!(extension.as_deref(), Some("parquet" | "pq")) {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}
