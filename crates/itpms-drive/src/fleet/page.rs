//! The page about the whole fleet: complete in itself, readable without a script, which sorts and filters, and on a phone.
//!
//! Every text that comes from outside goes through [`escape`].

use std::fmt::Write as _;

use itpms_analysis::page::whole_percent;
use itpms_analysis::plot::{Figure, Ink, escape};
use itpms_analysis::roughness::MAP_STYLE;
use itpms_core::model::PressureUnit;
use itpms_data::out::AtomicFile;

use super::found::natural;
use super::histogram::histogram;
use super::names::Names;
use super::record::{DriveRecord, Loss, WheelRecord};
use super::road_map::FleetRoads;
use super::standing::{CarStanding, State, lowest, share};
use super::{Failed, Outcome, Plan, beside_cell, damper_cell};
use crate::error::DriveError;
use crate::provenance::today;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
/// Cars, drives and failures that are listed; the tables have all.
const LISTED: usize = 500;
/// Points of a car's line over its drives.
const LINE: usize = 60;

pub(super) fn write(plan: &Plan, outcome: &Outcome, roads: Option<&FleetRoads>) -> Result<(), DriveError> {
    Ok(AtomicFile::save(&plan.out.join("index.html"), page(plan, outcome, roads).as_bytes())?)
}

fn page(plan: &Plan, outcome: &Outcome, roads: Option<&FleetRoads>) -> String {
    let cars = CarStanding::of_all(&outcome.drives, &outcome.failed);
    let headline = escape(&headline(&cars));
    let (unit, names) = (plan.settings.pressure_unit, Names::of(&outcome.drives));
    let parts: [(&str, String); 11] = [
        ("title", headline.clone()),
        ("headline", headline),
        ("style", STYLE.to_owned() + roads.map_or("", |_| MAP_STYLE)),
        ("roads", roads.map_or_else(String::new, FleetRoads::section)),
        ("subline", subline(outcome, &cars)),
        ("cards", cards(&cars)),
        ("cars", cars_table(&cars, outcome, &names, unit)),
        ("figures", figures(&outcome.drives, &cars, unit)),
        ("drives", drives_table(&outcome.drives, &names, unit) + &failed_table(outcome)),
        ("provenance", provenance(plan)),
        ("script", SCRIPT.into()),
    ];
    itpms_analysis::page::page(TEMPLATE, &parts)
}

