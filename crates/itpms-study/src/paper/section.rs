//! The study as a reader meets it: sections of text, figures and tables.
//!
//! Filled by the experiments; shown by `page`, written as files by [`super::Study`].

use super::data::Data;
use crate::plot::{Figure, escape};

/// A chapter of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Anchor, unique on the page.
    pub(super) id: String,
    pub(super) title: String,
    pub(super) parts: Vec<Part>,
}

/// A piece of a section.
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
    /// An empty section; `id` is its anchor.
    #[must_use]
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self { id: id.into(), title: title.into(), parts: vec![] }
    }

    /// HTML of whole elements: paragraphs, lists.
    #[must_use]
    pub fn text(mut self, html: impl Into<String>) -> Self {
        self.parts.push(Part::Text(html.into()));
        self
    }

    /// A figure with its caption (HTML) and its data, each written under its own name; one of them should be named as
    /// the figure.
    #[must_use]
    pub fn figure(mut self, figure: Figure, caption: impl Into<String>, data: Vec<Data>) -> Self {
        self.parts.push(Part::Figure { figure, caption: caption.into(), data });
        self
    }

    /// A table with its caption (HTML).
    #[must_use]
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
    /// Title, column heads, data.
    #[must_use]
    pub fn new(title: impl Into<String>, head: &[&str], data: Data) -> Self {
        let head = head.iter().map(|&word| word.to_owned()).collect();
        Self { title: title.into(), head, rows: vec![], data }
    }

    /// One more row.
    #[must_use]
    pub fn row(mut self, cells: impl IntoIterator<Item = String>) -> Self {
        self.rows.push(cells.into_iter().collect());
        self
    }

    /// The `table` element. Cells are texts, not HTML; the first of a row is its head.
    pub(super) fn html(&self) -> String {
        let head: String =
            self.head.iter().map(|word| format!("<th scope=\"col\">{}</th>", escape(word))).collect();
        let row = |cells: &Vec<String>| {
            let cell = |(i, text): (usize, &String)| match i {
                0 => format!("<th scope=\"row\">{}</th>", escape(text)),
                _ if is_number(text) => format!("<td class=\"n\">{}</td>", escape(text)),
                _ => format!("<td>{}</td>", escape(text)),
            };
            format!("<tr>{}</tr>", cells.iter().enumerate().map(cell).collect::<String>())
        };
        let body: String = self.rows.iter().map(row).collect();
        format!("<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")
    }
}

/// Cells that are figures stand to the right.
fn is_number(text: &str) -> bool {
    text.chars().next().is_some_and(|first| first.is_ascii_digit() || "+\u{2212}–".contains(first))
        && text.chars().count() < 22
}

/// With so many decimals; what is infinite has diverged, what is none is a dash.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else if value.is_infinite() {
        "diverged".to_owned()
    } else {
        format!("{value:.decimals$}").replace('-', "\u{2212}")
    }
}

/// With its sign.
pub(super) fn signed(value: f64, decimals: usize) -> String {
    let plus = if value > 0.0 { "+" } else { "" };
    if value.is_finite() { format!("{plus}{}", number(value, decimals)) } else { "–".to_owned() }
}
