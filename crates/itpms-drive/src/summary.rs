//! The summary of a drive, as JSON and as text.

use itpms_analysis::report::{CornerReport, Reading, cold_text, found, unseen, wheel_line};
use itpms_core::model::{Corner, Level, PressureUnit, Warning};
use itpms_core::torsion::TorsionChange;
use itpms_core::wheel_speed::{SlowLeak, WheelRadius};
use itpms_data::out::{RadiusRow, state_label};
use serde_json::{Map, Value, json};

use crate::run::{Done, Fit};

/// Seconds before the end for which a reading counts as the one at the end.
const FRESH_S: f64 = 1.0;

/// The drive, its corners and what was reported: what `itpms estimate --json` prints, but for the names of its files.
pub fn summary_json(done: &Done, rows: u64) -> Map<String, Value> {
    let Done { data, alerts, concerns, .. } = done;
    let corner = |corner: &CornerReport| {
        let fit = done.fits[corner.corner.index()].as_ref();
        let mut value = corner_json(corner, fit);
        if done.has_temperature {
            value["cold"] = cold_json(corner);
        }
        (corner.corner.label().to_owned(), value)
    };
    let corners: Map<String, Value> = data.corners.iter().map(corner).collect();
    let not_estimated =
        done.not_estimated.iter().map(|(corner, why)| (corner.label().to_owned(), json!(why)));
    [
        ("vehicle", json!(data.provenance.vehicle)),
        ("estimator", json!(data.provenance.estimator)),
        ("duration_s", json!(data.drive.duration_s)),
        ("rate_hz", json!(data.drive.rate_hz)),
        ("distance_m", json!(data.drive.distance_m)),
        ("corners", Value::Object(corners)),
        ("not_estimated", Value::Object(not_estimated.collect())),
        ("wheel_speeds", json!(done.radii.as_ref().map(wheels_json))),
        ("torsion", json!(done.torsion.as_ref().map(torsion_json))),
        ("alerts", alerts.json()),
        ("rows", json!(rows)),
        ("warnings", json!(concerns)),
    ]
    .into_iter()
    .chain(done.beside.json())
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

/// The lines of all corners, as the command and the Python package show them, and of those of the vehicle file that were not estimated. `end_s`:
/// when the drive ended, by the clock of the readings.
pub fn corner_lines(done: &Done, end_s: f64) -> Vec<String> {
    let estimated =
        done.data.corners.iter().map(|corner| corner_line(corner, end_s, done.data.pressure_unit));
    let others = done.not_estimated.iter();
    estimated.chain(others.map(|(corner, why)| format!("{}  not estimated: {why}", corner.label()))).collect()
}

/// Each tire's change since the calibration by its tooth pulses; null where nothing was learned.
fn torsion_json(changes: &[Option<TorsionChange<f64>>; 4]) -> Value {
    let of = |(corner, change): (&Corner, &Option<TorsionChange<f64>>)| {
        let change = change.map(|TorsionChange { change_kpa, change_sd_kpa }| {
            json!({ "change_kpa": change_kpa, "change_sd_kpa": change_sd_kpa })
        });
        (corner.label().to_owned(), json!(change))
    };
    Value::Object(Corner::ALL.iter().zip(changes).map(of).collect())
}

/// The line of the tooth pulses, where they are read.
pub fn torsion_line(done: &Done, unit: PressureUnit) -> Option<String> {
    let of = |(corner, change): (&Corner, &Option<TorsionChange<f64>>)| match change {
        Some(TorsionChange { change_kpa, change_sd_kpa }) => {
            let [change, sd] = [change_kpa, change_sd_kpa].map(|kpa| unit.number(*kpa, 0));
            format!("{} {change} {unit} (sd {sd})", corner.label())
        }
        None => format!("{} unknown", corner.label()),
    };
    let wheels: Vec<String> = Corner::ALL.iter().zip(done.torsion.as_ref()?).map(of).collect();
    Some(format!("by the tooth pulses since the calibration {}", wheels.join(", ")))
}

/// The result of the wheel speeds at the end.
fn wheels_json(row: &RadiusRow) -> Value {
    let radii = &row.radii;
    let wheel = |corner: Corner| {
        let wheel = radii.wheels[corner.index()];
        let WheelRadius { change, change_sd, lost_share, lost_share_sd, low_probability, .. } = wheel;
        let value = json!({
            "radius_change": change,
            "radius_change_sd": change_sd,
            "lost_share": lost_share,
            "lost_share_sd": lost_share_sd,
            "low_probability": low_probability,
            "informed": wheel.informed(),
            "detectable_loss": wheel.detectable_loss_share,
            "state": state_label(row.states[corner.index()]),
        });
        (corner.label().to_owned(), value)
    };
    let wheels: Map<String, Value> = Corner::ALL.into_iter().map(wheel).collect();
    json!({
        "level": Level::OtherTires.label(),
        "found": found(radii),
        "wheels": wheels,
        "front_radius_difference": radii.difference[0],
        "rear_radius_difference": radii.difference[1],
        "axles_radius_difference": radii.difference[2],
        "radius_difference_sd": radii.difference_sd,
        "not_seen": unseen(radii),
        "days": (row.slow_leak.days > 0).then(|| json!({
            "days": row.slow_leak.days,
            "since_calibration_d": row.slow_leak.day,
            "slow_leak_probability": row.slow_leak.probability,
        })),
    })
}

/// The lines of the wheel speeds, as the command and the Python package show them: what is found, each wheel, what is not seen.
pub fn wheel_speed_lines(row: &RadiusRow) -> Vec<String> {
    let wheel = |corner: Corner| {
        let (state, wheel) = (state_label(row.states[corner.index()]), &row.radii.wheels[corner.index()]);
        format!("{}  {state}: {}", corner.label(), wheel_line(wheel))
    };
    let found = format!("by the wheel speeds {}", found(&row.radii));
    let wheels = Corner::ALL.into_iter().filter(|_| row.radii.difference[0].is_finite()).map(wheel);
    std::iter::once(found).chain(wheels).chain(unseen(&row.radii)).chain(days_line(&row.slow_leak)).collect()
}

fn days_line(leak: &SlowLeak<f64>) -> Option<String> {
    let (corner, probability) =
        Corner::ALL.into_iter().zip(leak.probability).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let days = format!("over {} days, {:.0} days after the calibration", leak.days, leak.day);
    (leak.days > 1).then(|| match probability {
        p if p > 0.5 => format!("{days}, {} loses air slowly with a probability of {p:.3}", corner.label()),
        p => format!("{days}, no slow leak ({}: probability {p:.3})", corner.label()),
    })
}

fn corner_json(corner: &CornerReport, fit: Option<&Fit>) -> Value {
    let figures = &corner.figures;
    let reading = |reading: Option<Reading>| {
        reading.map(|r| json!({ "time_s": r.time_s, "pressure_kpa": r.pressure_kpa, "sd_kpa": r.sd_kpa }))
    };
    json!({
        "placard_kpa": corner.placard_kpa,
        "last": reading(figures.last),
        "lowest": reading(figures.lowest),
        "warning": figures.warning.label(),
        "state": state_label(corner.state),
        "doubt": corner.doubt(),
        "low_since_s": figures.low_since_s,
        "malfunction_since_s": figures.malfunction_since_s,
        "share_valid": figures.share_valid,
        "truth": figures.truth.filter(|_| figures.last.is_some()).map(|t| json!({
            "rmse_kpa": t.rmse_kpa,
            "bias_kpa": t.bias_kpa,
            "coverage": t.coverage,
            "settle_s": t.settle_s,
        })),
        "tire_sensor": corner.tire_sensor.map(|sensor| json!({
            "time_s": sensor.time_s,
            "pressure_kpa": sensor.pressure_kpa,
            "contradicts_since_s": sensor.contradicts_since_s,
        })),
        "fit": fit.map(fit_json),
        "road": corner.road.as_ref().map(|road| json!({
            "iri_m_per_km": road.iri_m_per_km,
            "truth_iri_m_per_km": road.truth_iri_m_per_km,
            "relative_error": road.relative_error,
        })),
    })
}

/// The tire's cold pressure, and the pressure to add.
fn cold_json(corner: &CornerReport) -> Value {
    let Some(cold) = corner.figures.cold else { return json!({ "state": "unknown" }) };
    let add_kpa = cold.air_to_add_kpa(corner.placard_kpa);
    json!({
        "pressure_kpa": cold.pressure_kpa,
        "sd_kpa": cold.sd_kpa,
        "ambient_temperature_c": cold.ambient_temperature_c,
        "add_kpa": add_kpa,
        "state": if add_kpa.is_some() { "add" } else { "fine" },
    })
}

/// How well body and wheel go together, and what does not.
pub(crate) fn fit_json((fit, misfit): &Fit) -> Value {
    json!({
        "incoherence": fit.incoherence,
        "unexplained": fit.unexplained,
        "hop_excess": fit.hop_excess,
        "response_error": fit.response_error,
        "friction_n": fit.friction_n,
        "misfit": misfit.map(|misfit| misfit.to_string()),
    })
}

/// A corner in a line: the last pressure that was valid; where that is not now, since
/// when; what was warned of; why it is not known. `end_s`: when the drive ended, by the clock of the readings.
fn corner_line(corner: &CornerReport, end_s: f64, unit: PressureUnit) -> String {
    let figures = &corner.figures;
    let mut line = format!("{}  ", corner.corner.label());
    line += &match figures.last {
        Some(Reading { pressure_kpa, sd_kpa, time_s }) => {
            let old = end_s - time_s > FRESH_S;
            let when = if old { format!(" at {time_s:.1} s, nothing valid since") } else { String::new() };
            format!("{} {unit}, sd {}{when}", unit.number(pressure_kpa, 1), unit.number(sd_kpa, 1))
        }
        None => "no valid estimate".to_owned(),
    };
    line += &match unit {
        PressureUnit::Kpa => format!(" (placard {})", corner.placard_kpa),
        _ => format!(" (placard {})", unit.number(corner.placard_kpa, 0)),
    };
    if let Some(cold) = figures.cold {
        let (at, add) = cold_text(&cold, corner.placard_kpa, unit);
        line += &format!("; {at}{}", add.map_or_else(String::new, |add| format!(": {add}")));
    }
    if let Some(sensor) = corner.tire_sensor {
        line += &format!("; its sensor {}", unit.number(sensor.pressure_kpa, 0));
    }
    if let Some(reported_s) = figures.low_since_s {
        let now = if figures.warning == Warning::Low { "" } else { ", now over" };
        line += &format!("; LOW, warned of at {reported_s:.1} s{now}");
    }
    if let Some(reported_s) = figures.malfunction_since_s {
        line += &format!("; MALFUNCTION, warned of at {reported_s:.1} s");
    }
    // A pressure alone looks as good as that of a wheel that is known to be fine.
    if let Some(why) = corner.doubt() {
        line += &format!("; {}: {why}", state_label(corner.state));
    }
    // Before anything is known there is nothing to be right or wrong about.
    if let Some(truth) = figures.truth.as_ref().filter(|_| figures.last.is_some()) {
        line += &format!(
            "; against the truth after {} s: RMSE {} {unit}, bias {:+}, {:.0} % inside the 95 % interval",
            truth.settle_s,
            unit.number(truth.rmse_kpa, 1),
            unit.number(truth.bias_kpa, 1),
            100.0 * truth.coverage
        );
    }
    line
}
