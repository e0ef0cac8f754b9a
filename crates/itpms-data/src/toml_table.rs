//! A TOML table that knows its name and its lines, so that a complaint about a key can say where it is.
//!
//! Called by the readers of vehicle files and of learned references; knows nothing of cars.

use std::fmt::Write as _;

use itpms_core::model::ParameterError;
use itpms_files::nearest;
use toml::de::{DeTable, DeValue};

use crate::error::Problem;

/// The line (from one) of a byte offset.
fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count()
}

/// A text that is no TOML.
pub(crate) fn syntax_problem(text: &str, error: &toml::de::Error) -> Problem {
    let line = error.span().map_or(1, |span| line_of(text, span.start));
    Problem::Refused(format!("line {line}: not valid TOML: {}", error.message()))
}

pub(crate) struct Table<'a> {
    text: &'a str,
    entries: &'a DeTable<'a>,
    /// As in the file's header line: `[corner.fl]`; the root is `the file`.
    path: String,
    line: Option<usize>,
}

impl<'a> Table<'a> {
    pub(crate) fn root(text: &'a str, entries: &'a DeTable<'a>) -> Self {
        Self { text, entries, path: "the file".to_owned(), line: None }
    }

    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// The line of a key, or of the table where the key is not there.
    pub(crate) fn line_of_key(&self, key: &str) -> usize {
        self.entries
            .iter()
            .find(|(name, _)| name.get_ref() == key)
            .map(|(name, _)| line_of(self.text, name.span().start))
            .or(self.line)
            .unwrap_or(1)
    }

    /// Refuses the first key (by line) that is not among `known`.
    pub(crate) fn check_keys(&self, known: &[&str]) -> Result<(), Problem> {
        let stranger = self
            .entries
            .iter()
            .filter(|(key, _)| !known.contains(&key.get_ref().as_ref()))
            .min_by_key(|(key, _)| key.span().start);
        match stranger {
            None => Ok(()),
            Some((key, _)) => {
                let (line, key) = (line_of(self.text, key.span().start), key.get_ref());
                let meant = nearest(key, known.iter().copied());
                let meant = meant.map(|name| format!(" (did you mean {name}?)")).unwrap_or_default();
                let (table, known) = (&self.path, known.join(", "));
                Err(format!("line {line}: unknown key {key} in {table}{meant}, expected one of: {known}")
                    .into())
            }
        }
    }

    /// The table under `key`, if there is one.
    pub(crate) fn table(&self, key: &str) -> Result<Option<Table<'a>>, Problem> {
        let Some((name, value)) = self.entry(key) else { return Ok(None) };
        let DeValue::Table(entries) = value else { return Err(self.not_a(key, value, "a table")) };
        let path = match self.path.strip_prefix('[').and_then(|path| path.strip_suffix(']')) {
            Some(parent) => format!("[{parent}.{key}]"),
            None => format!("[{key}]"),
        };
        Ok(Some(Table { text: self.text, entries, path, line: Some(line_of(self.text, name)) }))
    }

    /// Whether there is anything under `key`.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.entry(key).is_some()
    }

    /// The table under `key`, or `None` where there is text, which may stand for a table with one entry.
    pub(crate) fn table_unless_text(&self, key: &str) -> Result<Option<Table<'a>>, Problem> {
        match self.entry(key) {
            Some((_, DeValue::Table(_))) => self.table(key),
            None | Some((_, DeValue::String(_))) => Ok(None),
            Some((_, value)) => Err(self.not_a(key, value, "text in quotes or a table in braces")),
        }
    }

    /// True or false under `key`, if there is one of them.
    pub(crate) fn flag(&self, key: &str) -> Result<Option<bool>, Problem> {
        match self.entry(key) {
            None => Ok(None),
            Some((_, DeValue::Boolean(flag))) => Ok(Some(*flag)),
            Some((_, value)) => Err(self.not_a(key, value, "true or false")),
        }
    }

    /// The number under `key`, integer or float, if there is one.
    pub(crate) fn number(&self, key: &str) -> Result<Option<f64>, Problem> {
        let Some((_, value)) = self.entry(key) else { return Ok(None) };
        number_of(value).map(Some).ok_or_else(|| self.not_a(key, value, "a number"))
    }

    /// The two numbers of an array under `key`, if there is one.
    pub(crate) fn pair(&self, key: &str) -> Result<Option<[f64; 2]>, Problem> {
        let Some((_, value)) = self.entry(key) else { return Ok(None) };
        let pair = numbers_of(value).and_then(|numbers| numbers.try_into().ok());
        pair.map(Some).ok_or_else(|| self.not_a(key, value, "an array of two numbers, front and rear"))
    }

    /// So many numbers under `key`, if there is something: an array, or one by itself.
    pub(crate) fn numbers(&self, key: &str, count: usize) -> Result<Option<Vec<f64>>, Problem> {
        if count == 1 {
            return Ok(self.number(key)?.map(|number| vec![number]));
        }
        let Some((_, value)) = self.entry(key) else { return Ok(None) };
        let numbers = numbers_of(value).filter(|numbers| numbers.len() == count);
        numbers.map(Some).ok_or_else(|| self.not_a(key, value, &format!("an array of {count} numbers")))
    }

    /// The number under `key`, which has to be there.
    pub(crate) fn needed_number(&self, key: &str) -> Result<f64, Problem> {
        self.number(key)?.ok_or_else(|| self.lacks(key))
    }

    /// The text under `key`, if there is some.
    pub(crate) fn text(&self, key: &str) -> Result<Option<String>, Problem> {
        let Some((_, value)) = self.entry(key) else { return Ok(None) };
        match value {
            DeValue::String(text) => Ok(Some(text.to_string())),
            _ => Err(self.not_a(key, value, "text in quotes")),
        }
    }

    /// A parameter out of its range, with the table and the line of its key.
    pub(crate) fn refuse(&self, error: ParameterError) -> Problem {
        Problem::Refused(format!("line {}: {} {error}", self.line_of_key(error.name), self.path))
    }

    pub(crate) fn lacks(&self, key: &str) -> Problem {
        let line = self.line.map(|line| format!(" (table at line {line})")).unwrap_or_default();
        Problem::Refused(format!("{} has no {key}{line}", self.path))
    }

    /// A text that is none of those that mean something here.
    pub(crate) fn unknown_value(&self, key: &str, text: &str, expected: &'static str) -> Problem {
        self.wrong(key, &format!("the text {text:?}"), expected)
    }

    /// Byte offset of the key, and its value.
    fn entry(&self, key: &str) -> Option<(usize, &'a DeValue<'a>)> {
        let (name, value) = self.entries.iter().find(|(name, _)| name.get_ref() == key)?;
        Some((name.span().start, value.get_ref()))
    }

    fn not_a(&self, key: &str, value: &DeValue<'_>, expected: &str) -> Problem {
        let found = match value {
            DeValue::String(text) => format!("the text {text:?}"),
            other => format!("of type {}", other.type_str()),
        };
        self.wrong(key, &found, expected)
    }

    pub(crate) fn wrong(&self, key: &str, found: &str, expected: &str) -> Problem {
        let (line, table) = (self.line_of_key(key), &self.path);
        Problem::Refused(format!("line {line}: {table} {key} is {found}, expected {expected}"))
    }
}

fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|integer| integer as f64)
        }
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

fn numbers_of(value: &DeValue<'_>) -> Option<Vec<f64>> {
    let DeValue::Array(values) = value else { return None };
    values.iter().map(|value| number_of(value.get_ref())).collect()
}

/// The inside of a TOML basic string.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}
