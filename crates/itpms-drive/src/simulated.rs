//! Simulated drives as logs hold them, and what an estimator is to know of the simulated car.
//!
//! Called by whoever simulates a drive to have it estimated; simulation and logs do not know each other.

use std::path::PathBuf;

use itpms_analysis::roughness::EvenProfile;
use itpms_core::model::Corner;
use itpms_data::crg::CrgRoad;
use itpms_data::log::{CornerColumns, LogColumns, LogCorner, LogMotion, MotionColumns};
use itpms_data::vehicle::{Driven, VehicleDetails};
use itpms_data::{LogRow, Vehicle};
use itpms_sim::road::Surface;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::wheel_speeds::{DrivenWheels, WheelSpeedRow};

use crate::error::DriveError;

/// Puts the points of an OpenCRG road in the place of its file: the simulation reads text only. The road is that along
/// the reference line, holes up to 0.25 m bridged. Errors: the road cannot be read, or has longer holes.
pub fn take_crg(scenario: &mut Scenario) -> Result<(), DriveError> {
    let Surface::Profile(profile) = &mut scenario.road.surface else { return Ok(()) };
    let is_crg =
        |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("crg"));
    let Some(path) = profile.file.take_if(|path| is_crg(path)) else { return Ok(()) };
    let road = CrgRoad::read(&path)?;
    let refuse = |why: String| DriveError::Mismatch(format!("{}: {why}", path.display()));
    let line_m = road.line_m(0.0).map_err(|error| refuse(error.to_string()))?;
    let even = EvenProfile::of_even(road.start_m(), road.increment_m(), line_m);
    if even.heights_m.iter().any(|height_m| !height_m.is_finite()) {
        return Err(refuse(
            "the reference line has holes of more than 0.25 m, expected a height in every row".to_owned(),
        ));
    }
    let station = |i: usize| even.start_m + i as f64 * even.spacing_m;
    profile.points_m =
        even.heights_m.iter().enumerate().map(|(i, height_m)| [station(i), *height_m]).collect();
    Ok(())
}

/// A simulated row as a log holds it: the pressure is the reference sensor's where the scenario has one, the road's
/// truth the profile under the axle.
pub fn log_row(row: &SimRow) -> LogRow {
    LogRow {
        time_s: row.time_s,
        speed_m_s: row.speed_m_s,
        corners: row.corners.map(|corner| {
            corner.map(|c| LogCorner {
                body_accel_m_s2: c.body_accel_m_s2,
                wheel_accel_m_s2: c.wheel_accel_m_s2,
                pressure_kpa: c.pressure_reading_kpa,
                road_m: c.road_m,
            })
        }),
        motion: row.wheel_speeds.as_ref().map_or(LogMotion::UNKNOWN, motion),
    }
}

fn motion(row: &WheelSpeedRow) -> LogMotion {
    LogMotion {
        wheel_speed_m_s: row.wheel_speed_m_s,
        yaw_rate_rad_s: row.yaw_rate_rad_s,
        accel_x_m_s2: row.accel_x_m_s2,
        accel_y_m_s2: row.accel_y_m_s2,
        brake: row.brake,
        ..LogMotion::UNKNOWN
    }
}

/// The columns of a scenario's log, with this truth of each corner that has accelerations.
pub fn columns(scenario: &Scenario, truth: CornerColumns) -> LogColumns {
    let wheels = scenario.wheel_speeds.as_ref();
    let accelerations = !wheels.is_some_and(|wheels| wheels.alone);
    LogColumns {
        speed: true,
        corners: Corner::ALL
            .map(|corner| scenario.corner.get(corner).filter(|_| accelerations).map(|_| truth)),
        motion: wheels.map_or_else(MotionColumns::default, |wheels| MotionColumns {
            wheel_speed: true,
            yaw_rate: wheels.yaw_rate,
            accel_x: wheels.accel_x,
            accel_y: wheels.accel_y,
            brake: wheels.brake,
            ..MotionColumns::default()
        }),
    }
}

/// The scenario driven with another vehicle. Errors: the vehicle lacks a corner that the scenario drives.
pub fn take_vehicle(scenario: &mut Scenario, vehicle: &Vehicle) -> Result<(), DriveError> {
    for corner in Corner::ALL {
        let Some(spec) = scenario.corner.get_mut(corner) else { continue };
        let config = vehicle.corner(corner).ok_or_else(|| {
            DriveError::Mismatch(format!(
                "the vehicle {:?} has no corner {}, which the scenario {} drives",
                vehicle.name,
                corner.label(),
                scenario.name
            ))
        })?;
        spec.set_vehicle(config);
    }
    if let Some(wheelbase_m) = vehicle.wheelbase_m {
        scenario.wheelbase_m = wheelbase_m;
    }
    Ok(())
}

/// The vehicle file for a scenario's car. Errors: the scenario's corners are no car's.
pub fn vehicle_of(scenario: &Scenario) -> Result<Vehicle, DriveError> {
    let corners = scenario.car_config()?.corners;
    let mut details = VehicleDetails { confidence: scenario.confidence, ..VehicleDetails::default() };
    if let (Some(wheels), Some(car)) = (&scenario.wheel_speeds, &scenario.car) {
        (details.track_front_m, details.track_rear_m) = (Some(car.track_front_m), Some(car.track_rear_m));
        details.driven = Some(match wheels.driven {
            DrivenWheels::Front => Driven::Front,
            DrivenWheels::Rear => Driven::Rear,
            DrivenWheels::All => Driven::All,
        });
        details.limited_slip = wheels.locking_n > 0.0 || wheels.locking_share > 0.0;
        for (corner, spec) in scenario.corner.iter() {
            details.corners[corner.index()].tire.rolling_radius_m = Some(spec.truth.rolling_radius_m);
        }
    }
    Ok(Vehicle {
        name: format!("vehicle of {}", scenario.name),
        id: None,
        learned: None,
        wheelbase_m: Some(scenario.wheelbase_m),
        corners,
        details,
    }
    .with_details(details))
}

/// Refuses a drive that has diverged. Errors: from when on its accelerations are no car's.
pub fn check(scenario: &Scenario, simulation: &Simulation) -> Result<(), DriveError> {
    if let Some(time_s) = simulation.diverged_s() {
        return Err(DriveError::Mismatch(format!(
            "{}: from {time_s:.3} s on the car's accelerations are no numbers, or absurd: expected masses, springs, dampers and tires of a car",
            scenario.name
        )));
    }
    Ok(())
}
