//! One recording among several in a table: rows of which a column has this value, `car=A`.
//!
//! Made from what a person types; asked by the sources of tables with every cell of that column, and with the keys in the names of a
//! folder's folders.

use std::fmt;
use std::str::FromStr;

use crate::error::Problem;

/// A column, or a key of a partitioned folder, and the value that the rows are to have there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selection {
    column: String,
    value: String,
}

const ANY: &str = "*";

impl Selection {
    pub(crate) fn column(&self) -> &str {
        &self.column
    }

    /// Whether this is the value that is asked for: the same text, or the same number.
    pub(crate) fn takes(&self, cell: &str) -> bool {
        let cell = cell.trim();
        self.value == ANY || cell == self.value || cell.parse().is_ok_and(|value| self.takes_number(value))
    }

    pub(crate) fn takes_number(&self, value: f64) -> bool {
        self.value == ANY || self.value.parse::<f64>().is_ok_and(|wanted| wanted == value)
    }

    pub(crate) fn place(&self, names: &[String]) -> Result<usize, Problem> {
        names.iter().position(|name| *name == self.column).ok_or_else(|| {
            let near = itpms_files::nearest(&self.column, names.iter().map(String::as_str));
            let near = near.map_or_else(String::new, |name| format!("; the nearest name there is {name}"));
            Problem::Refused(format!("there is no column {} to select {self} by{near}", self.column))
        })
    }

    /// The problem where no row has the value.
    pub(crate) fn nowhere(selections: &[Self]) -> Problem {
        let all = selections.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and ");
        Problem::Refused(format!("no row has {all}, expected a value that is there"))
    }
}

impl FromStr for Selection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((column, value)) if !column.trim().is_empty() && !value.trim().is_empty() => {
                Ok(Self { column: column.trim().to_owned(), value: value.trim().to_owned() })
            }
            _ => Err(format!("found {text:?}, expected a column and its value, as car=A")),
        }
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.column, self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_text_and_numbers_are_numbers() {
        let car: Selection = "car = A".parse().unwrap();
        assert!(car.takes("A") && car.takes(" A ") && !car.takes("a") && !car.takes("AB"));
        let drive: Selection = "drive=7".parse().unwrap();
        assert!(drive.takes("7") && drive.takes("7.0") && drive.takes_number(7.0) && !drive.takes("07b"));
        assert!("bucket=*".parse::<Selection>().unwrap().takes("3"));
        for text in ["car", "=A", "car=", ""] {
            assert!(text.parse::<Selection>().is_err(), "{text}");
        }
    }
}
