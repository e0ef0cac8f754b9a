//! Panels that several figures share: pressure, forgetting factor, error and covariance over time, all four estimators in each.
//!
//! Called by the sections of the estimator figures.

use super::data::Data;
use super::outcome::{Outcome, Record};
use crate::score::stats::HALF_95;
use itpms_analysis::plot::{Axis, Ink, Panel, Stroke};

/// Largest forgetting factor drawn; the published one reaches far beyond before its filter diverges.
const FORGETTING_TOP: f64 = 100.0;
/// A reset's last word takes this long to pass, s.
const HELD_S: f64 = 0.2;
/// Usual error axis in kPa: what works stays within.
const ERROR_KPA: f64 = 80.0;

pub(super) type Pick = fn(&Record) -> &Vec<f64>;

pub(super) fn time_axis(outcome: &Outcome) -> Axis {
    Axis::linear("Time", "s").within(0.0, outcome.duration_s)
}

pub(super) fn points(outcome: &Outcome, values: &[f64]) -> Vec<(f64, f64)> {
    outcome.truth.time_s.iter().copied().zip(values.iter().copied()).collect()
}

/// Name in the legend, with a word on a drawn drive that diverged.
pub(super) fn legend(record: &Record) -> String {
    match record.drawn_diverged_s {
        Some(_) => format!("{} (diverges)", record.who.label()),
        None => record.who.label().to_owned(),
    }
}

/// Adds all four; `pick` says what of each.
pub(super) fn four(mut panel: Panel, outcome: &Outcome, values: impl Fn(&Record) -> Vec<f64>) -> Panel {
    for record in outcome.shown() {
        let line = points(outcome, &values(record));
        panel = panel.line(legend(record), record.who.ink(), record.who.stroke(), line);
    }
    panel
}

fn divergences(mut panel: Panel, outcome: &Outcome) -> Panel {
    for record in outcome.shown() {
        if let Some(time_s) = record.drawn_diverged_s {
            panel = panel.moment(record.who.ink(), time_s, format!("{} diverges", record.who.label()));
        }
    }
    panel
}

/// Adds the 95 % band of a record.
fn with_band(panel: Panel, outcome: &Outcome, record: &Record) -> Panel {
    let band = outcome.truth.time_s.iter().enumerate().filter_map(|(i, &time_s)| {
        let half = HALF_95 * record.trace.pressure_sd_kpa.get(i)?;
        let middle = record.trace.pressure_kpa.get(i)?;
        Some((time_s, middle - half, middle + half))
    });
    panel.band("95 % interval of informed", Ink::Default, band.collect())
}

/// The default where it drives once more without a reset.
pub(super) fn without_reset(letter: &str, title: &str, outcome: &Outcome, range_kpa: (f64, f64)) -> Panel {
    let y = Axis::linear("Pressure", "kPa").within(range_kpa.0, range_kpa.1);
    let mut panel = Panel::new(letter, title, time_axis(outcome), y);
    if let Some(record) = outcome.records.iter().find(|record| outcome.column(record).ends_with("_no_reset"))
    {
        let line = points(outcome, &record.trace.pressure_kpa);
        panel = with_band(panel, outcome, record);
        panel = panel.line(record.who.label(), record.who.ink(), record.who.stroke(), line);
    }
    panel.line("truth", Ink::Truth, Stroke::Solid, points(outcome, &outcome.truth.pressure_kpa))
}

/// Pressures with the default's 95 % band and the truth on top.
pub(super) fn pressure(letter: &str, title: &str, outcome: &Outcome, range_kpa: (f64, f64)) -> Panel {
    let y = Axis::linear("Pressure", "kPa").within(range_kpa.0, range_kpa.1);
    let mut panel = Panel::new(letter, title, time_axis(outcome), y);
    if let Some(informed) = outcome.informed() {
        panel = with_band(panel, outcome, informed);
        if informed.who.reset_s > 0.0 {
            panel = panel.stretch(0.0, informed.who.reset_s, "reset");
        }
    }
    let panel = four(panel, outcome, |record| record.trace.pressure_kpa.clone());
    let truth = points(outcome, &outcome.truth.pressure_kpa);
    divergences(panel.line("truth", Ink::Truth, Stroke::Solid, truth), outcome)
}

/// Forgetting factors; over `window_s` alone where given.
pub(super) fn forgetting(
    letter: &str,
    title: &str,
    outcome: &Outcome,
    window_s: Option<(f64, f64)>,
) -> Panel {
    let x =
        window_s.map_or_else(|| time_axis(outcome), |(from, to)| Axis::linear("Time", "s").within(from, to));
    let y = Axis::logarithmic("Forgetting factor λ", "").within(0.9, FORGETTING_TOP);
    four(Panel::new(letter, title, x, y), outcome, |record| forgetting_factors(outcome, record))
}

pub(super) fn error(letter: &str, title: &str, outcome: &Outcome, top_kpa: f64) -> Panel {
    let y = Axis::linear("Estimate − truth", "kPa").within(-top_kpa, top_kpa);
    let panel = Panel::new(letter, title, time_axis(outcome), y);
    four(panel, outcome, |record| errors(outcome, record)).level(Ink::Muted, 0.0, "")
}

