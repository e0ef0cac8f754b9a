//! What was learned of wheel speeds, as a table of a stored reference and back. In thousandths and their squares.

use std::fmt::Write as _;

use itpms_core::wheel_speed::RadiusCalibration;

use super::text::needed_number;
use crate::error::Problem;
use crate::toml_table::Table;

/// Log ratios of the radii: front left over right, rear left over right, front over rear; and slip of the driven axle per m/s².
const MEANS: [&str; 4] = ["front_1e3", "rear_1e3", "axles_1e3", "slip_1e3"];
/// The upper triangle of their covariance, row by row.
const COVARIANCES: [(usize, usize, &str); 10] = [
    (0, 0, "front_front_1e6"),
    (0, 1, "front_rear_1e6"),
    (0, 2, "front_axles_1e6"),
    (0, 3, "front_slip_1e6"),
    (1, 1, "rear_rear_1e6"),
    (1, 2, "rear_axles_1e6"),
    (1, 3, "rear_slip_1e6"),
    (2, 2, "axles_axles_1e6"),
    (2, 3, "axles_slip_1e6"),
    (3, 3, "slip_slip_1e6"),
];
/// The radii while it was learned, against those at the pressures that should be.
const RADII: [&str; 4] = ["fl_radius_1e3", "fr_radius_1e3", "rl_radius_1e3", "rr_radius_1e3"];

pub(super) fn write(out: &mut String, learned: &RadiusCalibration<f64>) {
    out.push_str("\n[wheel_speeds]\n");
    // `{:?}` is the shortest form that reads back as the same number.
    for (key, value) in MEANS.iter().zip(&learned.mean_1e3).chain(RADII.iter().zip(&learned.radius_1e3)) {
        let _ = writeln!(out, "{key} = {value:?}");
    }
    for (row, column, key) in COVARIANCES {
        let _ = writeln!(out, "{key} = {:?}", learned.covariance_1e6[row][column]);
    }
}

pub(super) fn read(table: &Table<'_>) -> Result<RadiusCalibration<f64>, Problem> {
    let keys: Vec<&str> = MEANS.into_iter().chain(RADII).chain(COVARIANCES.map(|(_, _, key)| key)).collect();
    table.check_keys(&keys)?;
    let four = |keys: [&'static str; 4]| -> Result<[f64; 4], Problem> {
        let mut values = [0.0; 4];
        for (value, key) in values.iter_mut().zip(keys) {
            *value = needed_number(table, key)?;
        }
        Ok(values)
    };
    let mut covariance_1e6 = [[0.0; 4]; 4];
    for (row, column, key) in COVARIANCES {
        let value = needed_number(table, key)?;
        (covariance_1e6[row][column], covariance_1e6[column][row]) = (value, value);
    }
    Ok(RadiusCalibration { mean_1e3: four(MEANS)?, covariance_1e6, radius_1e3: four(RADII)? })
}
