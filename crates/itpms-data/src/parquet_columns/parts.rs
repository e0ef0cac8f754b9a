//! A Parquet table that is one file, or a folder of part files as Spark, Dask and DuckDB leave it: one after the other, or
//! interleaved, in the order of the clock.
//!
//! A part is open from when the clock has come to its first row until its last, so that of a thousand parts in a row one is
//! held at a time. Called by the reader and by the list of drive logs; knows of columns no more than their names.

use std::path::{Path, PathBuf};

use itpms_files::input;

use super::folder::{self, Part};
use super::{Meaning, ParquetColumns};
use crate::error::{FileProblem, Place, Problem};
use crate::log::Selection;

/// A day, and how far apart two parts of one drive are at most where the clock goes over midnight, in s.
const DAY_S: f64 = 86_400.0;
const MIDNIGHT_S: f64 = 60.0;

/// A file or a folder of files.
#[derive(Default)]
pub(crate) struct ParquetParts {
    names: Vec<String>,
    /// The parts that have some first, for what these are, and for each name the part among them.
    first: Vec<ParquetColumns>,
    first_with: Vec<usize>,
    wanted: Wanted,
    /// Columns that some part lacks: the column, and how many parts.
    pub(crate) lacking: Vec<(String, usize)>,
    /// Two parts that have rows of the same time.
    overlap: Option<(String, String)>,
    /// The parts that are still to be opened, by the time of their first row, the latest first.
    waiting: Vec<(f64, PathBuf)>,
    open: Vec<Open>,
    goes_over_midnight: bool,
    /// Which of the open ones the present row is from.
    now: usize,
    rows: u64,
    rows_read: u64,
}

#[derive(Debug, Default)]
struct Wanted {
    columns: Vec<String>,
    /// Which of the chosen ones is the clock.
    clock: Option<usize>,
    rows: Vec<Selection>,
}

struct Open {
    name: Option<String>,
    columns: ParquetColumns,
    /// Where each of the wanted columns is among those of this part, if it has it.
    places: Vec<Option<usize>>,
    clock: Option<usize>,
    /// The time of its next row, or, where that has none, of the row before, and what is added to it after midnight.
    time_s: f64,
    day_s: f64,
}

impl std::fmt::Debug for ParquetParts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetParts").field("wanted", &self.wanted).finish_non_exhaustive()
    }
}

/// Whether this is a folder in which the parts of a Parquet table lie.
pub(crate) fn is_folder_of_parts(path: &Path) -> bool {
    path.is_dir() && folder::part_files(path).is_ok_and(|files| !files.is_empty())
}

impl ParquetParts {
    /// Opens a file or a folder. Errors: it cannot be read, is no Parquet, or holds several recordings of which none is asked for.
    pub(crate) fn open(path: &Path, selections: &[Selection]) -> Result<Self, Problem> {
        let (parts, rows) = folder::parts(path, selections)?;
        if parts.is_empty() {
            return Err(FileProblem::IsDirectory.into());
        }
        let mut of_all = Self { wanted: Wanted { rows, ..Wanted::default() }, ..Self::default() };
        let is_folder = parts.len() > 1;
        for Part { path, .. } in parts {
            let columns =
                opened(&path).map_err(|problem| in_part(part_name(&path, is_folder).as_ref(), problem))?;
            of_all.learn_names(columns);
            of_all.waiting.push((f64::NEG_INFINITY, path));
        }
        Ok(of_all)
    }

    /// Of a part that has columns which no earlier one has, what they are is kept.
    fn learn_names(&mut self, columns: ParquetColumns) {
        let new: Vec<String> =
            columns.names().iter().filter(|name| !self.names.contains(name)).cloned().collect();
        if !new.is_empty() || self.first.is_empty() {
            self.first_with.extend(new.iter().map(|_| self.first.len()));
            self.names.extend(new);
            self.first.push(columns);
        }
    }

    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Meaning of a column. Errors: no numbers and no times.
    pub(crate) fn meaning(&self, leaf: usize) -> Result<Meaning, Problem> {
        let (part, leaf) = self.first_part_with(leaf)?;
        part.meaning(leaf)
    }

