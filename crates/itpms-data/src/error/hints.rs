//! Parts of a problem's sentence: what may have been meant, and what to do.

use itpms_files::{nearest, shortened};

use super::Problem;

pub(super) fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; the nearest name there is {name}")).unwrap_or_default()
}

/// A header without a column it has to have, of a table of measurements.
pub(crate) fn not_among(column: &str, header: &[String], known: &[&str], expected: &str) -> Problem {
    let strangers = header.iter().map(String::as_str).filter(|name| !known.contains(name));
    let (nearest, found) = (hint(&nearest(column, strangers).map(shortened)), shortened(&header.join(",")));
    Problem::Refused(format!("column {column} is missing{nearest}; found {found}, expected {expected}"))
}

/// A column that is there twice, at these places, from zero.
pub(crate) fn twice(column: &str, first: usize, second: usize) -> Problem {
    let places = format!("columns {} and {}", first + 1, second + 1);
    Problem::Refused(format!("column {column} appears twice ({places}), expected once: rename one"))
}

/// The header is one long cell because another separator was used.
pub(crate) fn separated_by(separator: char) -> Problem {
    Problem::Refused(format!("the header is separated by {separator:?}, expected commas"))
}

/// The clock of these rows, or of a signal, counts in steps longer than the samples' period, and these did not come evenly.
pub(crate) fn coarse_clock(what: &str, step_s: f64, rate_hz: f64) -> Problem {
    let step_s = (step_s * 1e6).round() / 1e6;
    Problem::Refused(format!(
        "the times of {what} are in steps of {step_s} s under {rate_hz:.0} samples a second, and these are not even: where each belongs is \
         not sure; expected steps shorter than the samples' period (write the time with more digits, or take the logger's finer clock)"
    ))
}

pub(super) fn one_by_one(found: &str) -> &'static str {
    let is_list = found.starts_with("lists");
    if is_list {
        " (a row for each value, as pandas writes it: drive.explode([...]).to_parquet(...))"
    } else {
        ""
    }
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