/// `3 of 12 cars have a low tire`: the most urgent thing there is.
pub(super) fn headline(cars: &[CarStanding<'_>]) -> String {
    if cars.iter().all(|car| car.drives.is_empty()) {
        return "No drive could be estimated".to_owned();
    }
    let all = match cars.len() {
        1 => "1 car".to_owned(),
        n => format!("{n} cars"),
    };
    let count = |state| cars.iter().filter(|car| car.state == state).count();
    let say = |n: usize, one: &str, more: &str| {
        if cars.len() == 1 {
            format!("The car {one}")
        } else {
            format!("{n} of {all} {}", if n == 1 { one } else { more })
        }
    };
    let unsure = count(State::Uncertain) + count(State::Unknown);
    match (count(State::Low), count(State::Malfunction), count(State::Over), unsure) {
        (0, 0, 0, 0) if cars.iter().any(|car| damper_cell::is_reported(&car.drives)) => {
            let n = cars.iter().filter(|car| damper_cell::is_reported(&car.drives)).count();
            say(n, "has a damper to look at", "have a damper to look at")
        }
        (0, 0, 0, 0) => match cars.len() {
            1 => "The car is fine".to_owned(),
            _ => format!("All {all} are fine"),
        },
        (0, 0, 0, n) => say(n, "is unknown or uncertain", "are unknown or uncertain"),
        (0, 0, n, _) => say(n, "has an over-inflated tire", "have an over-inflated tire"),
        (0, n, ..) => say(n, "has a sensor fault", "have a sensor fault"),
        (n, ..) => say(n, "has a low tire", "have a low tire"),
    }
}

fn subline(outcome: &Outcome, cars: &[CarStanding<'_>]) -> String {
    let drives = &outcome.drives;
    let km = drives.iter().filter_map(|drive| drive.distance_m).sum::<f64>() / 1000.0;
    let hours = drives.iter().map(|drive| drive.duration_s).sum::<f64>() / 3600.0;
    let mut parts = vec![
        counted(cars.len(), "car"),
        counted(drives.len(), "drive"),
        format!("{}\u{a0}km", few(km)),
        duration(3600.0 * hours),
    ];
    let warned = drives.iter().filter(|drive| !drive.alerts.is_empty()).count();
    if warned > 0 {
        parts.push(format!("<a href=\"#drives\">{} with a warning</a>", counted(warned, "drive")));
    }
    if !outcome.failed.is_empty() {
        parts.push(format!("<a href=\"#failed\">{} failed</a>", counted(outcome.failed.len(), "file")));
    }
    parts.join(" <span class=\"dot\">·</span> ")
}

fn counted(n: usize, what: &str) -> String {
    format!("{n}\u{a0}{what}{}", if n == 1 { "" } else { "s" })
}

/// With a decimal where it is small.
fn few(value: f64) -> String {
    if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

fn cards(cars: &[CarStanding<'_>]) -> String {
    let mut out = String::new();
    for state in State::ALL {
        let n = cars.iter().filter(|car| car.state == state).count();
        let (class, share) = (state.label(), 100.0 * n as f64 / cars.len().max(1) as f64);
        let _ = writeln!(
            out,
            "<div class=\"card {class}{none}\"><span class=\"badge {class}\">{word}</span><span class=\"card-number\">{n}</span>\
             <span class=\"bar\"><i class=\"w{}\"></i></span><span class=\"card-foot\">{share:.0} % of the cars</span></div>",
            whole_percent(share),
            none = if n == 0 { " none" } else { "" },
            word = word(state),
        );
    }
    out
}

fn word(state: State) -> &'static str {
    match state {
        State::Low => "Low",
        State::Malfunction => "Malfunction",
        State::Over => "Over-inflated",
        State::Uncertain => "Uncertain",
        State::Unknown => "Unknown",
        State::Fine => "Fine",
    }
}

fn badge(state: State) -> String {
    format!("<span class=\"badge {}\">{}</span>", state.label(), word(state))
}

/// A damper is no tire: it stands beside the state, which is theirs.
fn damper_badge(drives: &[&DriveRecord]) -> &'static str {
    if damper_cell::is_reported(drives) { " <span class=\"badge over damper\">Damper</span>" } else { "" }
}

/// How many drives of the car that come after its last one could not be estimated, as a link to them: they might have changed its state.
fn later_failures(car: &CarStanding<'_>, last: &DriveRecord, failed: &[Failed]) -> String {
    let later = |failed: &&Failed| {
        failed.car.as_deref() == Some(car.car) && natural(&failed.file.to_string_lossy(), &last.file).is_gt()
    };
    match failed.iter().filter(later).count() {
        0 => String::new(),
        n => format!("<small><a href=\"#failed\">{} failed</a></small>", counted(n, "later drive")),
    }
}

/// The warnings of the car's last drive, and how many earlier ones had one.
fn warned(last: &DriveRecord, drives: &[&DriveRecord]) -> String {
    let earlier = drives.iter().rev().skip(1).filter(|drive| !drive.alerts.is_empty()).count();
    let earlier = (earlier > 0).then(|| format!("{} with a warning", counted(earlier, "earlier drive")));
    let lines = last.alerts.iter().cloned().chain(earlier);
    lines.map(|line| format!("<small>{}</small>", escape(&line))).collect()
}

/// The cars, the worst first, each with its wheels at the end of its last drive that could be estimated.
fn cars_table(cars: &[CarStanding<'_>], outcome: &Outcome, names: &Names<'_>, unit: PressureUnit) -> String {
    let (dampers, beside) = (damper_cell::any(&outcome.drives), beside_cell::any(&outcome.drives));
    let mut out = format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Cars\"><table class=\"cars\"><thead><tr><th scope=\"col\">Car</th><th scope=\"col\">State</th>\
         <th scope=\"col\">Front left</th><th scope=\"col\">Front right</th><th scope=\"col\">Rear left</th>\
         <th scope=\"col\">Rear right</th><th scope=\"col\">Over its drives</th>{}{}<th scope=\"col\">Last drive</th></tr></thead><tbody>\n",
        if dampers { "<th scope=\"col\">Dampers</th>" } else { "" },
        if beside { "<th scope=\"col\">Load and more</th>" } else { "" }
    );
    for car in cars.iter().take(LISTED) {
        let Some(last) = car.last() else {
            out.push_str(&unseen_row(car, usize::from(dampers) + usize::from(beside)));
            continue;
        };
        let wheels: String = ["fl", "fr", "rl", "rr"].map(|name| wheel_cell(last, name, unit)).concat();
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{name}<small>{vehicle}</small></th><td data-sort=\"{rank}\">{badge}{warned}</td>{wheels}<td class=\"line\" data-sort=\"{lowest}\">{line}</td>{dampers}{beside}\
             <td class=\"last\">{link}<small>{count}</small>{later}</td></tr>",
            name = escape(car.car),
            vehicle = if last.vehicle == car.car { String::new() } else { escape(&last.vehicle) },
            rank = car.state as u8,
            lowest = key(lowest(Some(last))),
            badge = badge(car.state) + damper_badge(&car.drives),
            warned = warned(last, &car.drives),
            line = line(&car.drives),
            dampers = if dampers { damper_cell::cell(&car.drives) } else { String::new() },
            beside = if beside { beside_cell::cell(last) } else { String::new() },
            link = names.link(last),
            count = counted(car.drives.len(), "drive"),
            later = later_failures(car, last, &outcome.failed),
        );
    }
    out.push_str("</tbody></table></div>");
    rest(&mut out, cars.len(), "cars");
    out
}

/// A car none of whose drives could be estimated.
fn unseen_row(car: &CarStanding<'_>, more: usize) -> String {
    format!(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"unseen\" colspan=\"{}\">no drive could be estimated</td>\
         <td class=\"last\"><a href=\"#failed\">{} failed</a></td></tr>\n",
        escape(car.car),
        badge(car.state),
        5 + more,
        counted(car.failed, "drive"),
    )
}

/// A wheel's last pressure, with a bar up to a quarter above the placard's.
fn wheel_cell(drive: &DriveRecord, name: &str, unit: PressureUnit) -> String {
    let short = name.to_uppercase();
    let Some(wheel) = drive.wheels.iter().find(|wheel| wheel.wheel == name) else {
        return format!("<td class=\"wheel absent\" data-label=\"{short}\">–</td>");
    };
    let class = State::of_wheel(wheel).label();
    if let (None, Some(lost)) = (wheel.last, wheel.lost) {
        return format!(
            "<td class=\"wheel {class}\" data-label=\"{short}\"><b>{:.0} %</b> <small>± {:.0} % lost<br>{}</small></td>",
            100.0 * lost.share,
            100.0 * lost.sd,
            shows(lost),
        );
    }
    let Some(last) = wheel.last else {
        return format!("<td class=\"wheel {class}\" data-label=\"{short}\">unknown</td>");
    };
    let percent = 100.0 * last.pressure_kpa / wheel.placard_kpa;
    format!(
        "<td class=\"wheel {class}\" data-label=\"{short}\"><b>{}</b> <small>± {} {unit}</small>\
         <span class=\"gauge\" title=\"{percent:.0} % of the placard's {} {unit}\"><i class=\"w{}\"></i></span></td>",
        unit.number(last.pressure_kpa, 0),
        unit.number(last.sd_kpa, 0),
        unit.number(wheel.placard_kpa, 0),
        whole_percent(0.8 * percent),
    )
}

/// Detectable loss of a wheel, by wheel speeds.
fn shows(lost: Loss) -> String {
    match (100.0 * lost.detectable).ceil() {
        percent if percent <= 90.0 => format!("{percent:.0} % would show"),
        _ => "no loss would show".to_owned(),
    }
}

/// The lowest wheel's share of the placard's pressure, drive by drive.
fn line(drives: &[&DriveRecord]) -> String {
    let recent = &drives[drives.len().saturating_sub(LINE)..];
    let shares: Vec<f64> = recent.iter().map(|drive| lowest(Some(drive))).collect();
    let known = shares.iter().filter(|share| share.is_finite()).count();
    if known < 2 {
        return String::new();
    }
    let x = |i: usize| 4.0 + 112.0 * i as f64 / (shares.len() - 1) as f64;
    let y = |share: f64| 30.0 - 26.0 * ((share - 0.5) / 0.6).clamp(0.0, 1.0);
    let points: Vec<String> = (shares.iter().enumerate())
        .filter(|(_, share)| share.is_finite())
        .map(|(i, share)| format!("{:.1},{:.1}", x(i), y(*share)))
        .collect();
    let last = points.last().and_then(|point| point.split_once(',')).unwrap_or(("0", "0"));
    format!(
        "<svg viewBox=\"0 0 120 34\" role=\"img\" aria-label=\"Lowest tire over {n} drives, {from:.0} to {to:.0} % of the placard's\">\
         <path class=\"placard\" d=\"M4 {placard:.1}H116\"/><polyline points=\"{points}\"/><circle cx=\"{cx}\" cy=\"{cy}\" r=\"2.6\"/></svg>",
        n = recent.len(),
        from = 100.0 * shares.iter().copied().find(|share| share.is_finite()).unwrap_or(f64::NAN),
        to = 100.0 * shares.iter().rev().copied().find(|share| share.is_finite()).unwrap_or(f64::NAN),
        placard = y(1.0),
        points = points.join(" "),
        cx = last.0,
        cy = last.1,
    )
}

/// The key by which a cell is sorted; empty where it is not known.
fn key(value: f64) -> String {
    if value.is_finite() { format!("{value:.4}") } else { String::new() }
}

/// The drives, the worst first.
fn drives_table(drives: &[DriveRecord], names: &Names<'_>, unit: PressureUnit) -> String {
    let mut order: Vec<&DriveRecord> = drives.iter().collect();
    order.sort_by(|a, b| {
        let urgency = State::of_drive(a).cmp(&State::of_drive(b));
        let warned = a.alerts.is_empty().cmp(&b.alerts.is_empty());
        urgency.then(warned).then(lowest(Some(a)).total_cmp(&lowest(Some(b))))
    });
    let mut out = String::from(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Drives\"><table class=\"drives\"><thead><tr><th scope=\"col\">Drive</th><th scope=\"col\">Car</th>\
         <th scope=\"col\">State</th><th scope=\"col\">Lowest tire at the end</th><th scope=\"col\">Valid</th><th scope=\"col\">IRI, m/km</th>\
         <th scope=\"col\">Distance</th><th scope=\"col\">Time</th></tr></thead><tbody>\n",
    );
    for drive in order.into_iter().take(LISTED) {
        let warnings = if drive.alerts.is_empty() {
            String::new()
        } else {
            format!("<small>{}</small>", escape(&drive.alerts.join("; ")))
        };
        let km = drive.distance_m.map_or("–".to_owned(), |m| format!("{}\u{a0}km", few(m / 1000.0)));
        let valid = 100.0 * mean(drive.wheels.iter().map(|wheel| Some(wheel.share_valid))).unwrap_or(0.0);
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}{warnings}</th><td data-label=\"car\">{}</td><td data-sort=\"{}\">{}</td><td class=\"lowest\" data-label=\"lowest\" data-sort=\"{}\">{}</td><td class=\"n\" data-label=\"valid\" data-sort=\"{valid:.3}\">{valid:.0} %</td>\
             <td class=\"n\" data-label=\"IRI\">{}</td><td class=\"n\" data-sort=\"{}\">{km}</td><td class=\"n\" data-sort=\"{:.0}\">{}</td></tr>",
            names.link(drive),
            escape(&drive.car),
            State::of_drive(drive) as u8,
            badge(State::of_drive(drive)),
            key(lowest(Some(drive))),
            lowest_text(drive, unit),
            mean(drive.wheels.iter().map(|wheel| wheel.iri_m_per_km))
                .map_or("–".to_owned(), |iri| format!("{iri:.2}")),
            key(drive.distance_m.unwrap_or(f64::NAN)),
            drive.duration_s,
            duration(drive.duration_s),
        );
    }
    out.push_str("</tbody></table></div>");
    rest(&mut out, drives.len(), "drives");
    out
}

