//! Small tables of measurements: named columns of numbers from a CSV or Parquet file, every row complete.
//!
//! Called by the commands that identify a part on a bench. Unlike a drive log, such a table is short, is read as a whole, and has no
//! missing values: a cell that is no finite number is refused with its line and column. Knows nothing of the columns' meaning.

use std::path::Path;

use itpms_files::input;

use crate::error::{DataError, Place, Problem, not_among, separated_by, twice};
#[cfg(feature = "parquet")]
use crate::log::Format;
use crate::log::{Lines, cells, number, separator, shortened};
#[cfg(feature = "parquet")]
use crate::parquet_columns::ParquetColumns;

#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    values: Vec<Vec<f64>>,
    lines: Vec<u64>,
}

impl Columns {
    /// Reads the columns `needed`, and those of `optional` that are there; others are passed over. Comments (`#`), blank lines and quotes
    /// are as in drive logs. Errors: the file cannot be read, is empty, has no row, lacks a needed column or has one twice, a row is longer
    /// or shorter than the header, or a cell of these columns is no finite number.
    pub fn read(path: &Path, needed: &[&str], optional: &[&str]) -> Result<Self, DataError> {
        read(path, needed, optional).map_err(|problem| DataError::new(path, problem))
    }

    pub fn get(&self, name: &str) -> Option<&[f64]> {
        let place = self.names.iter().position(|n| n == name)?;
        self.values.get(place).map(Vec::as_slice)
    }

    /// The column of this name; empty if it is not there, which for a needed one cannot be.
    pub fn column(&self, name: &str) -> &[f64] {
        self.get(name).unwrap_or_default()
    }

    /// Line of the file that holds each row; of a Parquet file the row, from one.
    pub fn lines(&self) -> &[u64] {
        &self.lines
    }
}

fn read(path: &Path, needed: &[&str], optional: &[&str]) -> Result<Columns, Problem> {
    #[cfg(feature = "parquet")]
    if Format::of(path).is_ok_and(|format| format == Format::Parquet) {
        return read_parquet(path, needed, optional);
    }
    let mut lines = Lines::new(input::open(path)?.0);
    if !lines.advance()? {
        return Err(format!("the file is empty, expected a header line with {}", needed.join(",")).into());
    }
    let header: Vec<String> =
        cells(lines.text()).map(|name| String::from_utf8_lossy(name).into_owned()).collect();
    let names = chosen(&header, needed, optional)?;
    // For each column of the file, which of ours it is.
    let slots: Vec<Option<usize>> =
        header.iter().map(|name| names.iter().position(|known| known == name)).collect();
    let mut values = vec![Vec::new(); names.len()];
    let mut places = Vec::new();
    while lines.advance()? {
        let place = Place::Line(lines.number());
        let row: Vec<&[u8]> = cells(lines.text()).collect();
        if row.len() != slots.len() {
            return Err(Problem::CellCount { place, found: row.len(), expected: slots.len() });
        }
        for (cell, slot) in row.iter().zip(&slots) {
            let Some(slot) = slot else { continue };
            values[*slot].push(finite(cell, place, &names[*slot])?);
        }
        places.push(lines.number());
    }
    if places.is_empty() {
        return Err(Problem::HeaderOnly);
    }
    Ok(Columns { names, values, lines: places })
}

#[cfg(feature = "parquet")]
fn read_parquet(path: &Path, needed: &[&str], optional: &[&str]) -> Result<Columns, Problem> {
    let mut table = ParquetColumns::open(input::open(path)?.0)?;
    let names = chosen(table.names(), needed, optional)?;
    for name in &names {
        if let Some(leaf) = table.names().iter().position(|known| known == name) {
            table.choose(leaf)?;
        }
    }
    let mut values = vec![Vec::new(); names.len()];
    let mut lines = Vec::new();
    while let Some(place) = table.advance()? {
        for ((value, column), name) in table.values().zip(&mut values).zip(&names) {
            if !value.is_finite() {
                return Err(not_finite(place, name, "nothing finite"));
            }
            column.push(value);
        }
        lines.push(lines.len() as u64 + 1);
    }
    if lines.is_empty() {
        return Err(Problem::HeaderOnly);
    }
    Ok(Columns { names, values, lines })
}

