//! The three robustness studies, alike in form: sprung mass simulated (Fig. 10, Table 3), sprung mass on the test bed
//! (Fig. 14, Table 4), sensor noise on the test bed (Fig. 16, Table 5).
//!
//! Called by the sections that hold them.

use itpms_paper::EstimatorKind;

use super::data::Data;
use super::histories::{data, errors, forgetting_factors, overlaid, pressure, variance_axis};
use super::outcome::{Outcome, Record};
use super::published::{Row, change_percent};
use super::section::{Section, Table, number, signed};
use super::standing::{spread, standing};
use itpms_analysis::plot::{Axis, Figure, Ink, Panel};

pub(super) struct Study<'a> {
    pub(super) figure: u32,
    pub(super) table: u32,
    pub(super) title: &'static str,
    /// The quantity that the rows change, with its unit, and the same for a column.
    pub(super) what: &'static str,
    pub(super) column: &'static str,
    /// One word per row: `220 kg`.
    pub(super) settings: [String; 3],
    pub(super) rows: &'a [Row; 3],
    pub(super) outcomes: &'a [Outcome; 3],
    pub(super) range_kpa: (f64, f64),
    pub(super) error_top_kpa: f64,
}

impl Study<'_> {
    fn nominal(&self) -> Option<&Outcome> {
        self.rows.iter().position(|row| row.printed.is_empty()).and_then(|i| self.outcomes.get(i))
    }

    /// Figure, table of errors and the paper's table, after `text`.
    pub(super) fn add_to(&self, section: Section, caption: &str, table_caption: &str) -> Section {
        let name = format!("figure-{:02}", self.figure);
        let more = self.outcomes.iter().zip(&self.settings).enumerate().map(|(i, (outcome, setting))| {
            let file = if i == 0 { name.clone() } else { format!("{name}-{}", i + 1) };
            data(&file, &format!("{}: {setting}; first seed", self.title), outcome, "")
        });
        let cases: Vec<(String, &Outcome)> = self.settings.iter().cloned().zip(self.outcomes).collect();
        section.figure(self.draw(&name), caption, more.collect()).table(self.compared(), table_caption).table(
            standing(
                &format!("{name}-errors"),
                &format!("Errors in the cases of Figure {}, all estimators", self.figure),
                self.what,
                &cases,
            ),
            "Median over the seeds, in brackets 10 to 90 %.",
        )
    }

    fn draw(&self, name: &str) -> Figure {
        let mut figure = Figure::new(name, format!("Figure {}: {}", self.figure, self.title)).describe(
            "Pressure under three settings; forgetting factor, error and covariance of all of them.",
        );
        for ((letter, outcome), setting) in
            ["a1", "a2", "a3"].into_iter().zip(self.outcomes).zip(&self.settings)
        {
            figure =
                figure.panel(pressure(letter, &format!("Tire pressure, {setting}"), outcome, self.range_kpa));
        }
        let end = self.outcomes.first().map_or(0.0, |outcome| outcome.duration_s);
        let x = || Axis::linear("Time", "s").within(0.0, end);
        let panel = |letter: &str, title: &str, y: Axis| Panel::new(letter, title, x(), y);
        let top = self.error_top_kpa;
        let b =
            panel("b", "Forgetting factor", Axis::logarithmic("Forgetting factor λ", "").within(0.9, 100.0));
        let c =
            panel("c", "Error of the pressure", Axis::linear("Estimate − truth", "kPa").within(-top, top));
        let d = panel("d", "Error covariance claimed", variance_axis(self.outcomes));
        let over = |panel: Panel, values: &dyn Fn(&Outcome, &Record) -> Vec<f64>| {
            overlaid(panel, self.outcomes, &self.settings, values)
        };
        figure
            .panel(over(b, &forgetting_factors))
            .panel(over(c, &errors).level(Ink::Muted, 0.0, ""))
            .panel(over(d, &|_, record| record.trace.stiffness_variance.clone()))
    }

    /// The paper's table with ours beside it. RMSE after the reset where there is one.
    fn compared(&self) -> Table {
        let mut data = Data::new(format!("table-{:02}", self.table), format!("Table {}", self.table))
            .numbers(self.column, self.rows.iter().map(|row| row.setting))
            .numbers("paper_rmse_kpa", self.rows.iter().map(|row| row.rmse_kpa))
            .text("paper_printed_change", self.rows.iter().map(|row| row.printed.to_owned()))
            .numbers(
                "paper_change_percent",
                self.rows.iter().map(|row| change_percent(self.rows, row).unwrap_or(f64::NAN)),
            );
        for kind in [EstimatorKind::Informed, EstimatorKind::AekfUiInformed] {
            let who = kind.label().replace('-', "_");
            let found: Vec<_> = self.outcomes.iter().map(|outcome| outcome.judged(kind)).collect();
            let column = |pick: fn(crate::score::stats::Spread) -> f64| {
                found.iter().map(|one| one.map_or(f64::NAN, pick)).collect::<Vec<_>>()
            };
            data = data
                .numbers(format!("{who}_rmse_median_kpa"), column(|s| s.median))
                .numbers(format!("{who}_rmse_p10_kpa"), column(|s| s.p10))
                .numbers(format!("{who}_rmse_p90_kpa"), column(|s| s.p90))
                .numbers(format!("{who}_change_percent"), self.outcomes.iter().map(|o| self.change(o, kind)));
        }
        let head = [
            self.what,
            "Paper: RMSE (kPa)",
            "Paper: change, printed",
            "Paper: change, computed",
            "informed: RMSE (kPa)",
            "Change",
            "aekf-ui-informed: RMSE (kPa)",
            "Change",
        ];
        let mut table = Table::new(format!("Table {}: {}", self.table, self.title), &head, data);
        for ((row, outcome), setting) in self.rows.iter().zip(self.outcomes).zip(&self.settings) {
            let nominal = row.printed.is_empty();
            let percent =
                |value: f64| if nominal { "nominal".to_owned() } else { format!("{} %", signed(value, 1)) };
            let ours = |kind| outcome.judged(kind).map_or_else(String::new, |found| spread(&found, 2));
            table = table.row([
                setting.clone(),
                number(row.rmse_kpa, 2),
                if nominal { "–".to_owned() } else { row.printed.to_owned() },
                percent(change_percent(self.rows, row).unwrap_or(f64::NAN)),
                ours(EstimatorKind::Informed),
                percent(self.change(outcome, EstimatorKind::Informed)),
                ours(EstimatorKind::AekfUiInformed),
                percent(self.change(outcome, EstimatorKind::AekfUiInformed)),
            ]);
        }
        table
    }

    /// Change of the median against the nominal row, percent.
    fn change(&self, outcome: &Outcome, kind: EstimatorKind) -> f64 {
        let medians = self.nominal().and_then(|nominal| nominal.judged(kind)).zip(outcome.judged(kind));
        medians.map_or(f64::NAN, |(nominal, changed)| 100.0 * (changed.median / nominal.median - 1.0))
    }

    /// Largest change of the default's median in percent, by absolute value.
    pub(super) fn largest_change_percent(&self) -> f64 {
        let changes = self.outcomes.iter().map(|outcome| self.change(outcome, EstimatorKind::Informed));
        changes.fold(0.0, |largest: f64, change| largest.max(change.abs()))
    }
}
