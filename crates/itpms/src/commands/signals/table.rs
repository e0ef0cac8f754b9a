//! The list for a person: a table per log, groups in the order of the log, and below it what the columns would be.
//! Called by the command alone.

use itpms_console::Screen;
use itpms_console::numbers::{number, thousands};
use itpms_core::model::Corner;
use itpms_data::log::{Field, LogColumns, Slot};
use itpms_data::signals::{ListedGroup, Listing, Resolved};

use super::Columns;
use crate::args::SignalsArgs;

/// Cells of one line, and the same for all.
const HEADS: [(&str, Side); 10] = [
    ("", Side::Left),
    ("id", Side::Left),
    ("rate/Hz", Side::Right),
    ("jitter/ms", Side::Right),
    ("signal", Side::Left),
    ("unit", Side::Left),
    ("samples", Side::Right),
    ("min", Side::Right),
    ("max", Side::Right),
    ("column", Side::Left),
];

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

type Line = [String; HEADS.len()];

pub(super) fn print(
    args: &SignalsArgs,
    listing: &Listing,
    resolved: &Resolved,
    columns: &Columns<'_>,
    screen: &Screen,
) {
    screen.print(format!("{}: {}", args.log.display(), summary(listing)));
    screen.print("");
    let mut lines = vec![HEADS.map(|(head, _)| head.to_owned())];
    lines[0][0] = listing.kind.to_owned();
    for (place, group) in listing.groups.iter().enumerate().filter(|(_, group)| group.is_known) {
        lines.extend(group_lines(place, group, columns));
    }
    let unknown: Vec<&ListedGroup> = listing.groups.iter().filter(|group| !group.is_known).collect();
    if lines.len() > 1 {
        aligned(&lines).iter().for_each(|line| screen.print(line));
    }
    if !unknown.is_empty() {
        let why = if args.dbc.is_some() { "not in the DBC" } else { "no DBC was given (--dbc)" };
        if lines.len() > 1 {
            screen.print("");
        }
        let identifiers = if unknown.len() == 1 { "identifier" } else { "identifiers" };
        screen.print(format!("{} {identifiers} without signals, {why}:", unknown.len()));
        unknown_lines(&unknown).iter().for_each(|line| screen.print(line));
    }
    let messages = absent_messages(listing);
    if !messages.is_empty() {
        screen.print("");
        screen.print(format!("In the DBC, not in this log: {}", shortened(&messages)));
    }
    print_unread(listing, screen);
    screen.print("");
    print_columns(resolved, columns, screen);
    if let Some(path) = &args.write_map {
        screen.remark(format!("wrote {}", path.display()));
    }
}

/// Contents that cannot be read, by the reason.
fn print_unread(listing: &Listing, screen: &Screen) {
    let mut reasons: Vec<(&str, Vec<String>)> = Vec::new();
    for unread in &listing.unread {
        let name = unread.candidate.full_name();
        match reasons.iter_mut().find(|(why, _)| *why == unread.why) {
            Some((_, names)) => names.push(name),
            None => reasons.push((&unread.why, vec![name])),
        }
    }
    if !reasons.is_empty() {
        screen.print("");
        screen.print("Not read:");
    }
    for (why, names) in reasons {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        screen.print(format!("{}: {why}", shortened(&names)));
    }
}

fn print_columns(resolved: &Resolved, columns: &Columns<'_>, screen: &Screen) {
    for (chosen, line) in resolved.iter().zip(resolved.lines()) {
        if columns.is_in_log(chosen) {
            screen.print(line);
        }
    }
    let missing = columns.not_in_log();
    if !missing.is_empty() {
        screen.print(format!("Not in this log, though it would be a column: {}", missing.join(", ")));
    }
    for slot in resolved.lone() {
        screen.print(format!("no signal for {}, so this corner cannot be estimated", slot.name()));
    }
    match resolved.unusable() {
        Some(why) => screen.print(format!("Not enough to estimate: {why}")),
        None => {
            let there = |slot| resolved.get(slot).is_some_and(|chosen| columns.is_in_log(chosen));
            let both = |corner: &Corner| {
                [Field::BodyAccel, Field::WheelAccel]
                    .into_iter()
                    .all(|field| there(Slot::Corner(*corner, field)))
            };
            let corners: Vec<&str> = Corner::ALL.into_iter().filter(both).map(Corner::label).collect();
            let slots: Vec<Slot> = resolved.slots().into_iter().filter(|slot| there(*slot)).collect();
            let roll = LogColumns::of(&slots).motion.wheel_speeds();
            if roll {
                screen.print("Wheel speeds of all four wheels");
            }
            if !corners.is_empty() || !roll {
                let corners = if corners.is_empty() { vec!["none in this log"] } else { corners };
                screen.print(format!("Corners with both accelerations: {}", corners.join(" ")));
            }
        }
    }
}

