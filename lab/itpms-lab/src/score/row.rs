//! Rows of the score: rows of cells, each with its goal and whether it is met.
//!
//! Filled by the parts of the score; read by the table, by `--json` and by whoever keeps books.

use itpms_paper::EstimatorKind;
use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    AtMost(f64),
    /// Not more, and better still not more than the second.
    AtMostStretch(f64, f64),
    /// Not further from zero.
    WithinOfZero(f64),
    AtLeast(f64),
    Between(f64, f64),
}

/// How a figure stands to its goal, worst first. JSON: `missed`, `met`, `stretch`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    Missed,
    Met,
    /// Reached, and the harder goal as well.
    Stretch,
}

impl Goal {
    /// How `value` stands to it; NaN misses.
    pub fn verdict(self, value: f64) -> Verdict {
        let met = match self {
            Goal::AtMost(limit) | Goal::AtMostStretch(limit, _) => value <= limit,
            Goal::WithinOfZero(limit) => value.abs() <= limit,
            Goal::AtLeast(limit) => value >= limit,
            Goal::Between(low, high) => value >= low && value <= high,
        };
        match self {
            Goal::AtMostStretch(_, stretch) if met && value <= stretch => Verdict::Stretch,
            _ if met => Verdict::Met,
            _ => Verdict::Missed,
        }
    }

    /// In the table: `<= 14 (12.5)`.
    pub fn text(self) -> String {
        match self {
            Goal::AtMost(limit) => format!("<= {limit}"),
            Goal::AtMostStretch(limit, stretch) => format!("<= {limit} ({stretch})"),
            Goal::WithinOfZero(limit) => format!("+-{limit}"),
            Goal::AtLeast(limit) => format!(">= {limit}"),
            Goal::Between(low, high) => format!("{low}-{high}"),
        }
    }
}

/// Column of a figure: its name in JSON, its heading in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Column {
    pub name: &'static str,
    #[serde(skip)]
    pub heading: &'static str,
    #[serde(skip)]
    pub decimals: usize,
}

impl Column {
    pub const fn new(name: &'static str, heading: &'static str, decimals: usize) -> Self {
        Self { name, heading, decimals }
    }

    pub fn plain(self, value: f64) -> Cell {
        Cell { column: self, value, goal: None, verdict: None }
    }

    pub fn judged(self, value: f64, goal: Goal) -> Cell {
        Cell { column: self, value, goal: Some(goal), verdict: Some(goal.verdict(value)) }
    }
}

/// One figure. JSON: `name`, `value` (null when not finite), `goal` (null or for example `{"at_most": 17.0}`), `verdict`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    #[serde(flatten)]
    pub column: Column,
    pub value: f64,
    pub goal: Option<Goal>,
    pub verdict: Option<Verdict>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Part of the score it belongs to: rows of a part have the same columns.
    pub part: &'static str,
    /// Its name; name and estimator are unique within the part.
    pub name: String,
    #[serde(serialize_with = "label")]
    pub estimator: EstimatorKind,
    pub drives: usize,
    pub cells: Vec<Cell>,
    /// The worst verdict of its cells; none if no cell has a goal.
    pub verdict: Option<Verdict>,
}

impl Row {
    pub fn new(
        part: &'static str,
        name: impl Into<String>,
        estimator: EstimatorKind,
        drives: usize,
        cells: Vec<Cell>,
    ) -> Self {
        let verdict = cells.iter().filter_map(|cell| cell.verdict).min();
        Self { part, name: name.into(), estimator, drives, cells, verdict }
    }

    pub(super) fn of_default(
        part: &'static str,
        name: impl Into<String>,
        drives: usize,
        cells: Vec<Cell>,
    ) -> Self {
        Self::new(part, name, EstimatorKind::default(), drives, cells)
    }

    pub fn cell(&self, name: &str) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.column.name == name)
    }
}

fn label<S: serde::Serializer>(kind: &EstimatorKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.label())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_judge_and_nan_misses() {
        let stretch = Goal::AtMostStretch(14.0, 12.5);
        for (value, verdict) in [(12.5, Verdict::Stretch), (14.0, Verdict::Met), (14.1, Verdict::Missed)] {
            assert_eq!(stretch.verdict(value), verdict);
        }
        assert_eq!(Goal::WithinOfZero(8.0).verdict(-8.5), Verdict::Missed);
        assert_eq!(Goal::AtLeast(0.8).verdict(0.9), Verdict::Met);
        assert_eq!(Goal::Between(0.93, 0.98).verdict(0.985), Verdict::Missed);
        for goal in
            [stretch, Goal::AtMost(1.0), Goal::WithinOfZero(1.0), Goal::AtLeast(1.0), Goal::Between(0.0, 1.0)]
        {
            assert_eq!(goal.verdict(f64::NAN), Verdict::Missed);
        }
    }

    #[test]
    fn a_row_is_as_good_as_its_worst_cell() {
        let column = Column::new("x", "x", 1);
        let row = Row::new(
            "part",
            "row",
            EstimatorKind::Informed,
            1,
            vec![
                column.judged(1.0, Goal::AtMostStretch(3.0, 2.0)),
                column.judged(2.5, Goal::AtMost(3.0)),
                column.plain(9.0),
            ],
        );
        assert_eq!(row.verdict, Some(Verdict::Met));
        assert_eq!(
            Row::new("part", "row", EstimatorKind::Informed, 1, vec![column.plain(9.0)]).verdict,
            None
        );
    }
}
