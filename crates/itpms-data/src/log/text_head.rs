//! The beginning of a text table: how it separates, its names, and the row of units that some have under them.
//!
//! Called by the reader and by the list of text tables.

use super::dialect::Dialect;
use super::lines::Lines;
use crate::error::Problem;
use crate::signals::is_unit;

/// What stands before the first row.
#[derive(Debug, Clone)]
pub(crate) struct TextHead {
    pub(crate) dialect: Dialect,
    pub(crate) names: Vec<String>,
    /// The unit of each column, empty where none is stated; without elements where the table has no such row.
    pub(crate) units: Vec<String>,
    /// The line of the names.
    line: Vec<u8>,
}

impl TextHead {
    /// Reads it; `None` from an empty file.
    pub(crate) fn read(lines: &mut Lines) -> Result<Option<Self>, Problem> {
        if !lines.advance()? {
            return Ok(None);
        }
        let stated = Dialect::stated(lines.text());
        if stated.is_some() && !lines.advance()? {
            return Ok(None);
        }
        let dialect = stated.unwrap_or_else(|| Dialect::of(lines.text()));
        let line = lines.text().to_vec();
        let mut head = Self { dialect, names: dialect.names(&line), units: Vec::new(), line };
        if lines.advance()? {
            match head.units_in(lines.text()) {
                Some(units) => head.units = units,
                None => lines.put_back(),
            }
        }
        Ok(Some(head))
    }

    /// Whether a line is the names once more: a logger that was started again, files that were put together.
    pub(crate) fn is_names(&self, line: &[u8]) -> bool {
        line == self.line
    }

    /// The units in the line under the names, if it holds units and nothing else.
    fn units_in(&self, line: &[u8]) -> Option<Vec<String>> {
        let units = self.dialect.names(line);
        let no_unit = |cell: &str| ["", "-", "[]", "[-]"].contains(&cell);
        let known = units.iter().filter(|cell| is_unit(cell)).count();
        let all = units.iter().all(|cell| no_unit(cell) || is_unit(cell));
        (all && known > 0 && units.len() == self.names.len()).then_some(units)
    }
}