fn summary(listing: &Listing) -> String {
    let what = match listing.kind {
        "message" => "frames",
        "table" => "rows",
        _ => "samples",
    };
    let mut text = format!("{} {what}", thousands(listing.samples));
    if let Some((first_s, last_s)) = listing.span_s {
        text += &format!(" in {} s", number(last_s - first_s));
    }
    let signals: usize = listing.groups.iter().map(|group| group.signals.len()).sum();
    match listing.kind {
        "table" => {
            text += &format!(", {signals} columns");
            if let Some(clock) = &listing.clock {
                text += &format!(" beside the clock, {clock}");
            }
        }
        kind => {
            let known = listing.groups.iter().filter(|group| group.is_known).count();
            text += &format!(", {known} {kind}s with {signals} signals");
        }
    }
    text
}

fn group_lines(place: usize, group: &ListedGroup, columns: &Columns<'_>) -> Vec<Line> {
    let bus = group.bus.map(|bus| format!(" bus {bus}")).unwrap_or_default();
    let head = [
        group.name.clone(),
        group.id.as_ref().map(|id| format!("{id}{bus}")).unwrap_or_default(),
        rate(group),
        jitter(group),
    ];
    let mut lines = Vec::new();
    for (number_in_group, signal) in group.signals.iter().enumerate() {
        let [name, id, rate, jitter] =
            if number_in_group == 0 { head.clone() } else { [const { String::new() }; 4] };
        let column = columns.of(place, number_in_group).map(|chosen| chosen.slot.name());
        lines.push([
            name,
            id,
            rate,
            jitter,
            signal.name.clone(),
            signal.unit.clone(),
            thousands(signal.samples),
            number(signal.min),
            number(signal.max),
            column.unwrap_or_default(),
        ]);
    }
    if lines.is_empty() {
        let [name, id, rate, jitter] = head;
        let mut line = [const { String::new() }; HEADS.len()];
        [line[0], line[1], line[2], line[3]] = [name, id, rate, jitter];
        line[6] = thousands(group.samples);
        lines.push(line);
    }
    lines
}

fn unknown_lines(groups: &[&ListedGroup]) -> Vec<String> {
    let mut lines = vec![["id", "rate/Hz", "jitter/ms", "frames", "bytes"].map(str::to_owned)];
    for group in groups {
        let bus = group.bus.map(|bus| format!(" bus {bus}")).unwrap_or_default();
        let bytes = match group.bytes {
            Some((least, most)) if least == most => most.to_string(),
            Some((least, most)) => format!("{least}-{most}"),
            None => String::new(),
        };
        let id = group.id.clone().unwrap_or_default();
        lines.push([format!("{id}{bus}"), rate(group), jitter(group), thousands(group.samples), bytes]);
    }
    let sides = [Side::Left, Side::Right, Side::Right, Side::Right, Side::Right];
    aligned_as(&lines, &sides)
}

/// The rate, and what it should be where that is stated and more than a tenth off.
fn rate(group: &ListedGroup) -> String {
    let Some(rate_hz) = group.rate_hz else { return String::new() };
    match group.stated_hz {
        Some(stated) if !((rate_hz / stated - 1.0).abs() < 0.1) => {
            format!("{} (DBC: {})", number(rate_hz), number(stated))
        }
        _ => number(rate_hz),
    }
}

fn jitter(group: &ListedGroup) -> String {
    group.jitter_s.map(|jitter_s| format!("{:.2}", 1e3 * jitter_s)).unwrap_or_default()
}

/// Names of messages of which no frame came, each once.
fn absent_messages(listing: &Listing) -> Vec<&str> {
    let mut names: Vec<&str> = listing.absent.iter().map(|signal| signal.group.as_str()).collect();
    names.dedup();
    names
}

fn shortened(names: &[&str]) -> String {
    const MOST: usize = 12;
    let mut text = names.iter().take(MOST).copied().collect::<Vec<_>>().join(", ");
    if names.len() > MOST {
        text += &format!(" and {} more", names.len() - MOST);
    }
    text
}

/// Lines with their cells below one another; columns in which nothing is written are left out.
fn aligned(lines: &[Line]) -> Vec<String> {
    let used = |place: &usize| lines.iter().skip(1).any(|line| !line[*place].is_empty());
    let places: Vec<usize> = (0..HEADS.len()).filter(used).collect();
    let rows: Vec<Vec<String>> =
        lines.iter().map(|line| places.iter().map(|place| line[*place].clone()).collect()).collect();
    let sides: Vec<Side> = places.iter().map(|place| HEADS[*place].1).collect();
    aligned_as(&rows, &sides)
}

fn aligned_as<L: AsRef<[String]>>(lines: &[L], sides: &[Side]) -> Vec<String> {
    let width = |place: usize| {
        let cell = |line: &L| line.as_ref().get(place).map_or(0, |cell| cell.chars().count());
        lines.iter().map(cell).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..sides.len()).map(width).collect();
    let line = |line: &L| {
        let cells = line.as_ref().iter().zip(sides).zip(&widths).map(|((cell, side), width)| match side {
            Side::Left => format!("{cell:<width$}"),
            Side::Right => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    lines.iter().map(line).collect()
}
