//! Which column of a table tells its recordings apart, and so what to ask for.
//!
//! Called by the reader once it has found two recordings in turns; the file is read anew for it.

use std::collections::BTreeSet;
use std::path::Path;

use itpms_files::{input, shortened};

use super::format::Format;
use super::lines::Lines;
use super::survey::SURVEY_ROWS;
use super::text_head::TextHead;
use crate::error::Problem;
use crate::signals::names::meaning;

const MOST: usize = 8;
/// Share of the rows in which it is another one than in the row before.
const CHANGES: f64 = 0.25;

/// What to do about a table of two recordings: say which by a column that has another value with every row or two.
pub(super) fn way_out(path: &Path, format: Format) -> Option<String> {
    let (names, rows) = match format {
        Format::Csv if input::is_stdin(path) => return None,
        Format::Csv => text_rows(path).ok()??,
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet_columns::first_rows(path, SURVEY_ROWS)?,
    };
    (0..names.len()).find_map(|column| {
        let cells = || rows.iter().filter_map(|row| row.get(column));
        let values: BTreeSet<&String> = cells().collect();
        let changes = cells().zip(cells().skip(1)).filter(|(a, b)| a != b).count();
        let tells = (2..=MOST).contains(&values.len())
            && changes as f64 > CHANGES * rows.len() as f64
            && meaning("", &names[column]).is_none();
        let value = values.first().filter(|_| tells)?;
        let (name, value) = (shortened(&names[column]), shortened(value));
        Some(format!("column {name} tells them apart: --where {name}={value}"))
    })
}

type Rows = (Vec<String>, Vec<Vec<String>>);

fn text_rows(path: &Path) -> Result<Option<Rows>, Problem> {
    let mut lines = Lines::new(input::open(path)?.0);
    let Some(head) = TextHead::read(&mut lines)? else { return Ok(None) };
    let mut rows = Vec::new();
    while rows.len() < SURVEY_ROWS && lines.advance()? {
        rows.push(head.dialect.names(lines.text()));
    }
    Ok(Some((head.names, rows)))
}
