//! Learned values of wheel speeds, as a table of a stored reference and back. In thousandths and their squares.

use std::fmt::Write as _;

use itpms_core::wheel_speed::RadiusCalibration;

use crate::error::Problem;
use crate::toml_table::Table;

/// Log ratios of the radii: front left over right, rear left over right, front over rear; slip of the driven axle per m/s²; what of it
/// the left wheel has more than the right one, in front and at the rear; what a bend's load does to the ratio of each axle, per m/s².
const LEARNED: [&str; 8] =
    ["front", "rear", "axles", "slip", "front_sides", "rear_sides", "front_bend", "rear_bend"];
/// From here on what older files do not have.
const BEND: usize = 6;
/// Whether the yaw rate went against the wheels; left away where it did not.
const YAW_RATE: &str = "leaves_out_yaw_rate";
/// The radii while it was learned, against those at the pressures that should be.
const RADII: [&str; 4] = ["fl_radius_1e3", "fr_radius_1e3", "rl_radius_1e3", "rr_radius_1e3"];

fn mean_key(number: usize) -> String {
    format!("{}_1e3", LEARNED[number])
}

/// The upper triangle of the covariance, row by row, with the keys.
fn covariance_keys() -> impl Iterator<Item = (usize, usize, String)> {
    let row = |row: usize| {
        (row..LEARNED.len())
            .map(move |column| (row, column, format!("{}_{}_1e6", LEARNED[row], LEARNED[column])))
    };
    (0..LEARNED.len()).flat_map(row)
}

pub(super) fn write(out: &mut String, learned: &RadiusCalibration<f64>) {
    out.push_str("\n[wheel_speeds]\n");
    // `{:?}` is the shortest form that reads back as the same number.
    for (number, value) in learned.mean_1e3.iter().enumerate() {
        let _ = writeln!(out, "{} = {value:?}", mean_key(number));
    }
    for (key, value) in RADII.iter().zip(&learned.radius_1e3) {
        let _ = writeln!(out, "{key} = {value:?}");
    }
    for (row, column, key) in covariance_keys() {
        let _ = writeln!(out, "{key} = {:?}", learned.covariance_1e6[row][column]);
    }
    if learned.leaves_out_yaw_rate {
        let _ = writeln!(out, "{YAW_RATE} = true");
    }
}

pub(super) fn read(table: &Table<'_>) -> Result<RadiusCalibration<f64>, Problem> {
    let mut keys: Vec<String> = (0..LEARNED.len()).map(mean_key).collect();
    keys.extend(covariance_keys().map(|(_, _, key)| key));
    keys.extend(RADII.into_iter().chain([YAW_RATE]).map(str::to_owned));
    table.check_keys(&keys.iter().map(String::as_str).collect::<Vec<_>>())?;
    let mut learned = RadiusCalibration::nothing();
    let has_bend = table.has(&mean_key(BEND));
    let is_there = |number: usize| number < BEND || has_bend;
    for (number, mean) in learned.mean_1e3.iter_mut().enumerate().filter(|(number, _)| is_there(*number)) {
        *mean = table.needed_number(&mean_key(number))?;
    }
    for (row, column, key) in covariance_keys().filter(|(_, column, _)| is_there(*column)) {
        let value = table.needed_number(&key)?;
        (learned.covariance_1e6[row][column], learned.covariance_1e6[column][row]) = (value, value);
    }
    for (radius, key) in learned.radius_1e3.iter_mut().zip(RADII) {
        *radius = table.needed_number(key)?;
    }
    learned.leaves_out_yaw_rate = table.flag(YAW_RATE)?.unwrap_or(false);
    Ok(learned)
}
