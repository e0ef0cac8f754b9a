//! Whatever advice the program gives about a log, followed, works: one drive under many names, units and formats.
#![cfg(all(feature = "can", feature = "mdf4", feature = "parquet"))]

use std::path::Path;

use crate::common::{Bench, Outcome, table};

/// Characters that a person reads of a refusal at most.
const LONGEST: usize = 400;
const ROWS: usize = 4_000;

/// How a logger might write the drive.
#[derive(Debug, Clone, Copy)]
struct Style {
    name: fn(&str) -> String,
    /// Units of the time, the speed and the accelerations, and how many of them are one of ours.
    units: [(&'static str, f64); 3],
    place: Place,
    /// The line before the names, and what parts the cells.
    separator: (&'static str, char),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    InNames,
    InSecondRow,
    Nowhere,
}

const G: f64 = 1.0 / 9.806_65;
const UNITS: [[(&str, f64); 3]; 3] = [
    [("s", 1.0), ("m/s", 1.0), ("m/s^2", 1.0)],
    [("s", 1.0), ("km/h", 3.6), ("g", G)],
    [("ms", 1e3), ("km/h", 3.6), ("mg", 1e3 * G)],
];
const SEPARATORS: [(&str, char, &str); 3] = [("", ',', "csv"), ("", '\t', "tsv"), ("sep=;\n", ';', "csv")];

fn wheel(column: &str) -> (&str, &str) {
    column.split_once('_').unwrap()
}

fn own(column: &str) -> String {
    column.to_owned()
}

fn spelled_out(column: &str) -> String {
    let (corner, rest) = wheel(column);
    let place = if rest.starts_with("body") { "Body" } else { "Wheel" };
    match corner {
        "time" => "Timestamp".to_owned(),
        "speed" => "VehSpd".to_owned(),
        "fl" => format!("FrontLeft_{place}_Acc"),
        "fr" => format!("FrontRight_{place}_Acc"),
        "rl" => format!("RearLeft_{place}_Acc"),
        _ => format!("RearRight_{place}_Acc"),
    }
}

/// Names that cannot be known.
fn channels(column: &str) -> String {
    format!("Ch {}", column.bytes().map(u32::from).sum::<u32>())
}

/// The drive in this style, without the truth.
fn log(names: &[String], rows: &[Vec<String>], style: &Style) -> String {
    let of = |name: &str| match name {
        "time_s" => style.units[0],
        "speed_m_s" => style.units[1],
        _ => style.units[2],
    };
    let kept: Vec<usize> = (0..names.len()).filter(|i| *i < 2 || names[*i].contains("accel")).collect();
    let joined = |cells: Vec<String>| cells.join(&style.separator.1.to_string()) + "\n";
    let head = |i: &usize| {
        let name = (style.name)(&names[*i]);
        if style.place == Place::InNames { format!("{name} [{}]", of(&names[*i]).0) } else { name }
    };
    let mut text = style.separator.0.to_owned() + &joined(kept.iter().map(head).collect());
    if style.place == Place::InSecondRow {
        text += &joined(kept.iter().map(|i| of(&names[*i]).0.to_owned()).collect());
    }
    for row in &rows[..ROWS] {
        let cell = |i: &usize| (row[*i].parse::<f64>().unwrap() * of(&names[*i]).1).to_string();
        text += &joined(kept.iter().map(cell).collect());
    }
    text
}

fn estimate(bench: &Bench, log: &str, more: &str) -> Outcome {
    let outcome = bench.run(&format!("-q estimate {log} --vehicle car.toml {more}"));
    if outcome.code != Some(0) {
        let text = outcome.refusal();
        assert!(text.chars().count() <= LONGEST, "{} characters: {text}", text.chars().count());
    }
    outcome
}

/// What stands in a text after `begin`, up to `end`, each time.
fn quoted<'a>(text: &'a str, begin: &str, end: &str) -> Vec<&'a str> {
    text.split(begin).skip(1).filter_map(|rest| rest.split(end).next()).collect()
}

/// Follows all advice about a log; whether it was estimated in the end.
fn follow(bench: &Bench, log: &str, dbc: &str, units_are_ours: bool) -> bool {
    let direct = estimate(bench, log, dbc);
    let reported = &direct.stderr;
    // As everything that is not refused, it runs again with a map that is written.
    let listed = bench.run(&format!("signals {log} {dbc} --write-map {log}.toml"));
    let text = listed.success();
    let corners = quoted(text, "Corners with both accelerations: ", "\n").concat();
    let (map, mapped) = (format!("{log}.toml"), format!("{dbc} --signals {log}.toml"));
    if let Some(advice) = quoted(reported, "a map states it: ", ")").first() {
        bench.write(&map, format!("[signals]\n{advice}\n"));
        let outcome = estimate(bench, log, &mapped);
        assert!(!outcome.stderr.contains("looks like"), "{outcome:?}");
        return outcome.code == Some(0);
    }
    if reported.contains("--trust-units") {
        let trusted = estimate(bench, log, &format!("{dbc} --trust-units"));
        assert!(!trusted.stderr.contains("units suspected"), "{trusted:?}");
        return trusted.code == Some(0);
    }
    let suggestions = quoted(&listed.stderr, "say it in a map, ", " (or");
    if units_are_ours && !suggestions.is_empty() {
        bench.write(&map, bench.read(&map) + &suggestions.join("\n") + "\n");
        let outcome = estimate(bench, log, &mapped);
        if suggestions.len() > 1 {
            outcome.success();
        }
        return outcome.code == Some(0);
    }
    if corners.is_empty() {
        return false;
    }
    estimate(bench, log, &mapped).success();
    true
}

#[test]
fn advice_about_a_table_works() {
    let bench = Bench::new();
    bench.run("simulate drive-puncture --seed 2 -o drive.csv --vehicle-out car.toml").success();
    let (names, rows) = table(&bench.read("drive.csv"));
    let mut number = 0usize;
    for name in [own as fn(&str) -> String, spelled_out, channels] {
        for units in UNITS {
            for place in [Place::InNames, Place::InSecondRow, Place::Nowhere] {
                let (line, separator, extension) = SEPARATORS[number % SEPARATORS.len()];
                number += 1;
                let style = Style { name, units, place, separator: (line, separator) };
                let log_name = format!("log{number}.{extension}");
                bench.write(&log_name, log(&names, &rows, &style));
                let ours = units[2].1 == 1.0;
                let estimated = follow(&bench, &log_name, "", ours);
                // Whose names say what they are is estimated, unless the units are stated nowhere and are not ours.
                let known = (style.name)("fl_body") != channels("fl_body");
                let is_clear = known && (place != Place::Nowhere || ours);
                assert!(estimated || !is_clear, "{style:?}: {log_name}");
                if is_clear {
                    for other in ["parquet", "mf4"] {
                        let copy = format!("{log_name}.{other}");
                        if bench.run(&format!("-q convert {log_name} {copy}")).code != Some(0) {
                            bench
                                .run(&format!("-q convert {log_name} {copy} --signals {log_name}.toml"))
                                .success();
                        }
                        assert!(follow(&bench, &copy, "", ours), "{style:?}: {copy}");
                    }
                }
            }
        }
    }
}

#[test]
fn advice_about_a_bus_works() {
    let bench = Bench::new();
    let example = |name: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/can").join(name).display().to_string()
    };
    let (dbc, map) = (format!("--dbc {}", example("car.dbc")), example("map.toml"));
    bench.run("simulate drive-puncture --seed 2 -o drive.csv --vehicle-out car.toml").success();
    bench.run(&format!("-q convert drive.csv bus.log {dbc} --signals {map}")).success();
    for log in ["bus.log", "bus.asc", "bus.blf"] {
        if log != "bus.log" {
            bench.run(&format!("-q convert bus.log {log}")).success();
        }
        estimate(&bench, log, &format!("{dbc} --signals {map}")).success();
        // The axles' names say nothing of a wheel: what is missing is named.
        let refused = estimate(&bench, log, &dbc);
        assert!(refused.refusal().contains("map"), "{refused:?}");
        assert!(!follow(&bench, log, &dbc, false));
        assert!(estimate(&bench, log, "").refusal().contains("--dbc"));
    }
}
