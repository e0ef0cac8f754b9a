//! The table at the top: every number the paper prints, ours beside it, and a word on what agrees.
//!
//! Called by [`super::reproduce`].

use itpms_paper::EstimatorKind;

use super::data::Data;
use super::outcome::Outcome;
use super::plan::{Outcomes, RESET_LONG_S};
use super::published::{
    FIG_7, FIG_9A, FIG_9B, FIG_12, REGRESSION, Row, SLOPE, TABLE_3, TABLE_4, TABLE_5, change_percent,
};
use super::section::{Section, Table, number, signed};
use super::standing::{spread, verdict};
use super::tire::regression;
use crate::runner::Result;
use crate::score::stats::Spread;

/// A row: where, what, the paper's number, ours, a comment.
struct Line {
    place: String,
    case: String,
    unit: &'static str,
    paper: f64,
    decimals: usize,
    ours: Spread,
    comment: String,
}

impl Line {
    fn errors(place: impl Into<String>, case: impl Into<String>, paper: f64, ours: Spread) -> Self {
        let comment = verdict(paper, &ours);
        Self { place: place.into(), case: case.into(), unit: "kPa", paper, decimals: 2, ours, comment }
    }

    fn because(mut self, reason: &str) -> Self {
        self.comment = format!("{} {reason}", self.comment);
        self
    }

    fn single(
        place: &str,
        case: &str,
        unit: &'static str,
        paper: f64,
        ours: f64,
        decimals: usize,
        comment: String,
    ) -> Self {
        let ours = Spread { p10: ours, median: ours, p90: ours };
        Self { place: place.to_owned(), case: case.to_owned(), unit, paper, decimals, ours, comment }
    }

    fn ours(&self) -> String {
        if self.ours.p10 == self.ours.p90 && self.ours.p10.is_finite() {
            number(self.ours.median, self.decimals)
        } else {
            spread(&self.ours, self.decimals)
        }
    }
}

pub(super) fn section(outcomes: &Outcomes, slopes: Spread, drives: usize) -> Result<Section> {
    let mut lines = regression_lines(slopes)?;
    lines.push(
        Line::errors("Fig. 7", "241.3 to 137.9 kPa in 2.5 s", FIG_7, outcomes.drop.informed_rmse())
            .because("Ours is another estimator: the published one does not move."),
    );
    lines.push(
        Line::errors("Fig. 9a", "241.3 to 41.4 kPa in 2.5 s", FIG_9A, outcomes.deep.informed_rmse())
            .because("Ours can jump, and pays only for the seconds before it notices."),
    );
    lines.push(
        Line::errors("Fig. 9b", "241.3 to 138 to 195 kPa", FIG_9B, outcomes.recover.informed_rmse())
            .because("Ours can jump here, too."),
    );
    study(&mut lines, "Table 3", "simulated", " kg", &TABLE_3, &outcomes.mass);
    let bench = Line::errors(
        "Fig. 12",
        "test bed, 224 to 142 kPa in 5 s, reset of 20 s",
        FIG_12,
        outcomes.bench_drop.informed_rmse(),
    );
    lines.push(
        bench.because(
            "A simulated test bed whose car is exactly as its file; the seconds of the reset count.",
        ),
    );
    if let Some(informed) = outcomes.bench_drop.informed() {
        lines.push(
            Line::errors("Fig. 12", "the same, after the reset only", FIG_12, informed.after)
                .because("A simulated test bed, as before."),
        );
    }
    if let Some(without) = outcomes.bench_drop.records.last() {
        lines.push(
            Line::errors("Fig. 12", "the same, without a reset", FIG_12, without.rmse)
                .because("A repeated road tells changes of the stiffness, hardly its level."),
        );
    }
    study(&mut lines, "Table 4", "test bed", " kg", &TABLE_4, &outcomes.bench_mass);
    study(&mut lines, "Table 5", "test bed, noise variance", "", &TABLE_5, &outcomes.bench_noise);
    let caption = format!(
        "RMSE in kPa unless stated. Ours: the default estimator <code>informed</code>, median over {drives} drives with different roads and noise, in brackets 10 to 90 % of \
         the drives; RMSE over t > 3 s, on the test bed with a reset of the first {RESET_LONG_S} s, Tables 4 and 5 after it. The paper's are single runs of AEKF-UI."
    );
    Ok(Section::new("summary", "Every number of the paper, and ours").table(table(&lines), caption))
}

