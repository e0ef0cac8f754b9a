//! The table.

use std::collections::HashMap;

use crate::rows::{Row, Scalar};

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Column {
    /// Instructions a step in `f32` on the controller: mean and largest.
    Controller,
    Host(Scalar),
    Time(Scalar),
    Bytes(Scalar),
}

#[derive(Default)]
pub(crate) struct Table {
    cells: HashMap<(String, Column), String>,
    skipped: Vec<String>,
}

impl Table {
    pub(crate) fn put(&mut self, key: &str, column: Column, value: String) {
        self.cells.insert((key.to_owned(), column), value);
    }

    pub(crate) fn skip(&mut self, what: &str) {
        println!("SKIPPED: {what}");
        self.skipped.push(what.to_owned());
    }

    pub(crate) fn print(&self, rows: &[Row]) {
        let (ordinary, steps): (Vec<_>, Vec<_>) =
            rows.iter().partition(|row| row.key.starts_with("ordinary"));
        println!();
        println!(
            "| AEKF-UI, one step on | Cortex-M4F f32: mean, largest | x86-64 f32 | f64 | ns f32 | f64 | bytes f32 | f64 |"
        );
        println!("|---|---|---|---|---|---|---|---|");
        for row in steps {
            self.line(row.label, row.key);
        }
        self.line("filterpy", "filterpy");
        self.line("filterpy, without the factor", "without-factor-filterpy");
        println!("| **an ordinary EKF, the road a sixth state** | | | | | | | |");
        for row in ordinary {
            self.line(row.label, row.key);
        }
        self.line("filterpy", "ordinary-filterpy");
        for what in &self.skipped {
            println!("\nSKIPPED: {what}");
        }
    }

    fn line(&self, label: &str, key: &str) {
        let python = key.ends_with("filterpy");
        let columns = [
            Column::Controller,
            Column::Host(Scalar::F32),
            Column::Host(Scalar::F64),
            Column::Time(Scalar::F32),
            Column::Time(Scalar::F64),
            Column::Bytes(Scalar::F32),
            Column::Bytes(Scalar::F64),
        ];
        let cells = columns.map(|column| match self.cells.get(&(key.to_owned(), column)) {
            Some(value) => grouped(value),
            None if python && column != Column::Time(Scalar::F64) => "-".to_owned(),
            None => "SKIPPED".to_owned(),
        });
        println!("| {label} | {} |", cells.join(" | "));
    }
}

/// Digits by threes: `12 345`.
fn grouped(value: &str) -> String {
    let group = |number: &str| {
        let mut out = String::new();
        for (i, digit) in number.chars().enumerate() {
            if i > 0 && (number.len() - i).is_multiple_of(3) {
                out.push(' ');
            }
            out.push(digit);
        }
        out
    };
    value.split(", ").map(group).collect::<Vec<_>>().join(", ")
}
