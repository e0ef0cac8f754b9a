//! What was learned of wheel speeds, as a table of a stored reference and back. In thousandths and their squares.

use std::fmt::Write as _;

use itpms_core::wheel_speed::RadiusCalibration;

use crate::error::Problem;
use crate::toml_table::Table;

/// Log ratios of the radii: front left over right, rear left over right, front over rear; slip of the driven axle per m/s²; what of it
/// the left wheel has more than the right one, in front and at the rear.
const MEANS: [&str; 6] =
    ["front_1e3", "rear_1e3", "axles_1e3", "slip_1e3", "front_sides_1e3", "rear_sides_1e3"];
/// The upper triangle of their covariance, row by row.
const COVARIANCES: [(usize, usize, &str); 21] = [
    (0, 0, "front_front_1e6"),
    (0, 1, "front_rear_1e6"),
    (0, 2, "front_axles_1e6"),
    (0, 3, "front_slip_1e6"),
    (0, 4, "front_front_sides_1e6"),
    (0, 5, "front_rear_sides_1e6"),
    (1, 1, "rear_rear_1e6"),
    (1, 2, "rear_axles_1e6"),
    (1, 3, "rear_slip_1e6"),
    (1, 4, "rear_front_sides_1e6"),
    (1, 5, "rear_rear_sides_1e6"),
    (2, 2, "axles_axles_1e6"),
    (2, 3, "axles_slip_1e6"),
    (2, 4, "axles_front_sides_1e6"),
    (2, 5, "axles_rear_sides_1e6"),
    (3, 3, "slip_slip_1e6"),
    (3, 4, "slip_front_sides_1e6"),
    (3, 5, "slip_rear_sides_1e6"),
    (4, 4, "front_sides_front_sides_1e6"),
    (4, 5, "front_sides_rear_sides_1e6"),
    (5, 5, "rear_sides_rear_sides_1e6"),
];
/// Whether the yaw rate went against the wheels; left away where it did not.
const YAW_RATE: &str = "leaves_out_yaw_rate";
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
    if learned.leaves_out_yaw_rate {
        let _ = writeln!(out, "{YAW_RATE} = true");
    }
}

pub(super) fn read(table: &Table<'_>) -> Result<RadiusCalibration<f64>, Problem> {
    let keys: Vec<&str> =
        MEANS.into_iter().chain(RADII).chain(COVARIANCES.map(|(_, _, key)| key)).chain([YAW_RATE]).collect();
    table.check_keys(&keys)?;
    let mut covariance_1e6 = [[0.0; 6]; 6];
    for (row, column, key) in COVARIANCES {
        let value = table.needed_number(key)?;
        (covariance_1e6[row][column], covariance_1e6[column][row]) = (value, value);
    }
    Ok(RadiusCalibration {
        mean_1e3: numbers(table, MEANS)?,
        covariance_1e6,
        radius_1e3: numbers(table, RADII)?,
        leaves_out_yaw_rate: table.flag(YAW_RATE)?.unwrap_or(false),
    })
}

fn numbers<const N: usize>(table: &Table<'_>, keys: [&'static str; N]) -> Result<[f64; N], Problem> {
    let mut values = [0.0; N];
    for (value, key) in values.iter_mut().zip(keys) {
        *value = table.needed_number(key)?;
    }
    Ok(values)
}
