//! Columns of numbers and words, as CSV and as JSON: what a figure draws and a table states.
//!
//! Filled by the sections, written by whoever writes files. The same values give the same bytes.

use std::fmt::Write as _;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

/// Significant digits of a number in a file.
const DIGITS: i32 = 8;

#[derive(Debug, Clone, PartialEq)]
enum Values {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

/// Named columns. `name` is that of the files, without ending; columns carry their unit in their name.
#[derive(Debug, Clone, PartialEq)]
pub struct Data {
    pub(super) name: String,
    title: String,
    columns: Vec<(String, Values)>,
}

impl Data {
    pub fn new(name: impl Into<String>, title: impl Into<String>) -> Self {
        Self { name: name.into(), title: title.into(), columns: vec![] }
    }

    /// One more column of numbers; what is not finite is an empty cell, and `null` in JSON.
    pub fn numbers(mut self, name: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        self.columns.push((name.into(), Values::Numbers(values.into_iter().map(rounded).collect())));
        self
    }

    pub fn text(mut self, name: impl Into<String>, values: impl IntoIterator<Item = String>) -> Self {
        self.columns.push((name.into(), Values::Words(values.into_iter().collect())));
        self
    }

    /// Both coordinates of a curve as two columns.
    pub fn curve(self, x: &str, y: &str, points: &[(f64, f64)]) -> Self {
        self.numbers(x, points.iter().map(|p| p.0)).numbers(y, points.iter().map(|p| p.1))
    }

    /// Comma-separated, a header line, a line feed after each row. Shorter columns end in empty cells.
    pub fn csv(&self) -> String {
        let mut text = self.columns.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(",");
        text.push('\n');
        let rows = self.columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
        for row in 0..rows {
            for (i, (_, values)) in self.columns.iter().enumerate() {
                if i > 0 {
                    text.push(',');
                }
                values.cell(row, &mut text);
            }
            text.push('\n');
        }
        text
    }

    /// `{"name": .., "title": .., "columns": {name: [..]}}`, columns in their order.
    /// Errors: never for what can be put into it; the serializer's interface has an error.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self).map(|text| text + "\n")
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Words(values) => values.len(),
        }
    }

    fn cell(&self, row: usize, text: &mut String) {
        match self {
            Self::Numbers(values) => {
                if let Some(value) = values.get(row).filter(|value| value.is_finite()) {
                    // Writing to a string cannot fail.
                    let _ = write!(text, "{value}");
                }
            }
            Self::Words(values) => {
                let word = values.get(row).map_or("", String::as_str);
                if word.contains([',', '"', '\n']) {
                    let _ = write!(text, "\"{}\"", word.replace('"', "\"\""));
                } else {
                    text.push_str(word);
                }
            }
        }
    }
}

/// To so many significant digits; minus zero is zero.
fn rounded(value: f64) -> f64 {
    if !value.is_finite() || value == 0.0 {
        return if value.is_finite() { 0.0 } else { f64::NAN };
    }
    let place = DIGITS - 1 - value.abs().log10().floor() as i32;
    let power = 10f64.powi(place.abs());
    if place >= 0 { (value * power).round() / power } else { (value / power).round() * power }
}

impl Serialize for Data {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("name", &self.name)?;
        map.serialize_entry("title", &self.title)?;
        map.serialize_entry("columns", &Columns(&self.columns))?;
        map.end()
    }
}

struct Columns<'a>(&'a [(String, Values)]);

impl Serialize for Columns<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, values) in self.0 {
            match values {
                // serde_json writes what is not finite as null.
                Values::Numbers(values) => map.serialize_entry(name, values)?,
                Values::Words(values) => map.serialize_entry(name, values)?,
            }
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_short_and_missing_ones_empty() {
        let data = Data::new("t", "T")
            .numbers("x_m", [0.1 + 0.2, f64::NAN, -0.0])
            .text("note", ["a, b".to_owned(), "say \"c\"".to_owned()]);
        assert_eq!(data.csv(), "x_m,note\n0.3,\"a, b\"\n,\"say \"\"c\"\"\"\n0,\n");
        let json = data.json().unwrap();
        assert_eq!(
            json,
            "{\"name\":\"t\",\"title\":\"T\",\"columns\":{\"x_m\":[0.3,null,0.0],\"note\":[\"a, b\",\"say \\\"c\\\"\"]}}\n"
        );
    }
}
