//! A vehicle back into the text of its file. Called by [`Vehicle::to_toml`](super::Vehicle::to_toml) alone.

use std::fmt::Write as _;

use itpms_core::model::{Confidence, Corner, CornerConfig, PressureMap};

use super::Vehicle;
use super::details::{CornerDetails, TireDetails};
use crate::toml_table::escaped;

pub(super) fn vehicle(vehicle: &Vehicle) -> String {
    let mut out = String::from("[vehicle]\n");
    let _ = writeln!(out, "name = \"{}\"", escaped(&vehicle.name));
    if let Some(id) = &vehicle.id {
        let _ = writeln!(out, "id = \"{}\"", escaped(id));
    }
    if let Some(learned) = &vehicle.learned {
        let _ = writeln!(out, "learned = \"{}\"", escaped(learned));
    }
    if let Some(wheelbase_m) = vehicle.wheelbase_m {
        number(&mut out, "wheelbase_m", wheelbase_m);
    }
    let details = &vehicle.details;
    numbers(&mut out, [("wheelbase_sd_m", details.wheelbase_sd_m)]);
    if details.confidence != Confidence::default() {
        let _ = writeln!(out, "confidence = \"{}\"", details.confidence.label());
    }
    numbers(&mut out, [("track_front_m", details.track_front_m), ("track_rear_m", details.track_rear_m)]);
    if let Some(driven) = details.driven {
        let _ = writeln!(out, "driven = \"{}\"", driven.label());
    }
    if details.limited_slip {
        out.push_str("limited_slip = true\n");
    }
    numbers(
        &mut out,
        [
            ("home_altitude_m", details.home_altitude_m),
            ("spring_stiffening_per_m", details.spring_stiffening_per_m),
        ],
    );
    if let Some([front, rear]) = details.gross_axle_kg {
        let _ = writeln!(out, "gross_axle_kg = [{front:?}, {rear:?}]");
    }
    for (key, value) in
        [("level_control", details.level_control), ("adaptive_dampers", details.adaptive_dampers)]
    {
        if value {
            let _ = writeln!(out, "{key} = true");
        }
    }
    if vehicle.corners.iter().all(Option::is_none) {
        wheels(&mut out, &details.corners);
    }
    let corners = || Corner::ALL.into_iter().filter_map(|c| vehicle.corner(c).map(|config| (c, config)));
    let beyond = |corner: Corner| &details.corners[corner.index()];
    let tires = || corners().map(|(corner, config)| (config.tire, beyond(corner).tire));
    let common = tires().next();
    let same_tire = tires().all(|tire| Some(tire) == common);
    if let (true, Some((map, rest))) = (same_tire, common) {
        out.push_str("\n[tire]\n");
        tire(&mut out, &map, &rest);
    }
    for (corner, config) in corners() {
        let _ = writeln!(out, "\n[corner.{}]", corner.label());
        corner_keys(&mut out, config);
        corner_details(&mut out, beyond(corner));
        if !same_tire {
            let _ = writeln!(out, "\n[corner.{}.tire]", corner.label());
            tire(&mut out, &config.tire, &beyond(corner).tire);
        }
    }
    out
}

/// Corners of which wheel speeds alone are known: tires without stiffness, and placard pressures.
fn wheels(out: &mut String, corners: &[CornerDetails; 4]) {
    let same_tire = corners.iter().all(|corner| corner.tire == corners[0].tire);
    if same_tire && corners[0].tire != TireDetails::default() {
        out.push_str("\n[tire]\n");
        tire_details(out, &corners[0].tire);
    }
    for (corner, details) in Corner::ALL.into_iter().zip(corners) {
        if let Some(placard_kpa) = details.placard_kpa {
            let _ = writeln!(out, "\n[corner.{}]", corner.label());
            number(out, "placard_kpa", placard_kpa);
        }
        if !same_tire {
            let _ = writeln!(out, "\n[corner.{}.tire]", corner.label());
            tire_details(out, &details.tire);
        }
    }
}

/// Width of `key = value` before its comment.
const COLUMN: usize = 40;

/// The text of a vehicle file with comments, whose content cannot end a line.
pub(super) fn commented(
    text: &str,
    head: &[String],
    comment: &dyn Fn(&str, &str) -> Option<String>,
) -> String {
    let one_line = |text: &str| text.replace(|c: char| c.is_control(), " ");
    let mut out: String = head.iter().map(|line| format!("# {}\n", one_line(line))).collect();
    out.push_str(if head.is_empty() { "" } else { "\n" });
    let mut table = "";
    for line in text.lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            table = name;
        }
        let key = line.split_once(" = ").map(|(key, _)| key);
        let _ = match key.and_then(|key| comment(table, key)) {
            Some(comment) => writeln!(out, "{line:<COLUMN$} # {}", one_line(&comment)),
            None => writeln!(out, "{line}"),
        };
    }
    out
}