pub(super) fn errors(outcome: &Outcome, record: &Record) -> Vec<f64> {
    record.trace.pressure_kpa.iter().zip(&outcome.truth.pressure_kpa).map(|(p, truth)| p - truth).collect()
}

/// From the smallest variance that any claims to the largest, within what is not absurd: a filter about to diverge claims anything.
pub(super) fn variance_axis<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Axis {
    let all =
        outcomes.into_iter().flat_map(Outcome::shown).flat_map(|record| &record.trace.stiffness_variance);
    let (low, high) = all
        .filter(|variance| variance.is_finite() && **variance > 0.0)
        .fold((1e9, 1e9), |(low, high): (f64, f64), &v| (low.min(v), high.max(v)));
    let decade = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.log10()));
    let axis = Axis::logarithmic("Variance of the stiffness", "N²/m²");
    axis.within(decade(low.max(1e-2) / 1.2, f64::floor), decade(high.min(1e11) * 1.2, f64::ceil))
}

/// Forgetting factors of a record; none while a reset holds the estimate, when every word about the pressure is followed by growth.
pub(super) fn forgetting_factors(outcome: &Outcome, record: &Record) -> Vec<f64> {
    let held = |time_s: f64| record.who.reset_s > 0.0 && time_s <= record.who.reset_s + HELD_S;
    let times = outcome.truth.time_s.iter();
    times.zip(&record.trace.forgetting).map(|(&t, &lambda)| if held(t) { f64::NAN } else { lambda }).collect()
}

pub(super) fn covariance(letter: &str, title: &str, outcome: &Outcome) -> Panel {
    four(Panel::new(letter, title, time_axis(outcome), variance_axis([outcome])), outcome, |record| {
        record.trace.stiffness_variance.clone()
    })
}

pub(super) fn stiffness(letter: &str, title: &str, outcome: &Outcome, range_kn_per_m: (f64, f64)) -> Panel {
    let y = Axis::linear("Tire stiffness", "kN/m").within(range_kn_per_m.0, range_kn_per_m.1);
    let kilo = |values: &[f64]| values.iter().map(|v| v / 1e3).collect::<Vec<_>>();
    let panel = four(Panel::new(letter, title, time_axis(outcome), y), outcome, |record| {
        kilo(&record.trace.stiffness_n_per_m)
    });
    let truth = points(outcome, &kilo(&outcome.truth.stiffness_n_per_m));
    panel.line("truth", Ink::Truth, Stroke::Solid, truth)
}

/// The four panels of Fig. 7 and 12.
pub(super) fn usual_panels(outcome: &Outcome, range_kpa: (f64, f64)) -> [Panel; 4] {
    [
        pressure("a", "Tire pressure", outcome, range_kpa),
        forgetting("b", "Forgetting factor", outcome, None),
        error("c", "Error of the pressure", outcome, ERROR_KPA),
        covariance("d", "Error covariance claimed", outcome),
    ]
}

/// Everything drawn of one case, one row per point of its histories. `more` is appended to the names of columns.
pub(super) fn data(name: &str, title: &str, outcome: &Outcome, more: &str) -> Data {
    let mut data = Data::new(name, title)
        .numbers("time_s", outcome.truth.time_s.iter().copied())
        .numbers(format!("truth_pressure_kpa{more}"), outcome.truth.pressure_kpa.iter().copied())
        .numbers(format!("truth_stiffness_n_per_m{more}"), outcome.truth.stiffness_n_per_m.iter().copied());
    for record in &outcome.records {
        let who = outcome.column(record);
        let columns: [(&str, Pick); 5] = [
            ("pressure_kpa", |record| &record.trace.pressure_kpa),
            ("pressure_sd_kpa", |record| &record.trace.pressure_sd_kpa),
            ("stiffness_n_per_m", |record| &record.trace.stiffness_n_per_m),
            ("stiffness_variance_n2_per_m2", |record| &record.trace.stiffness_variance),
            ("forgetting", |record| &record.trace.forgetting),
        ];
        for (column, pick) in columns {
            data = data.numbers(format!("{who}_{column}{more}"), pick(record).iter().copied());
        }
    }
    data
}

/// Adds the same quantity of all four under three settings to one panel: color by estimator, stroke by setting.
pub(super) fn overlaid(
    mut panel: Panel,
    outcomes: &[Outcome; 3],
    settings: &[String; 3],
    values: impl Fn(&Outcome, &Record) -> Vec<f64>,
) -> Panel {
    let strokes = [Stroke::Dotted, Stroke::Solid, Stroke::Dashed];
    for (setting, stroke) in settings.iter().zip(strokes) {
        // For the legend alone.
        panel = panel.line(format!("{setting} in b to d"), Ink::Muted, stroke, vec![]);
    }
    for (outcome, stroke) in outcomes.iter().zip(strokes) {
        for record in outcome.shown() {
            panel = panel.line("", record.who.ink(), stroke, points(outcome, &values(outcome, record)));
        }
    }
    panel
}