fn regression_lines(slopes: Spread) -> Result<Vec<Line>> {
    let (map, r2) = regression()?;
    let (slope, intercept, paper_r2) = REGRESSION;
    let off = |ours: f64, paper: f64| format!("Differs by {} %.", signed(100.0 * (ours / paper - 1.0), 2));
    let (ours_slope, ours_zero) = (map.stiffness_per_kpa(), map.stiffness_at_zero());
    let inside = (slopes.p10..=slopes.p90).contains(&SLOPE);
    Ok(vec![
        Line::single("Fig. 3", "slope", "N/m per kPa", slope, ours_slope, 2, off(ours_slope, slope)),
        Line::single("Fig. 3", "at zero", "N/m", intercept, ours_zero, 0, off(ours_zero, intercept)),
        Line::single(
            "Fig. 3",
            "R²",
            "",
            paper_r2,
            r2,
            5,
            "Differs: the printed five points lie closer to a line than the printed R² says.".to_owned(),
        ),
        Line {
            place: "Fig. 5".to_owned(),
            case: "slope of the road's spectrum, as −w".to_owned(),
            unit: "",
            paper: SLOPE,
            decimals: 2,
            ours: slopes,
            comment: format!(
                "Ours are fits to single records of 222 m of roads that are drawn with exactly the paper's slope, which lies {} their 10 to 90 %.",
                if inside { "inside" } else { "outside" }
            ),
        },
    ])
}

fn study(
    lines: &mut Vec<Line>,
    place: &str,
    what: &str,
    unit: &str,
    rows: &[Row; 3],
    outcomes: &[Outcome; 3],
) {
    let after = |outcome: &Outcome| outcome.judged(EstimatorKind::Informed);
    let nominal =
        rows.iter().position(|row| row.printed.is_empty()).and_then(|i| outcomes.get(i)).and_then(after);
    for (row, outcome) in rows.iter().zip(outcomes) {
        let Some(ours) = after(outcome) else { continue };
        let mut line = Line::errors(place, format!("{what}, {}{unit}", row.setting), row.rmse_kpa, ours);
        if let (Some(paper), Some(nominal)) = (change_percent(rows, row), nominal) {
            let change = 100.0 * (ours.median / nominal.median - 1.0);
            line = line.because(&format!(
                "Change against nominal: paper {} % (printed {}), ours {} %.",
                signed(paper, 1),
                row.printed,
                signed(change, 1)
            ));
            if row.printed == "35%" {
                line = line.because("The paper calls this \"no significant change\".");
            }
        }
        lines.push(line);
    }
}

fn table(lines: &[Line]) -> Table {
    let column = |pick: fn(&Line) -> f64| lines.iter().map(pick).collect::<Vec<_>>();
    let data = Data::new("summary", "Every number of the paper, and ours")
        .text("where", lines.iter().map(|line| line.place.clone()))
        .text("case", lines.iter().map(|line| line.case.clone()))
        .text("unit", lines.iter().map(|line| line.unit.to_owned()))
        .numbers("paper", column(|line| line.paper))
        .numbers("ours_median", column(|line| line.ours.median))
        .numbers("ours_p10", column(|line| line.ours.p10))
        .numbers("ours_p90", column(|line| line.ours.p90))
        .text("comment", lines.iter().map(|line| line.comment.clone()));
    let mut table = Table::new(
        "The paper and itpms",
        &["Where", "Case", "Paper", "Ours", "Agrees, or differs because"],
        data,
    );
    for line in lines {
        let unit = if matches!(line.unit, "" | "kPa") { String::new() } else { format!(" ({})", line.unit) };
        table = table.row([
            line.place.clone(),
            format!("{}{unit}", line.case),
            format!("{}", line.paper),
            line.ours(),
            line.comment.clone(),
        ]);
    }
    table
}