fn corner_keys(out: &mut String, config: &CornerConfig<f64>) {
    let car = &config.quarter_car;
    number(out, "sprung_mass_kg", car.sprung_mass_kg());
    number(out, "unsprung_mass_kg", car.unsprung_mass_kg());
    number(out, "damping_n_s_per_m", car.damping_n_s_per_m());
    number(out, "spring_n_per_m", car.spring_n_per_m());
    number(out, "placard_kpa", config.placard_kpa);
    if let Some(noise) = config.accel_noise_m_s2 {
        number(out, "accel_noise_m_s2", noise);
    }
    if let Some(initial_kpa) = config.initial_kpa {
        number(out, "initial_kpa", initial_kpa);
    }
}

fn corner_details(out: &mut String, details: &CornerDetails) {
    numbers(
        out,
        [
            ("sprung_mass_relative_sd", details.sprung_mass_relative_sd),
            ("unsprung_mass_relative_sd", details.unsprung_mass_relative_sd),
            ("spring_relative_sd", details.spring_relative_sd),
            ("damping_relative_sd", details.damping_relative_sd),
            ("friction_n", details.friction_n),
            ("friction_sd_n", details.friction_sd_n),
            ("tire_damping_n_s_per_m", details.tire_damping_n_s_per_m),
            ("tire_damping_sd_n_s_per_m", details.tire_damping_sd_n_s_per_m),
        ],
    );
}

/// The `[tire]` table of a vehicle file, coefficients to nine digits.
pub(super) fn tire_table(map: &PressureMap<f64>) -> String {
    let mut out = String::from("[tire]\n");
    coefficients(&mut out, nine_digits(map.stiffness_per_kpa()), nine_digits(map.stiffness_at_zero()));
    uncertainty(&mut out, map);
    out
}

/// The line and, where it has one, its uncertainty; then the optional keys.
fn tire(out: &mut String, map: &PressureMap<f64>, details: &TireDetails) {
    coefficients(out, map.stiffness_per_kpa(), map.stiffness_at_zero());
    uncertainty(out, map);
    tire_details(out, details);
}

fn tire_details(out: &mut String, details: &TireDetails) {
    numbers(
        out,
        [
            ("stiffness_relative_sd", details.stiffness_relative_sd),
            ("stiffness_over_mass_relative_sd", details.stiffness_over_mass_relative_sd),
            ("rolling_radius_m", details.rolling_radius_m),
            ("radius_per_ln_pressure", details.radius_per_ln_pressure),
            ("radius_per_ln_pressure_sd", details.radius_per_ln_pressure_sd),
            ("torsion_hz", details.torsion_hz),
            ("torsion_hz_per_kpa", details.torsion_hz_per_kpa),
        ],
    );
    if let Some(teeth) = details.teeth {
        let _ = writeln!(out, "teeth = {teeth}");
    }
}

fn coefficients(out: &mut String, stiffness_per_kpa: f64, stiffness_at_zero: f64) {
    number(out, "stiffness_per_kpa", stiffness_per_kpa);
    number(out, "stiffness_at_zero", stiffness_at_zero);
}

fn uncertainty(out: &mut String, map: &PressureMap<f64>) {
    let (slope_sd, intercept_sd) = (map.stiffness_per_kpa_sd(), map.stiffness_at_zero_sd());
    if slope_sd > 0.0 || intercept_sd > 0.0 {
        number(out, "stiffness_per_kpa_sd", nine_digits(slope_sd));
        number(out, "stiffness_at_zero_sd", nine_digits(intercept_sd));
    }
    if slope_sd > 0.0 && intercept_sd > 0.0 {
        let correlation = map.stiffness_correlation();
        number(out, "stiffness_correlation", nine_digits(correlation.clamp(-1.0, 1.0)));
    }
}

/// Rounded to nine significant digits: a standard deviation's square root has no more to say, and people read it.
fn nine_digits(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

fn number(out: &mut String, key: &str, value: f64) {
    // `{:?}` is the shortest form that reads back as the same number and always has a point or an exponent.
    let _ = writeln!(out, "{key} = {value:?}");
}

fn numbers<const N: usize>(out: &mut String, keys: [(&str, Option<f64>); N]) {
    for (key, value) in keys {
        if let Some(value) = value {
            number(out, key, value);
        }
    }
}