fn finite(cell: &[u8], place: Place, column: &str) -> Result<f64, Problem> {
    let text = || shortened(&String::from_utf8_lossy(cell));
    match number(cell) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) if cell.is_empty() => Err(not_finite(place, column, "nothing")),
        Some(_) => Err(not_finite(place, column, &text())),
        None => Err(not_finite(place, column, &format!("{:?}", text()))),
    }
}

fn not_finite(place: Place, column: &str, found: &str) -> Problem {
    Problem::Refused(format!("{place}, column {column}: found {found}, expected a finite number"))
}

fn chosen(header: &[String], needed: &[&str], optional: &[&str]) -> Result<Vec<String>, Problem> {
    let wanted = || needed.iter().chain(optional);
    let mut names = Vec::new();
    for name in wanted() {
        let mut places = header.iter().enumerate().filter(|(_, n)| n == name).map(|(i, _)| i);
        match (places.next(), places.next()) {
            (Some(first), Some(second)) => return Err(twice(name, first, second)),
            (Some(_), None) => names.push((*name).to_owned()),
            (None, _) if needed.contains(name) => return Err(missing(name, header, needed)),
            (None, _) => {}
        }
    }
    Ok(names)
}

fn missing(name: &str, header: &[String], needed: &[&str]) -> Problem {
    if let Some(separator) = separator(header) {
        return separated_by(separator);
    }
    not_among(name, header, needed, &needed.join(","))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn read_text(text: &str) -> Result<Columns, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), text).unwrap();
        read(file.path(), &["displacement_m", "load_n"], &["time_s"]).map_err(|problem| problem.to_string())
    }

    #[test]
    fn columns_come_in_any_order_and_others_are_passed_over() {
        let table = read_text("# bench 3\nload_n,note,displacement_m\n1,\"a, b\",0.5\n\n2,?,0.75\n").unwrap();
        assert_eq!(table.column("load_n"), [1.0, 2.0]);
        assert_eq!(table.column("displacement_m"), [0.5, 0.75]);
        assert_eq!(table.get("time_s"), None);
        // Comments and blank lines count as lines: the number is the one an editor shows.
        assert_eq!(table.lines(), [3, 5]);
    }

    #[test]
    fn every_problem_is_reported_with_its_place() {
        for (text, message) in [
            ("", "the file is empty, expected a header line with displacement_m,load_n"),
            ("displacement_m,load_n\n", "there is a header but no row under it"),
            (
                "displacement_mm,load_n\n1,2\n",
                "column displacement_m is missing; the nearest name there is displacement_mm; \
                 found displacement_mm,load_n, expected displacement_m,load_n",
            ),
            ("displacement_m;load_n\n1;2\n", "the header is separated by ';', expected commas"),
            (
                "load_n,displacement_m,load_n\n1,2,3\n",
                "column load_n appears twice (columns 1 and 3), expected once: rename one",
            ),
            (
                "displacement_m,load_n\n1,2\n3,\n",
                "line 3, column load_n: found nothing, expected a finite number",
            ),
            (
                "displacement_m,load_n\n1,2\nNaN,4\n",
                "line 3, column displacement_m: found NaN, expected a finite number",
            ),
            (
                "displacement_m,load_n\n1 mm,2\n",
                "line 2, column displacement_m: found \"1 mm\", expected a finite number",
            ),
            ("displacement_m,load_n\n1\n", "line 2: found 1 cells, expected 2 as in the header"),
        ] {
            assert_eq!(read_text(text).unwrap_err(), message);
        }
    }
}
