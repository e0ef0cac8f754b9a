//! The car's state as a snapshot. Called by the engine; decides nothing.

use itpms_core::model::{Corner, Level};
use itpms_core::warning::{Cause, Doubt, MonitorReport, WheelState};
use itpms_data::Vehicle;
use itpms_data::log::{Field, Slot};
use itpms_data::out::alert_object;
use serde_json::{Map, Value};

use crate::drive::LiveDrive;
use crate::snapshot::{SensorHealth, Track, Wheel};

/// The wheels of a drive, in the order of [`Corner::ALL`].
pub(crate) fn wheels(drive: &LiveDrive, vehicle: &Vehicle) -> Vec<Wheel> {
    if drive.clock.corners.is_empty() {
        return Corner::ALL.into_iter().filter_map(|corner| rolling(drive, vehicle, corner)).collect();
    }
    drive.clock.corners.iter().filter_map(|corner| wheel(drive, vehicle, *corner)).collect()
}

/// A wheel of which the speed alone is known: no pressure.
fn rolling(drive: &LiveDrive, vehicle: &Vehicle, corner: Corner) -> Option<Wheel> {
    let radius = drive.drive.radii()?.radii.wheels[corner.index()];
    let report = drive.report().wheels[corner.index()]?;
    let (nan, placard_kpa) = (f64::NAN, vehicle.placard_kpa(corner).unwrap_or(f64::NAN));
    Some(Wheel {
        corner: corner.label(),
        state: report.state.label(),
        doubt: doubt(report.state),
        pressure_kpa: nan,
        pressure_sd_kpa: nan,
        change_sd_kpa: nan,
        lost_kpa: known(radius.lost_share * placard_kpa),
        lost_sd_kpa: known(radius.lost_share_sd * placard_kpa),
        lost_share: known(radius.lost_share),
        lost_share_sd: known(radius.lost_share_sd),
        detectable_loss: known(radius.detectable_loss_share),
        level: Level::OtherTires.label(),
        stiffness_n_per_m: nan,
        reference_kpa: placard_kpa,
        placard_kpa,
        warning: report.warning.label(),
        gate: nan,
        informed_age_s: drive.time_s() - report.informed_s,
        road_m: nan,
        iri_m_per_km: nan,
        tire_sensor_kpa: known(drive.beside.sent_kpa()[corner.index()]),
        ..Wheel::default()
    })
}

fn known(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

/// Why a wheel is not known, if it is not.
fn doubt(state: WheelState) -> Option<&'static str> {
    match state {
        WheelState::Unknown(doubt) => Some(doubt.label()),
        _ => None,
    }
}

fn wheel(drive: &LiveDrive, vehicle: &Vehicle, corner: Corner) -> Option<Wheel> {
    let i = corner.index();
    let estimate = drive.latest.as_ref()?.corners[i]?;
    let placard_kpa = vehicle.corner(corner).map_or(f64::NAN, |config| config.placard_kpa);
    // A published filter has no monitor's word: its wheel is unknown.
    let report = drive.report().wheels[i];
    let state = report.map_or(WheelState::Unknown(Doubt::Starting), |report| report.state);
    Some(Wheel {
        corner: corner.label(),
        state: state.label(),
        doubt: doubt(state),
        pressure_kpa: estimate.pressure_kpa,
        pressure_sd_kpa: estimate.pressure_sd_kpa,
        change_sd_kpa: estimate.change_sd_kpa,
        axle_difference_sd_kpa: estimate.axle_difference_sd_kpa,
        lost_kpa: known(estimate.lost_kpa()[0]),
        lost_sd_kpa: known(estimate.lost_kpa()[1]),
        cold_pressure_kpa: estimate.cold.and_then(|cold| known(cold.pressure_kpa)),
        cold_pressure_sd_kpa: estimate.cold.and_then(|cold| known(cold.sd_kpa)),
        ambient_temperature_c: estimate.cold.and_then(|cold| known(cold.ambient_temperature_c)),
        cold_add_kpa: estimate
            .cold
            .filter(|_| estimate.validity.is_valid())
            .and_then(|cold| cold.air_to_add_kpa(placard_kpa)),
        lost_share: None,
        lost_share_sd: None,
        detectable_loss: None,
        level: estimate.level.label(),
        stiffness_n_per_m: estimate.stiffness_n_per_m,
        reference_kpa: report.map_or(placard_kpa, |report| report.reference_kpa),
        placard_kpa,
        valid: estimate.validity.is_valid(),
        warning: estimate.warning.label(),
        gate: estimate.diagnostics.gate,
        informed_age_s: report.map_or(f64::NAN, |report| drive.time_s() - report.informed_s),
        road_m: estimate.road_m,
        iri_m_per_km: drive.roughness.iri_m_per_km[i],
        tire_sensor_kpa: known(drive.beside.sent_kpa()[i]),
    })
}

pub(crate) fn tracks(drive: &LiveDrive) -> Vec<Track> {
    let Some(estimate) = &drive.latest else { return Vec::new() };
    let sides =
        [("left", [Corner::FrontLeft, Corner::RearLeft]), ("right", [Corner::FrontRight, Corner::RearRight])];
    let measured = sides.into_iter().zip(&estimate.tracks);
    measured
        .filter(|((_, corners), _)| corners.iter().all(|corner| drive.clock.corners.contains(corner)))
        .map(|((side, _), track)| Track { side, shared: track.shared, incoherence: track.incoherence })
        .collect()
}

pub(crate) fn alerts(drive: &LiveDrive) -> Vec<Map<String, Value>> {
    let beside = drive.beside.standing.iter().cloned();
    drive.report().alerts().map(alert_object).chain(beside).collect()
}

/// Both accelerometers of every corner. A malfunction that names none of its sensors is one of all it could be.
pub(crate) fn sensors(drive: &LiveDrive) -> Vec<SensorHealth> {
    let corners = drive.clock.corners.iter();
    let both = corners.flat_map(|corner| [(*corner, Field::BodyAccel), (*corner, Field::WheelAccel)]);
    both.map(|(corner, field)| sensor(drive.report(), corner, field)).collect()
}

fn sensor(report: &MonitorReport<f64>, corner: Corner, field: Field) -> SensorHealth {
    let column = Slot::Corner(corner, field).name();
    for alert in report.alerts_of(corner) {
        let Cause::Malfunction(malfunction) = &alert.cause else { continue };
        let named = alert_object(alert).remove("sensors");
        let named: Vec<&str> =
            named.iter().flat_map(|list| list.as_array()).flatten().filter_map(Value::as_str).collect();
        if named.is_empty() || named.contains(&column.as_str()) {
            return SensorHealth { column, state: "malfunction", reason: Some(malfunction.to_string()) };
        }
    }
    let suspect = report.wheels[corner.index()]
        .is_some_and(|wheel| wheel.state == WheelState::Unknown(Doubt::Suspicion));
    match suspect {
        true => {
            let reason = Some("looks wrong, not for long enough to say so".to_owned());
            SensorHealth { column, state: "suspect", reason }
        }
        false => SensorHealth { column, state: "fine", reason: None },
    }
}
