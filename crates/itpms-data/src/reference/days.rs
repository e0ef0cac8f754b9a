//! Results of the days since a calibration, as a table of a stored reference and back: sums over days, in thousandths.

use std::fmt::Write as _;

use itpms_core::wheel_speed::{RadiusDay, RadiusDays};

use super::ReferenceProblem;
use crate::error::Problem;
use crate::toml_table::Table;

/// Days in the sums; the number of the newest day, which is in none yet.
const COUNT: &str = "days";
const NEWEST: &str = "newest_day";
/// The ratios: front left over right, rear left over right, front over rear; and the lower triangle of two of them.
const RATIOS: [&str; 3] = ["front", "rear", "axles"];
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// The keys of all other numbers, in the order of [`numbers`].
fn keys() -> Vec<String> {
    let of_pairs = |name: &'static str, unit: &'static str| {
        PAIRS.map(|(i, j)| format!("{name}_{}_{}{unit}", RATIOS[i], RATIOS[j]))
    };
    let sums = ["w", "kw", "kkw"].into_iter().flat_map(|name| of_pairs(name, ""));
    let vectors = ["wd", "kwd"].into_iter().flat_map(|name| RATIOS.map(|ratio| format!("{name}_{ratio}")));
    let newest = RATIOS.map(|ratio| format!("newest_{ratio}_1e3"));
    newest.into_iter().chain(of_pairs("newest", "_1e6")).chain(sums).chain(vectors).collect()
}

fn numbers(days: &mut RadiusDays<f64>) -> impl Iterator<Item = &mut f64> {
    let RadiusDay { change_1e3, covariance_1e6, .. } = &mut days.newest;
    let sums = days.information.as_flattened_mut().iter_mut().chain(days.vector.as_flattened_mut());
    change_1e3.iter_mut().chain(covariance_1e6).chain(sums)
}

pub(super) fn write(out: &mut String, days: &RadiusDays<f64>) {
    // `{:?}` is the shortest form that reads back as the same number.
    let _ =
        write!(out, "\n[days]\n{COUNT} = {:?}\n{NEWEST} = {:?}\n", f64::from(days.count), days.newest.day);
    let mut days = *days;
    for (key, value) in keys().iter().zip(numbers(&mut days)) {
        let _ = writeln!(out, "{key} = {value:?}");
    }
}

pub(super) fn read(table: &Table<'_>, learned_unix_s: u64) -> Result<RadiusDays<f64>, Problem> {
    let keys = keys();
    table.check_keys(&keys.iter().map(String::as_str).chain([COUNT, NEWEST]).collect::<Vec<_>>())?;
    let mut days = RadiusDays::since(learned_unix_s as f64);
    let count = table.needed_number(COUNT)?;
    days.newest.day = table.needed_number(NEWEST)?;
    for (key, value) in keys.iter().zip(numbers(&mut days)) {
        *value = table.needed_number(key)?;
    }
    if !((0.0..1e6).contains(&count) && count.fract() == 0.0) {
        return Err(ReferenceProblem::Lacks("a number of days").into());
    }
    days.count = count as u32;
    if days.is_empty() || !days.is_sane() {
        return Err(ReferenceProblem::Lacks("days that a car has").into());
    }
    Ok(days)
}
