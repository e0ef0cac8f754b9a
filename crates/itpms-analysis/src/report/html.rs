//! The page itself: everything that can be read without a script is written here, the curves are drawn by
//! `assets/report.js` with the machinery of `assets/chart.js`.
//!
//! Called by [`render_report`](super::render_report). Every text that comes from outside goes through [`escape`].

use std::fmt::Write as _;
use std::io;

use itpms_core::model::{Corner, PressureUnit};
use itpms_files::Date;

use super::car::Tire;
use super::cold::cold_text;
use super::figures_table::{count, some};
use super::title::title;
use super::words::{Status, clock, corner_name, reading, sentence};
use super::{
    CornerReport, ReportData, alerts, car, figures_table, json, parameters, roads, suspension, wheel_cards,
    wheels,
};
use crate::page::{PATTERN_SCRIPT, whole_percent};
use crate::plot::escape;

const TEMPLATE: &str = include_str!("../../assets/report.html");
const STYLE: &str = include_str!("../../assets/report.css");
const CHART_SCRIPT: &str = include_str!("../../assets/chart.js");
const SCRIPT: &str = include_str!("../../assets/report.js");
/// The charting library uPlot: its style sheet.
pub const PLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
/// The charting library uPlot: its licence, which goes with it wherever it goes.
pub const PLOT_LICENSE: &str = include_str!("../../assets/uplot/LICENSE");
/// The charting library uPlot: a script that defines the global `uPlot`.
pub const PLOT_SCRIPT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");

/// The page as text. Errors: only if the curves cannot be written as JSON.
pub fn page(data: &ReportData) -> io::Result<String> {
    let headline = escape(&title(data));
    let curves = json::curves(data)?;
    let (roads, wheels, parameters) = (roads_section(data), wheels::section(data), parameters::section(data));
    let suspension = suspension::section(data) + &suspension::once_per_turn(data);
    let parts: [(&str, String); 22] = [
        (
            "contents",
            contents(data, [&wheels, &suspension, &roads, &parameters].map(|section| !section.is_empty())),
        ),
        ("title", headline.clone()),
        ("plot_style", PLOT_STYLE.into()),
        ("style", STYLE.into()),
        ("headline", headline),
        ("subline", subline(data)),
        ("concerns", concerns(data)),
        ("cards", cards(data)),
        ("arrangement", if data.corners.len() == 1 { "alone" } else { "around" }.into()),
        ("alerts", alerts::table(data)),
        ("suspension", suspension),
        ("roads", roads),
        ("figures", figures_table::section(data)),
        ("corners", sections(data)),
        ("wheels", wheels),
        ("parameters", parameters),
        ("provenance", provenance(data)),
        ("data", curves),
        ("plot_license", PLOT_LICENSE.into()),
        ("plot_script", PLOT_SCRIPT.into()),
        ("chart_script", PATTERN_SCRIPT.to_owned() + CHART_SCRIPT),
        ("script", SCRIPT.into()),
    ];
    Ok(crate::page::page(TEMPLATE, &parts))
}

/// The way to each section that the page has; `has`: wheel speeds, dampers and load, roads, parameters.
fn contents(data: &ReportData, has: [bool; 4]) -> String {
    let mut out = String::from("<nav class=\"contents\" aria-label=\"On this page\">");
    let mut link = |is: bool, id: &str, name: &str| {
        if is {
            let _ = write!(out, "<a href=\"#{id}\">{name}</a> ");
        }
    };
    let [wheels, suspension, roads, parameters] = has;
    link(true, "warnings", "Warnings");
    link(data.corners.len() > 1, "overview", "All tires");
    link(wheels, "wheel-speeds", "Wheel speeds");
    link(suspension, "suspension", "Dampers and load");
    link(roads, "roads", "Roads");
    for corner in &data.corners {
        link(true, corner.corner.label(), corner_name(corner.corner));
    }
    link(!data.corners.is_empty(), "figures", "Figures");
    link(parameters, "parameters", "Parameters");
    link(true, "reading", "How to read this");
    link(true, "provenance", "Where this comes from");
    out.push_str("</nav>\n");
    out
}

fn subline(data: &ReportData) -> String {
    let (p, d) = (&data.provenance, &data.drive);
    let mut parts = vec![p.vehicle.clone(), p.source.clone(), span(d.duration_s)];
    if d.distance_m.is_finite() {
        parts.push(distance(d.distance_m));
    }
    if !p.estimator.is_empty() {
        parts.push(format!("estimator {}", p.estimator));
    }
    let parts: Vec<String> = parts.iter().filter(|part| !part.is_empty()).map(|part| escape(part)).collect();
    parts.join(" <span class=\"dot\">·</span> ")
}

fn span(seconds: f64) -> String {
    if seconds.is_finite() { clock(seconds) } else { String::new() }
}

fn distance(metres: f64) -> String {
    if metres < 1000.0 { format!("{metres:.0}\u{a0}m") } else { format!("{:.2}\u{a0}km", metres / 1000.0) }
}

