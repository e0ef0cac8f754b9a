//! Parts of a problem's sentence: what may have been meant, and what to do.

pub(super) fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; the nearest name there is {name}")).unwrap_or_default()
}

pub(super) fn one_by_one(found: &str) -> &'static str {
    let is_list = found.starts_with("lists");
    if is_list {
        " (a row for each value, as pandas writes it: drive.explode([...]).to_parquet(...))"
    } else {
        ""
    }
}

pub(super) fn hint_key(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(" (did you mean {name}?)")).unwrap_or_default()
}

pub(super) fn hint_missing(line: Option<usize>) -> String {
    line.map(|line| format!(" (table at line {line})")).unwrap_or_default()
}

pub(super) fn because(repairs: &[String]) -> String {
    if repairs.is_empty() { String::new() } else { format!(" ({})", repairs.join("; ")) }
}

/// The unit in which the period would be that of 80 Hz to 2.5 kHz, in words and as a map has it.
pub(crate) fn likely_unit(period_s: f64) -> Option<(&'static str, &'static str)> {
    let looks_like = |(_, _, factor): &(&str, &str, f64)| (0.4e-3..=12e-3).contains(&(period_s / factor));
    [
        ("milliseconds", "ms", 1e3),
        ("microseconds", "us", 1e6),
        ("nanoseconds", "ns", 1e9),
        ("days, as spreadsheets store times", "d", 1.0 / 86_400.0),
    ]
    .into_iter()
    .find(looks_like)
    .map(|(words, unit, _)| (words, unit))
}

pub(super) fn other_unit(clock: &str, period_s: f64) -> String {
    likely_unit(period_s).map_or_else(String::new, |(words, unit)| {
        format!(
            " (it looks like {words}; a map states it: time_s = {{ signal = {clock:?}, unit = \"{unit}\" }})"
        )
    })
}
