//! The warnings as a table: which wheels, since when, why, and until when.
//!
//! Called by the page's writer. Where no monitor spoke, the estimator's own warnings take its place.

use std::fmt::Write as _;

use itpms_core::model::PressureUnit;
use itpms_core::warning::{Cause, Reading};

use super::words::{clock, corner_name};
use super::{AlertSpan, ReportData};
use crate::plot::escape;

struct Line {
    class: &'static str,
    wheels: String,
    what: &'static str,
    why: String,
    since_s: f64,
    reported_s: f64,
    ended_s: Option<f64>,
}

/// The table with its explanation, or the statement that nothing was warned of.
pub(super) fn table(data: &ReportData) -> String {
    let (lines, unlisted) = match &data.watch {
        Some(watch) => {
            (watch.alerts.iter().map(|span| line(span, data.pressure_unit)).collect(), watch.unlisted)
        }
        None => (from_warnings(data), 0),
    };
    if lines.is_empty() {
        return "<p class=\"verdict\">Nothing was warned of.</p>".to_owned();
    }
    let mut out = String::from(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Warnings\"><table class=\"alerts\"><thead><tr><th scope=\"col\">Wheel</th>\
         <th scope=\"col\">Warning</th><th scope=\"col\">Reported at</th><th scope=\"col\">Since</th>\
         <th scope=\"col\">Until</th></tr></thead><tbody>\n",
    );
    for line in &lines {
        let until = line.ended_s.map_or("the end".to_owned(), clock);
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td><span class=\"badge {}\">{}</span> {}</td><td data-label=\"warned of at\">{}</td>\
             <td data-label=\"since\">{}</td><td data-label=\"until\">{until}</td></tr>",
            escape(&line.wheels),
            line.class,
            line.what,
            escape(&line.why),
            clock(line.reported_s),
            clock(line.since_s),
        );
    }
    out.push_str("</tbody></table></div>");
    if unlisted > 0 {
        let _ = write!(out, "<p class=\"note\">{unlisted} more are not listed.</p>");
    }
    out
}

fn line(span: &AlertSpan, unit: PressureUnit) -> Line {
    let AlertSpan { alert, ended_s } = span;
    let names: Vec<&str> = alert.wheels.iter().map(corner_name).collect();
    let wheels = if names.len() == 4 { "All four".to_owned() } else { names.join(", ") };
    let (class, what, why) = match &alert.cause {
        Cause::UnderInflated(r) => ("low", "Low", at(r, unit)),
        Cause::FastLeak { reading, rate_kpa_per_min } => {
            // It is the loss that counts, whatever the level.
            let lost_kpa = reading.lost_within_half_a_minute_kpa(*rate_kpa_per_min);
            let [lost, pressure, sd, reference] =
                [lost_kpa, reading.pressure_kpa, reading.sd_kpa, reading.reference_kpa]
                    .map(|kpa| unit.number(kpa, 0));
            let at = format!("{pressure} ± {sd} {unit} then, should be {reference}");
            ("low", "Fast leak", format!("lost up to {lost} {unit} within half a minute; {at}"))
        }
        Cause::AllLow { mean_share, sd_share, .. } => {
            let [mean, sd] = [mean_share, sd_share].map(|share| 100.0 * share);
            ("low", "All low", format!("at {mean:.0} ± {sd:.0} % of their reference on average"))
        }
        Cause::CommonShift { mean_share, sd_share } => {
            let [mean, sd] = [mean_share, sd_share].map(|share| 100.0 * share);
            let why = format!(
                "at {mean:.0} ± {sd:.0} % of what the stored calibration expects: changed tires, wheels or dampers, or all of them filled otherwise; check the pressures, then calibrate again"
            );
            ("unknown", "Shifted together", why)
        }
        Cause::OverInflated(r) => ("over", "Over-inflated", at(r, unit)),
        Cause::Flat(r) => ("low", "Flat, on its rim", format!("as hard as {}", at(r, unit))),
        Cause::Differs { lost_share, lost_sd_share, is_known: true, .. } => {
            let [lost, sd] = [lost_share, lost_sd_share].map(|share| 100.0 * share);
            let [what, how, by] = match names.len() == 4 {
                true => ["All low", "", "the tooth pulses"],
                false => ["Differs from the others", "turns as with ", "the wheel speeds"],
            };
            let why =
                format!("{how}{lost:.0} ± {sd:.0} % of its pressure lost since the calibration, by {by}");
            ("low", what, why)
        }
        Cause::Differs { is_known: false, .. } => {
            let why = "one of the tires differs from the others since the calibration, by the wheel speeds; which one, is unknown";
            ("low", "One differs", why.to_owned())
        }
        Cause::SlowLeak(leak) => ("low", "Slow leak", leak.to_string()),
        Cause::Malfunction(malfunction) => ("malfunction", "Malfunction", malfunction.to_string()),
        Cause::NoInformation { driven_s } => {
            ("unknown", "No information", format!("nothing learned in {:.0} min of driving", driven_s / 60.0))
        }
    };
    Line { class, wheels, what, why, since_s: alert.since_s, reported_s: alert.reported_s, ended_s: *ended_s }
}

fn at(r: &Reading<f64>, unit: PressureUnit) -> String {
    let [pressure, sd, limit, reference] =
        [r.pressure_kpa, r.sd_kpa, r.limit_kpa, r.reference_kpa].map(|kpa| unit.number(kpa, 0));
    let share = 100.0 * r.limit_kpa / r.reference_kpa;
    format!("{pressure} ± {sd} {unit} then, limit {limit} ({share:.0} % of {reference}), {}", r.basis.words())
}

/// The estimator's own word for a corner, stretch by stretch.
fn from_warnings(data: &ReportData) -> Vec<Line> {
    let mut lines = Vec::new();
    for corner in &data.corners {
        for &(from, to, code) in corner.curves.warning.iter().filter(|run| run.2 > 0.0) {
            let (class, what) = if code > 1.5 { ("low", "Low") } else { ("malfunction", "Malfunction") };
            let last = corner.curves.warning.last().is_some_and(|run| run.0 == from);
            lines.push(Line {
                class,
                wheels: corner_name(corner.corner).to_owned(),
                what,
                why: String::new(),
                since_s: from,
                reported_s: from,
                ended_s: (!last).then_some(to),
            });
        }
    }
    lines.sort_by(|a, b| a.reported_s.total_cmp(&b.reported_s));
    lines.truncate(MOST_LINES);
    lines
}

/// Stretches that are listed where no monitor spoke.
const MOST_LINES: usize = 100;