    /// Meaning of a column that is given as the clock. Errors: no numbers, no times and no text of times.
    pub(crate) fn clock_meaning(&self, leaf: usize) -> Result<Meaning, Problem> {
        let (part, leaf) = self.first_part_with(leaf)?;
        part.clock_meaning(leaf)
    }

    fn first_part_with(&self, column: usize) -> Result<(&ParquetColumns, usize), Problem> {
        let part = self.first_with.get(column).and_then(|part| self.first.get(*part));
        let name = self.names.get(column);
        let leaf =
            part.zip(name).and_then(|(part, name)| part.names().iter().position(|other| other == name));
        part.zip(leaf).ok_or_else(|| Problem::MissingColumn {
            column: name.cloned().unwrap_or_default(),
            nearest: None,
        })
    }

    /// Reads these columns of numbers, and if it is among them `clock`, whose times come in s.
    /// Errors: one holds something else, a part has no clock, or the rows that are asked for are not there.
    pub(crate) fn choose(&mut self, leaves: &[usize], clock: Option<usize>) -> Result<(), Problem> {
        self.wanted.columns = leaves.iter().map(|leaf| self.names[*leaf].clone()).collect();
        self.wanted.clock = leaves.iter().position(|leaf| Some(*leaf) == clock);
        for selection in &self.wanted.rows {
            selection.place(&self.names)?;
        }
        let is_folder = self.waiting.len() > 1;
        let mut waiting = Vec::new();
        let mut lacking = vec![0; self.wanted.columns.len()];
        for (_, path) in std::mem::take(&mut self.waiting) {
            let part = Open::new(&path, is_folder, &self.wanted)?;
            self.rows += part.columns.rows();
            for (count, place) in lacking.iter_mut().zip(&part.places) {
                *count += usize::from(place.is_none());
            }
            // Of one part the first row is early enough.
            let early = !is_folder && self.wanted.rows.is_empty();
            let first_s = if early { Some(f64::NEG_INFINITY) } else { part.first_s()? };
            waiting.extend(first_s.map(|first_s| (first_s, path)));
        }
        if waiting.is_empty() && !self.wanted.rows.is_empty() && self.rows > 0 {
            return Err(Selection::nowhere(&self.wanted.rows));
        }
        let names = self.wanted.columns.iter().cloned().zip(lacking);
        self.lacking = names.filter(|(_, parts)| *parts > 0).collect();
        // Parts that begin at the same time stay in the order of their names.
        waiting.reverse();
        waiting.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        self.waiting = waiting;
        self.over_midnight(is_folder)
    }

    /// Parts whose clock is the time of day and goes on over midnight from the last of them to the first begin in between.
    fn over_midnight(&mut self, is_folder: bool) -> Result<(), Problem> {
        let [(latest_s, latest), .., (first_s, _)] = &self.waiting[..] else { return Ok(()) };
        let apart = self.waiting.windows(2).map(|pair| pair[0].0 - pair[1].0);
        let widest = apart.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
        let Some((place, _)) = widest.filter(|(_, apart_s)| *apart_s > 0.5 * DAY_S) else { return Ok(()) };
        if !(*first_s >= 0.0 && *latest_s <= DAY_S) {
            return Ok(());
        }
        let mut last = Open::new(latest, is_folder, &self.wanted)?;
        while last.advance()? {}
        if !((last.time_s - first_s).rem_euclid(DAY_S) >= DAY_S - MIDNIGHT_S) {
            return Ok(());
        }
        self.goes_over_midnight = true;
        self.waiting.iter_mut().skip(place + 1).for_each(|(first_s, _)| *first_s += DAY_S);
        self.waiting.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        Ok(())
    }

