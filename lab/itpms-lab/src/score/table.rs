//! The score as text: one aligned block per part, no wider than a terminal, plain characters.
//!
//! Called by the binary.

use super::row::{Cell, Row, Verdict};
use super::{Part, Score};

impl Score {
    /// The table, ending in a line that says what its marks mean.
    pub fn table(&self) -> String {
        let names: Vec<&str> = self.estimators.iter().map(|kind| kind.label()).collect();
        let last = self.first_seed.saturating_add(self.seeds as u64).saturating_sub(1);
        let mut text = format!("{}; seeds {} to {last}\n", names.join(", "), self.first_seed);
        let mut rows = self.rows.as_slice();
        while let Some(first) = rows.first() {
            // Several estimators stand below each other, one block per scenario.
            let same = |row: &&Row| {
                row.part == first.part
                    && headings(row) == headings(first)
                    && (self.estimators.len() == 1 || row.name == first.name)
            };
            let (block, rest) = rows.split_at(rows.iter().take_while(same).count());
            text.push('\n');
            if let Some(title) = Part::title(first.part).filter(|_| self.begins_part(first)) {
                text += &format!("{title}\n");
            }
            text += &match self.estimators.len() {
                1 => block_text("", block, |row| &row.name),
                _ => block_text(&first.name, block, |row| row.estimator.label()),
            };
            rows = rest;
        }
        text += "\n! misses its goal; stretch: the harder goal in brackets is reached, too\n";
        text
    }

    fn begins_part(&self, row: &Row) -> bool {
        self.rows.iter().find(|other| other.part == row.part).is_some_and(|other| std::ptr::eq(other, row))
    }
}

fn headings(row: &Row) -> Vec<&'static str> {
    row.cells.iter().map(|cell| cell.column.heading).collect()
}

/// Rows of the same headings; `corner` stands above their labels.
fn block_text<'a>(corner: &str, rows: &'a [Row], label: impl Fn(&'a Row) -> &'a str) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let shared: Vec<bool> = (0..first.cells.len())
        .map(|i| rows.iter().all(|row| row.cells[i].goal == first.cells[i].goal))
        .collect();
    let judged = first.verdict.is_some();
    let mut lines =
        vec![line(corner, "n", headings(first).iter().map(|h| (*h).to_owned()), judged.then_some(""))];
    if first.cells.iter().zip(&shared).any(|(cell, shared)| *shared && cell.goal.is_some()) {
        let goals = first.cells.iter().zip(&shared).map(|(cell, shared)| match cell.goal {
            // Room for the mark of a value that misses.
            Some(goal) if *shared => format!("{} ", goal.text()),
            _ => String::new(),
        });
        lines.push(line("  goal", "", goals, judged.then_some("")));
    }
    for row in rows {
        let cells = row.cells.iter().zip(&shared).map(|(cell, shared)| cell_text(cell, *shared));
        let verdict = row.verdict.map(|verdict| match verdict {
            Verdict::Missed => "MISSED",
            Verdict::Met => "met",
            Verdict::Stretch => "stretch",
        });
        lines.push(line(label(row), &row.drives.to_string(), cells, verdict));
    }
    aligned(&lines)
}

fn line(name: &str, drives: &str, cells: impl Iterator<Item = String>, verdict: Option<&str>) -> Vec<String> {
    let mut line = vec![name.to_owned(), drives.to_owned()];
    line.extend(cells);
    line.extend(verdict.map(str::to_owned));
    line
}

/// The value with its mark, and its goal where the heading does not say it.
fn cell_text(cell: &Cell, goal_in_heading: bool) -> String {
    let value = if cell.value.is_finite() {
        format!("{:.*}", cell.column.decimals, cell.value)
    } else {
        "none".to_owned()
    };
    match (cell.goal, cell.verdict) {
        (Some(goal), Some(verdict)) => {
            let mark = if verdict == Verdict::Missed { "!" } else { " " };
            if goal_in_heading { format!("{value}{mark}") } else { format!("{value}{mark}{}", goal.text()) }
        }
        _ => value,
    }
}

/// The first column to the left, all others to the right, two spaces between.
fn aligned(lines: &[Vec<String>]) -> String {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width = |i: usize| lines.iter().filter_map(|line| line.get(i)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|i| width(i).unwrap_or(0)).collect();
    let mut text = String::new();
    for line in lines {
        let cells = line.iter().zip(&widths).enumerate().map(|(i, (cell, &width))| match i {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        text += cells.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::row::{Column, Goal};
    use super::*;
    use itpms_paper::EstimatorKind;

    const X: Column = Column::new("x_kpa", "x", 1);

    #[test]
    fn columns_align_and_a_miss_is_marked() {
        let goal = Goal::AtMost(3.0);
        let rows = [
            row("short", vec![X.judged(2.0, goal), X.plain(10.25)]),
            row("a longer name", vec![X.judged(33.0, goal), X.plain(f64::NAN)]),
        ];
        let expected = "\
               n      x      x
  goal             <= 3
short          4   2.0    10.2     met
a longer name  4  33.0!   none  MISSED
";
        assert_eq!(squeezed(&text(&rows)), squeezed(expected));
        let widths: Vec<usize> = text(&rows).lines().skip(2).map(|line| line.chars().count()).collect();
        assert_eq!(widths[0], widths[1]);
    }

    #[test]
    fn goals_that_differ_stand_beside_their_values() {
        let rows =
            [14.0, 15.5].map(|limit| row("row", vec![X.judged(13.0, Goal::AtMostStretch(limit, 12.5))]));
        let text = text(&rows);
        assert!(text.contains("13.0 <= 14 (12.5)") && text.contains("13.0 <= 15.5 (12.5)"), "{text}");
    }

    fn text(rows: &[Row]) -> String {
        block_text("", rows, |row| &row.name)
    }

    fn row(name: &str, cells: Vec<Cell>) -> Row {
        Row::new("part", name, EstimatorKind::Informed, 4, cells)
    }

    fn squeezed(text: &str) -> Vec<String> {
        text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
    }
}
