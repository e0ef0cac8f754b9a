//! The optional keys of a vehicle file, read and checked. Called by [`Vehicle::parse`](super::Vehicle::parse).

use itpms_core::model::{Confidence, ParameterError};

use super::checked;
use super::details::{CornerDetails, Driven, TireDetails, VehicleDetails};
use crate::error::Problem;
use crate::toml_table::Table;

pub(super) const VEHICLE_KEYS: [&str; 15] = [
    "name",
    "id",
    "learned",
    "wheelbase_m",
    "wheelbase_sd_m",
    "confidence",
    "track_front_m",
    "track_rear_m",
    "driven",
    "limited_slip",
    "home_altitude_m",
    "spring_stiffening_per_m",
    "gross_axle_kg",
    "level_control",
    "adaptive_dampers",
];

/// The largest relative standard deviation that says anything: beyond, a value is a guess of its own order.
const LARGEST_RELATIVE_SD: f64 = 1.0;

/// The table `[vehicle]`; the corners follow.
pub(super) fn vehicle(table: &Table<'_>) -> Result<VehicleDetails, Problem> {
    let confidence = word(table, "confidence", Confidence::ALL.map(|c| (c.label(), c)), CONFIDENCES)?;
    Ok(VehicleDetails {
        confidence: confidence.unwrap_or_default(),
        wheelbase_sd_m: up_to(table, "wheelbase_sd_m", 1.0, "0 to 1 m")?,
        track_front_m: checked(table, "track_front_m")?,
        track_rear_m: checked(table, "track_rear_m")?,
        driven: word(table, "driven", Driven::ALL.map(|d| (d.label(), d)), DRIVEN)?,
        limited_slip: table.flag("limited_slip")?.unwrap_or(false),
        home_altitude_m: between(table, "home_altitude_m", -500.0, 6000.0, "a height of -500 to 6000 m")?,
        spring_stiffening_per_m: up_to(
            table,
            "spring_stiffening_per_m",
            30.0,
            "0 to 30 per m (3 is 3 % per cm)",
        )?,
        gross_axle_kg: gross_axle_kg(table)?,
        level_control: table.flag("level_control")?.unwrap_or(false),
        adaptive_dampers: table.flag("adaptive_dampers")?.unwrap_or(false),
        ..VehicleDetails::default()
    })
}

/// Permitted axle loads: a kart's axle to a truck's.
fn gross_axle_kg(table: &Table<'_>) -> Result<Option<[f64; 2]>, Problem> {
    const KEY: &str = "gross_axle_kg";
    let Some(axles) = table.pair(KEY)? else { return Ok(None) };
    match axles.into_iter().find(|kg| !(40.0..=40_000.0).contains(kg)) {
        Some(value) => {
            let expected = "two axle loads of 40 to 40000 kg, front and rear";
            Err(table.refuse(ParameterError { name: KEY, value, expected }))
        }
        None => Ok(Some(axles)),
    }
}

const CONFIDENCES: &str = "\"measured\", \"typical\" or \"rough\"";
const DRIVEN: &str = "\"front\", \"rear\" or \"all\"";

pub(super) fn corner(table: &Table<'_>, tire: TireDetails) -> Result<CornerDetails, Problem> {
    Ok(CornerDetails {
        sprung_mass_relative_sd: relative_sd(table, "sprung_mass_relative_sd")?,
        unsprung_mass_relative_sd: relative_sd(table, "unsprung_mass_relative_sd")?,
        spring_relative_sd: relative_sd(table, "spring_relative_sd")?,
        damping_relative_sd: relative_sd(table, "damping_relative_sd")?,
        friction_n: up_to(table, "friction_n", 5_000.0, "0 to 5000 N")?,
        friction_sd_n: up_to(table, "friction_sd_n", 5_000.0, "0 to 5000 N")?,
        tire_damping_n_s_per_m: up_to(table, "tire_damping_n_s_per_m", 20_000.0, "0 to 20000 N s/m")?,
        tire_damping_sd_n_s_per_m: up_to(table, "tire_damping_sd_n_s_per_m", 20_000.0, "0 to 20000 N s/m")?,
        placard_kpa: None,
        tire,
    })
}

pub(super) fn tire(table: &Table<'_>) -> Result<TireDetails, Problem> {
    Ok(TireDetails {
        stiffness_relative_sd: relative_sd(table, "stiffness_relative_sd")?,
        stiffness_over_mass_relative_sd: relative_sd(table, "stiffness_over_mass_relative_sd")?,
        rolling_radius_m: checked(table, "rolling_radius_m")?,
        radius_per_ln_pressure: between(
            table,
            "radius_per_ln_pressure",
            -0.5,
            0.5,
            "a number from -0.5 to 0.5",
        )?,
        radius_per_ln_pressure_sd: up_to(table, "radius_per_ln_pressure_sd", 0.5, "a number from 0 to 0.5")?,
        torsion_hz: checked(table, "torsion_hz")?,
        torsion_hz_per_kpa: between(table, "torsion_hz_per_kpa", -1.0, 1.0, "-1 to 1 Hz per kPa")?,
        teeth: teeth(table)?,
    })
}

fn relative_sd(table: &Table<'_>, key: &'static str) -> Result<Option<f64>, Problem> {
    up_to(table, key, LARGEST_RELATIVE_SD, "a relative standard deviation from 0 to 1 (0.05 is 5 %)")
}

fn up_to(
    table: &Table<'_>,
    key: &'static str,
    largest: f64,
    expected: &'static str,
) -> Result<Option<f64>, Problem> {
    between(table, key, 0.0, largest, expected)
}

fn between(
    table: &Table<'_>,
    key: &'static str,
    lowest: f64,
    largest: f64,
    expected: &'static str,
) -> Result<Option<f64>, Problem> {
    match table.number(key)? {
        Some(value) if !(lowest..=largest).contains(&value) => {
            Err(table.refuse(ParameterError { name: key, value, expected }))
        }
        value => Ok(value),
    }
}

fn teeth(table: &Table<'_>) -> Result<Option<u32>, Problem> {
    let whole = between(table, "teeth", 2.0, 1_000.0, "a whole number from 2 to 1000")?;
    match whole {
        Some(value) if value.fract() != 0.0 => {
            let expected = "a whole number from 2 to 1000";
            Err(table.refuse(ParameterError { name: "teeth", value, expected }))
        }
        value => Ok(value.map(|value| value as u32)),
    }
}

fn word<T: Copy>(
    table: &Table<'_>,
    key: &'static str,
    known: [(&str, T); 3],
    expected: &'static str,
) -> Result<Option<T>, Problem> {
    let Some(text) = table.text(key)? else { return Ok(None) };
    let found = known.iter().find(|(label, _)| *label == text).map(|(_, value)| *value);
    found.map(Some).ok_or_else(|| table.unknown_value(key, &text, expected))
}