fn concerns(data: &ReportData) -> String {
    if data.concerns.is_empty() {
        return String::new();
    }
    let items: String = data
        .concerns
        .iter()
        .map(|concern| format!("<li>{}.</li>", escape(concern.trim_end_matches('.'))))
        .collect();
    format!(
        "<section class=\"card malfunction\" id=\"concerns\"><p class=\"card-name\">Before you believe it</p><ul>{items}</ul></section>\n"
    )
}

/// The corners at a glance, around the car where there are several.
fn cards(data: &ReportData) -> String {
    if let Some(cards) = wheel_cards::cards(data) {
        return cards;
    }
    let mut out = if data.corners.len() > 1 { drawing(data) } else { String::new() };
    let end_s = data.time_s.last().copied().unwrap_or(f64::NAN);
    out.extend(data.corners.iter().map(|corner| card(corner, end_s, data.pressure_unit)));
    out
}

fn drawing(data: &ReportData) -> String {
    let says: Vec<String> = data.corners.iter().map(|corner| sentence(corner, data.pressure_unit)).collect();
    let tires = Corner::ALL.map(|corner| {
        let report = data.corners.iter().find(|report| report.corner == corner)?;
        Some(Tire { status: Status::of(report), word: Status::short(report) })
    });
    car::drawing(&says.join(". "), &tires)
}

/// The roads of the tracks side by side; a single corner shows its own.
fn roads_section(data: &ReportData) -> String {
    let table = roads::table(data);
    if data.corners.len() < 2 || table.is_empty() {
        return String::new();
    }
    format!(
        "<details class=\"fold\" id=\"roads\"><summary><h2>Road under the tracks</h2></summary><p class=\"verdict\">Road heights estimated \
         from the accelerations; waves longer than they show are left out.</p><div class=\"panels\" data-roads></div>{table}</details>\n"
    )
}

/// One corner at a glance: its last pressure against the placard's. Where the drive went on for more than a second without
/// one, when that was; when it was warned of; why it is not known.
fn card(corner: &CornerReport, end_s: f64, unit: PressureUnit) -> String {
    let status = Status::of(corner);
    let f = &corner.figures;
    let (number, spread, gauge) = match &f.last {
        Some(last) => {
            let text = reading(last, unit);
            let (number, spread) = text.split_once('\u{a0}').unwrap_or((&text, ""));
            (number.to_owned(), spread.to_owned(), gauge(corner, last.pressure_kpa, last.sd_kpa))
        }
        None => ("–".to_owned(), unit.to_string(), String::new()),
    };
    let old_s = f.last.as_ref().map(|last| last.time_s).filter(|last_s| end_s - last_s > 1.0);
    let doubt = corner.doubt();
    let foot = match (old_s, f.low_since_s) {
        (Some(last_s), _) => {
            let why = doubt.map_or(String::new(), |why| format!(": {why}"));
            format!("<span>last valid at {}{why}</span>", clock(last_s))
        }
        (None, Some(reported_s)) => format!("<span>warned of at {}</span>", clock(reported_s)),
        (None, None) => match doubt {
            Some(why) => format!("<span>{why}</span>"),
            None => format!("<span>valid for {:.0} % of the drive</span>", 100.0 * f.share_valid),
        },
    };
    let cold = f.cold.map_or_else(String::new, |cold| {
        let (at, add) = cold_text(&cold, corner.placard_kpa, unit);
        let add = add.map_or_else(String::new, |add| format!("<span>{add}</span>"));
        format!("<span class=\"card-foot\"><span>{at}</span>{add}</span>")
    });
    format!(
        "<a class=\"card {class} at-{id}\" href=\"#{id}\"><span class=\"card-name\">{name}</span>\
         <span class=\"badge {class}\">{label}</span>\
         <span class=\"card-number\">{number}<small>{spread}</small></span>{gauge}\
         <span class=\"card-foot\"><span>placard {placard} {unit}</span>{foot}</span>{cold}</a>\n",
        class = status.class(),
        id = corner.corner.label(),
        name = corner_name(corner.corner),
        label = Status::badge(corner),
        placard = unit.number(corner.placard_kpa, 0),
    )
}

/// A bar from nothing to a quarter above the placard's pressure, with the 95 % interval and the placard's mark.
fn gauge(corner: &CornerReport, pressure_kpa: f64, sd_kpa: f64) -> String {
    let percent = |p: f64| whole_percent(80.0 * p / corner.placard_kpa);
    let half = super::Z_95 * sd_kpa;
    let (from, to) = (percent(pressure_kpa - half), percent(pressure_kpa + half));
    format!(
        "<span class=\"gauge\" aria-hidden=\"true\"><i class=\"gauge-fill w{}\"></i>\
         <i class=\"gauge-band x{from} w{}\"></i><i class=\"gauge-mark\"></i></span>",
        percent(pressure_kpa),
        to.saturating_sub(from),
    )
}