/// `FL 139 of 241 kPa`.
fn lowest_text(drive: &DriveRecord, unit: PressureUnit) -> String {
    let known = drive.wheels.iter().filter_map(|wheel| Some((wheel, share(wheel)?, wheel.last?)));
    match known.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((wheel, _, last)) => {
            let [now, placard] = [last.pressure_kpa, wheel.placard_kpa].map(|kpa| unit.number(kpa, 0));
            format!("{} {now} of {placard}\u{a0}{unit}", wheel.wheel.to_uppercase())
        }
        None => lost_text(drive).unwrap_or_else(|| "unknown".to_owned()),
    }
}

/// `FL 29 % lost`, where wheel speeds are all there is.
fn lost_text(drive: &DriveRecord) -> Option<String> {
    let known = drive.wheels.iter().filter_map(|wheel| Some((wheel, wheel.lost?)));
    let (wheel, lost) = known.max_by(|a, b| a.1.share.total_cmp(&b.1.share))?;
    Some(format!(
        "{} {:.0} ± {:.0}\u{a0}% lost",
        wheel.wheel.to_uppercase(),
        100.0 * lost.share,
        100.0 * lost.sd
    ))
}

fn duration(seconds: f64) -> String {
    let whole = seconds.round() as i64;
    if whole < 3600 {
        format!("{}:{:02}\u{a0}min", whole / 60, whole % 60)
    } else {
        format!("{}:{:02}\u{a0}h", whole / 3600, whole % 3600 / 60)
    }
}

fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values.flatten() {
        sum += value;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

fn rest(out: &mut String, n: usize, what: &str) {
    if n > LISTED {
        let _ = write!(out, "<p class=\"note\">{} more {what} are in fleet.csv.</p>", n - LISTED);
    }
}

fn failed_table(outcome: &Outcome) -> String {
    if outcome.failed.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<h2 id=\"failed\">Files that could not be estimated</h2><div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Files that could not be estimated\"><table class=\"failed\"><tbody>\n",
    );
    for failed in outcome.failed.iter().take(LISTED) {
        let file = failed.file.to_string_lossy();
        let why = failed.why.strip_prefix(&format!("{file}: ")).unwrap_or(&failed.why);
        let _ = writeln!(out, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", escape(&file), escape(why));
    }
    out.push_str("</tbody></table></div>");
    if outcome.failed.len() > LISTED {
        let _ =
            write!(out, "<p class=\"note\">{} more are in failed.csv.</p>", outcome.failed.len() - LISTED);
    }
    out
}

/// Pressures and their standard deviations at the end of each car's last drive; valid shares and roughness of all drives.
fn figures(drives: &[DriveRecord], cars: &[CarStanding<'_>], unit: PressureUnit) -> String {
    let last: Vec<&WheelRecord> =
        cars.iter().filter_map(CarStanding::last).flat_map(|drive| &drive.wheels).collect();
    let all = || drives.iter().flat_map(|drive| &drive.wheels);
    let percent: Vec<f64> = last.iter().filter_map(|wheel| Some(100.0 * share(wheel)?)).collect();
    let sd: Vec<f64> = last.iter().filter_map(|wheel| Some(wheel.last?.sd_kpa / unit.kpa())).collect();
    let valid: Vec<f64> = all().map(|wheel| 100.0 * wheel.share_valid).collect();
    let iri: Vec<f64> = all().filter_map(|wheel| wheel.iri_m_per_km).collect();
    if percent.is_empty() {
        return String::new();
    }
    let pressure =
        histogram("Last pressures", ("Share of the placard's", "%"), &percent, Ink::Default, "tires").moment(
            Ink::Muted,
            100.0,
            "placard",
        );
    let figure = Figure::new("fleet", "The fleet in numbers")
        .panel(pressure)
        .panel(histogram(
            "How sure they are",
            ("Standard deviation", unit.symbol()),
            &sd,
            Ink::Default,
            "tires",
        ))
        .panel(histogram("Share of a drive that is valid", ("Valid", "%"), &valid, Ink::Mended, "wheels"))
        .panel(histogram("Roads", ("Roughness (IRI)", "m/km"), &iri, Ink::Mended, "wheels"));
    let (heading, figure) = ("<h2>The fleet in numbers</h2>", figure.html());
    format!("<section id=\"numbers\">{heading}<div class=\"figures\">{figure}</div></section>\n")
}

fn provenance(plan: &Plan) -> String {
    let settings = &plan.settings;
    let mut rows = vec![
        ("Program", settings.program.clone()),
        ("Made on", today()),
        ("Estimator", settings.estimator.label().to_owned()),
        ("Warning limits", settings.regulation.name().to_owned()),
    ];
    if let Some(calibration) = &plan.calibration {
        let drives = match &calibration.drives {
            Some(pattern) => format!("drives that fit {pattern}"),
            None => "each car's first drive".to_owned(),
        };
        rows.push(("Calibration", format!("the first {} s of {drives}", calibration.seconds)));
    }
    let row = |(what, how): &(&str, String)| {
        format!("<tr><th scope=\"row\">{what}</th><td>{}</td></tr>", escape(how))
    };
    format!("<table class=\"provenance\"><tbody>{}</tbody></table>", rows.iter().map(row).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_names_every_part() {
        assert!(!SCRIPT.to_lowercase().contains("</script"));
        for name in
            ["headline", "subline", "cards", "cars", "figures", "roads", "drives", "provenance", "script"]
        {
            assert!(TEMPLATE.contains(&format!("{{{{{name}}}}}")), "{name}");
        }
    }
}