    /// The names of two parts that have rows of the same time, as far as was read.
    pub(crate) fn overlap(&self) -> Option<&(String, String)> {
        self.overlap.as_ref()
    }

    /// Share of the table that has been read, 0 to 1.
    pub(crate) fn progress(&self) -> f64 {
        (self.rows_read as f64 / self.rows.max(1) as f64).min(1.0)
    }

    /// Goes to the next row, by the clock; `None` after the last. Errors: a part cannot be read on.
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

    /// The row's values of the columns, in the order in which they were chosen; NaN where nothing finite is.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        self.open.get(self.now).into_iter().flat_map(Open::values)
    }

    fn open_next(&mut self) -> Result<(), Problem> {
        let is_folder = self.waiting.len() + self.open.len() > 1 || self.rows_read > 0;
        if let Some((first_s, path)) = self.waiting.pop() {
            let mut part = Open::new(&path, is_folder, &self.wanted)?;
            part.day_s = if first_s >= DAY_S && self.goes_over_midnight { DAY_S } else { 0.0 };
            if part.advance()? {
                let other = self.open.first().and_then(|other| other.name.clone());
                self.overlap = self.overlap.take().or_else(|| other.zip(part.name.clone()));
                self.open.push(part);
            }
        }
        Ok(())
    }
}

impl Open {
    fn new(path: &Path, is_folder: bool, wanted: &Wanted) -> Result<Self, Problem> {
        let name = part_name(path, is_folder);
        let of_part = |problem| in_part(name.as_ref(), problem);
        let mut columns = opened(path).map_err(of_part)?;
        let leaf =
            |columns: &ParquetColumns, column: &str| columns.names().iter().position(|name| name == column);
        let mut places = Vec::new();
        let mut chosen = 0;
        for (place, column) in wanted.columns.iter().enumerate() {
            let is_clock = wanted.clock == Some(place);
            let Some(leaf) = leaf(&columns, column) else {
                if is_clock {
                    return Err(of_part(Problem::MissingColumn { column: column.clone(), nearest: None }));
                }
                places.push(None);
                continue;
            };
            if is_clock { columns.choose_clock(leaf) } else { columns.choose(leaf) }.map_err(of_part)?;
            places.push(Some(chosen));
            chosen += 1;
        }
        // Another file among the parts has nothing but a clock, if that.
        if chosen < 2
            && let Some(column) = wanted
                .columns
                .iter()
                .zip(&places)
                .find(|(_, place)| place.is_none())
                .map(|(column, _)| column)
        {
            return Err(of_part(Problem::MissingColumn { column: column.clone(), nearest: None }));
        }
        for selection in &wanted.rows {
            // A part without the column has none of the rows.
            match leaf(&columns, selection.column()) {
                Some(leaf) => columns.choose_rows(leaf, selection).map_err(of_part)?,
                None => columns.no_rows = true,
            }
        }
        let clock = wanted.clock.and_then(|place| places[place]);
        Ok(Self { name, columns, places, clock, time_s: f64::NEG_INFINITY, day_s: 0.0 })
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let of = |place: &Option<usize>| place.map_or(f64::NAN, |place| self.columns.value(place));
        self.places.iter().map(of)
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
        let time_s = self.clock.map(|place| self.columns.value(place));
        let finite = time_s.filter(|time_s| time_s.is_finite());
        self.time_s = finite.map_or(self.time_s, |time_s| time_s + self.day_s);
        Ok(true)
    }
}

/// Within a folder, the name of a part, with that of its folder where that says something of it.
fn part_name(path: &Path, is_folder: bool) -> Option<String> {
    let name = path.file_name().filter(|_| is_folder)?.to_string_lossy().into_owned();
    let folder = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy());
    let key = folder.filter(|folder| folder.contains('='));
    Some(key.map_or_else(|| name.clone(), |folder| format!("{folder}/{name}")))
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