/// Each corner's place for its curves, folded where there are several; what a single corner has to say is the headline already.
fn sections(data: &ReportData) -> String {
    let mut out = String::new();
    let several = data.corners.len() > 1;
    for (index, corner) in data.corners.iter().enumerate() {
        let (id, status) = (corner.corner.label(), Status::of(corner));
        let heading = format!(
            "<h2>{} <span class=\"badge {}\">{}</span></h2>",
            corner_name(corner.corner),
            status.class(),
            Status::badge(corner),
        );
        let (begin, end) = if several {
            let verdict = escape(&sentence(corner, data.pressure_unit));
            let summary = format!("<summary>{heading}<span class=\"verdict\">{verdict}.</span></summary>");
            (format!("<details class=\"corner fold\" id=\"{id}\">{summary}"), "</details>")
        } else {
            (format!("<section class=\"corner\" id=\"{id}\">{heading}"), "</section>")
        };
        let _ = write!(out, "{begin}<div class=\"panels\" data-corner=\"{index}\"></div>");
        if several {
            let _ = write!(
                out,
                "<details class=\"inner\"><summary>Inside the estimator</summary>\
                 <div class=\"panels\" data-inner=\"{index}\"></div></details>"
            );
        }
        if corner.road.is_none() {
            out.push_str(
                "<p class=\"note\">No road is shown: it takes a known speed above 2.5 m/s and a road estimate.</p>",
            );
        }
        let _ = writeln!(out, "{end}");
    }
    out
}

/// The day and time of a log's first row, where its times count from 1970; empty where they do not.
fn date(origin_s: f64) -> String {
    // The year 2000; a clock that counts from its start does not get there.
    if !(946_684_800.0..4e9).contains(&origin_s) {
        return String::new();
    }
    let Date { year, month, day, hour, minute, second } = Date::of_seconds(origin_s as i64);
    format!(
        "{year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}, as the log counts (UTC, or local time)"
    )
}

fn provenance(data: &ReportData) -> String {
    let (p, d) = (&data.provenance, &data.drive);
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |name: &str, value: String| {
        if !value.is_empty() {
            rows.push((name.into(), value));
        }
    };
    row("Program", p.program.clone());
    row("Made on", p.made.clone());
    row("Command", p.command.clone());
    row("Date of the drive", date(d.origin_s));
    row("Log", p.source.clone());
    row("Vehicle", p.vehicle.clone());
    row("Estimator", p.estimator.clone());
    row("Samples", count(d.samples));
    row("Rate", some(Some(d.rate_hz), |v| format!("{v:.0} Hz")));
    row("Duration", span(d.duration_s));
    if d.origin_s != 0.0 {
        row("Times", format!("from the first row on, time_s = {}", d.origin_s));
    }
    row("Distance", some(Some(d.distance_m), distance));
    for (name, value) in &p.options {
        row(name, value.clone());
    }
    for (name, n) in &p.repairs {
        row(&format!("Repaired: {name}"), count(*n));
    }
    if p.repairs.is_empty() {
        row("Repaired", "nothing".into());
    }
    let mut out = String::from("<table class=\"provenance\"><tbody>\n");
    for (name, value) in rows {
        let _ = writeln!(out, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", escape(&name), escape(&value));
    }
    out.push_str("</tbody></table>");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn html_in_names_is_text() {
        assert_eq!(escape("<b a=\"1\">&'</b>"), "&lt;b a=&quot;1&quot;&gt;&amp;&#39;&lt;/b&gt;");
    }

    #[test]
    fn a_log_whose_times_count_from_1970_has_a_date() {
        // `date -u -d @1795195053`.
        assert!(date(1_795_195_053.25).starts_with("2026-11-20 17:17:33"));
        assert_eq!(
            (date(0.0), date(86_400.0), date(f64::NAN)),
            (String::new(), String::new(), String::new())
        );
    }

    #[test]
    fn the_strips_have_a_word_for_every_code() {
        // As many as the collector's codes of validity and warning, and the watch's of states: one that is missing stops the script.
        for (table, codes) in [("VALIDITY", 6), ("WARNING", 3), ("STATE", 6)] {
            let (_, rest) = CHART_SCRIPT.split_once(&format!("const {table} = [")).unwrap();
            let (entries, _) = rest.split_once("];\n").unwrap();
            assert_eq!(entries.matches('[').count(), codes, "{table}");
        }
    }

    #[test]
    fn the_template_names_every_part_once() {
        let names =
            "contents headline subline cards alerts suspension roads figures corners wheels parameters";
        for name in names.split(' ') {
            assert_eq!(TEMPLATE.matches(&format!("{{{{{name}}}}}")).count(), 1, "{name}");
        }
        assert!(!PLOT_LICENSE.contains("*/"));
        // Scripts are embedded as they are, so nothing in them may end the element.
        for script in [SCRIPT, CHART_SCRIPT, PATTERN_SCRIPT, PLOT_SCRIPT] {
            assert!(!script.to_lowercase().contains("</script"));
        }
    }
}
