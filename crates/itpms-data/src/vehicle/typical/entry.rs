//! A line of a vehicle file: `key = value`, and what it is.

use std::fmt::Write as _;

/// Width of `key = value` before its comment.
const COLUMN: usize = 40;

pub(super) fn line(out: &mut String, key: &str, value: f64, decimals: usize, comment: &str) {
    let mut text = format!("{key} = {value:.decimals$}");
    // A TOML float has a point; a whole number without one is read all the same.
    if decimals == 0 {
        text.push_str(".0");
    }
    if !comment.is_empty() {
        text = format!("{text:<COLUMN$} # {comment}");
    }
    let _ = writeln!(out, "{text}");
}
