//! The study as a reader meets it: sections of text, figures and tables.
//!
//! Filled by the experiments; shown by `page`, written as files by [`super::Study`].

use super::data::Data;
use itpms_analysis::plot::{Figure, escape};

#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    pub(super) id: String,
    pub(super) title: String,
    pub(super) parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Part {
    /// HTML of whole elements.
    Text(String),
    /// With a caption in HTML and what is drawn.
    Figure {
        figure: Figure,
        caption: String,
        data: Vec<Data>,
    },
    Table {
        table: Table,
        caption: String,
    },
}

impl Section {
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self { id: id.into(), title: title.into(), parts: vec![] }
    }

    /// HTML of whole elements: paragraphs, lists.
    pub fn text(mut self, html: impl Into<String>) -> Self {
        self.parts.push(Part::Text(html.into()));
        self
    }

    /// A figure with its caption (HTML) and its data, each written under its own name; one of them should be named as the figure.
    pub fn figure(mut self, figure: Figure, caption: impl Into<String>, data: Vec<Data>) -> Self {
        self.parts.push(Part::Figure { figure, caption: caption.into(), data });
        self
    }

    pub fn table(mut self, table: Table, caption: impl Into<String>) -> Self {
        self.parts.push(Part::Table { table, caption: caption.into() });
        self
    }
}

/// A table: what the page shows as words, and the same unrounded as data. The data's name is the table's.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub(super) title: String,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
    pub(super) data: Data,
}

impl Table {
    pub fn new(title: impl Into<String>, head: &[&str], data: Data) -> Self {
        let head = head.iter().map(|&word| word.to_owned()).collect();
        Self { title: title.into(), head, rows: vec![], data }
    }

    pub fn row(mut self, cells: impl IntoIterator<Item = String>) -> Self {
        self.rows.push(cells.into_iter().collect());
        self
    }

    /// The `table` element. Cells are texts, not HTML; the first of a row is its head. Columns of numbers lie to the right.
    pub(super) fn html(&self) -> String {
        let has_numbers =
            |i: usize| i > 0 && self.rows.iter().all(|row| row.get(i).is_none_or(|text| is_number(text)));
        let class = |i: usize| if has_numbers(i) { " class=\"n\"" } else { "" };
        let head =
            |(i, word): (usize, &String)| format!("<th scope=\"col\"{}>{}</th>", class(i), escape(word));
        let head: String = self.head.iter().enumerate().map(head).collect();
        let row = |cells: &Vec<String>| {
            let cell = |(i, text): (usize, &String)| match i {
                0 => format!("<th scope=\"row\">{}</th>", escape(text)),
                _ => format!("<td{}>{}</td>", class(i), escape(text)),
            };
            format!("<tr>{}</tr>", cells.iter().enumerate().map(cell).collect::<String>())
        };
        let body: String = self.rows.iter().map(row).collect();
        format!("<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")
    }

    /// The first `columns` of it as text for a terminal, in ASCII, a line feed after each row.
    pub(super) fn text(&self, columns: usize) -> String {
        let lines: Vec<Vec<String>> = std::iter::once(&self.head)
            .chain(&self.rows)
            .map(|cells| cells.iter().take(columns).map(|cell| ascii(cell)).collect())
            .collect();
        let length = |text: &str| text.chars().count();
        let widths: Vec<usize> = (0..columns)
            .map(|i| lines.iter().map(|cells| cells.get(i).map_or(0, |text| length(text))).max().unwrap_or(0))
            .collect();
        let mut text = String::new();
        for cells in lines {
            let mut line = String::new();
            for (cell, width) in cells.into_iter().zip(&widths) {
                line += &cell;
                line.extend(std::iter::repeat_n(' ', width + 2 - length(&cell)));
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

fn ascii(text: &str) -> String {
    let plain = |c| match c {
        '–' | '\u{2212}' => "-".to_owned(),
        '\u{2009}' => " ".to_owned(),
        '²' => "^2".to_owned(),
        other => other.to_string(),
    };
    text.chars().map(plain).collect()
}

/// Cells that are figures stand to the right.
fn is_number(text: &str) -> bool {
    let begins =
        text.chars().next().is_some_and(|first| first.is_ascii_digit() || "+\u{2212}–".contains(first));
    matches!(text, "nominal" | "diverged") || (begins && text.chars().count() < 32)
}

/// With so many decimals; what is infinite has diverged, what is none is a dash.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else if value.is_infinite() {
        "diverged".to_owned()
    } else {
        let text = format!("{:.decimals$}", value.abs());
        let zero = !text.chars().any(|c| c.is_ascii_digit() && c != '0');
        let sign = if value < 0.0 && !zero { "\u{2212}" } else { "" };
        match text.split_at_checked(text.len().saturating_sub(3)) {
            // From five digits on a thin space between thousands; nothing here reaches a million.
            Some((thousands, rest)) if decimals == 0 && thousands.len() > 1 => {
                format!("{sign}{thousands}\u{2009}{rest}")
            }
            _ => format!("{sign}{text}"),
        }
    }
}

pub(super) fn signed(value: f64, decimals: usize) -> String {
    let text = number(value, decimals);
    let zero = !text.chars().any(|c| c.is_ascii_digit() && c != '0');
    match value.is_finite() {
        true if value > 0.0 && !zero => format!("+{text}"),
        true => text,
        false => "–".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_people_read_them() {
        assert_eq!(number(-1.25, 1), "\u{2212}1.2");
        assert_eq!((number(-0.04, 1).as_str(), signed(0.04, 1).as_str()), ("0.0", "0.0"));
        assert_eq!((number(60_973.6, 0).as_str(), number(9_999.0, 0).as_str()), ("60\u{2009}974", "9999"));
        assert_eq!(signed(3.0, 1), "+3.0");
        assert_eq!((number(f64::INFINITY, 1).as_str(), number(f64::NAN, 1).as_str()), ("diverged", "–"));
    }
}
