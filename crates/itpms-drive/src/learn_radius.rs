//! How much a car's radii follow the pressure, `beta = d ln R / d ln p`, from drives of its wheel speeds at known pressures
//! (docs/math/wheel-speed.md, eq. 2a): each drive is a calibration of its own, and what differs between two is what their pressures did.

use std::ops::ControlFlow;

use itpms_core::model::Corner;
use itpms_core::monitor::MonitoredWheels;
use itpms_core::wheel_speed::RadiusCalibration;
use itpms_data::Vehicle;
use nalgebra::{Matrix3, Matrix3x4, Vector3, Vector4};

use crate::error::DriveError;
use crate::learn::{KnownDrive, by_sensors, no_pressure};
use crate::run::ROWS_PER_LOOK;
use crate::wheel_speeds::lacks;

/// Derivatives of the three ratios by each radius: front left over right, rear left over right, front over rear.
const SEEN: Matrix3x4<f64> = Matrix3x4::new(1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.5, 0.5, -0.5, -0.5);
/// Sd of a radius's own change from one drive to another; ln of a radius per ln of its load; and a front passenger's effect on the ratios.
const BY_ITSELF: f64 = 2e-4;
const PER_LN_LOAD: f64 = 6.4e-3;
const PASSENGER: [f64; 3] = [-3e-4, -2e-4, 2e-4];

/// The result of drives at known pressures of a car with wheel speeds alone.
#[derive(Debug, Clone)]
pub struct LearnedRadius {
    pub vehicle: Vehicle,
    /// `d ln R / d ln p` before and after, each with its standard deviation.
    pub before: [f64; 2],
    pub after: [f64; 2],
    pub concerns: Vec<String>,
}

/// Learns it from two drives or more, of which loads may have been others. Errors: a log without wheel speeds, one that teaches nothing,
/// fewer than two drives, a pressure that is not known, or the same pressures in all.
pub fn learn_radius(
    file: &Vehicle,
    drives: &[KnownDrive],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<LearnedRadius, DriveError> {
    let (drives, concerns) = by_sensors(file, drives, &mut |number| drives[number].open(), watch)?;
    let config = file.wheel_speed_config().map_err(|key| lacks(file, key))?;
    let beta = config.radius_per_ln_pressure;
    let before = [beta, (beta * config.radius_per_ln_pressure_sd).abs()];
    let (mut information, mut vector) = (before[1].powi(-2), beta * before[1].powi(-2));
    let prior = information;
    let mut first: Option<(RadiusCalibration<f64>, [f64; 4])> = None;
    for (number, drive) in drives.iter().enumerate() {
        let pressures = pressures(drive)?;
        let mut share = |share: f64| watch((number as f64 + share) / drives.len() as f64);
        let seen = calibrate(file, &config, drive, &mut share)?;
        let Some((other, other_kpa)) = &first else {
            first = Some((seen, pressures));
            continue;
        };
        let ln = Corner::ALL.map(|corner| (pressures[corner.index()] / other_kpa[corner.index()]).ln());
        let along = SEEN * Vector4::from(ln);
        let change = Vector3::from_fn(|i, _| 1e-3 * (seen.mean_1e3[i] - other.mean_1e3[i]));
        let spread = covariance(&seen, other, config.load.rear_axle);
        let Some(weighted) = spread.cholesky().map(|spread| spread.solve(&along)) else { continue };
        information += along.dot(&weighted);
        vector += change.dot(&weighted);
    }
    if drives.len() < 2 || !(information > 1.0001 * prior) {
        return Err(DriveError::Mismatch(
            "wheel speeds alone show how radii follow the pressure in two drives or more between which one tire, a side or an axle had another pressure; expected two logs with a --pressure-kpa each"
                .to_owned(),
        ));
    }
    let after = [vector / information, information.powf(-0.5)];
    let mut vehicle = file.clone();
    for corner in &mut vehicle.details.corners {
        corner.tire.radius_per_ln_pressure = Some(rounded(after[0]));
        corner.tire.radius_per_ln_pressure_sd = Some(rounded(after[1]));
    }
    vehicle.wheel_speed_config().map_err(|key| lacks(file, key))?;
    Ok(LearnedRadius { vehicle, before, after, concerns })
}

fn rounded(value: f64) -> f64 {
    (1e6 * value).round() * 1e-6
}

fn pressures(drive: &KnownDrive) -> Result<[f64; 4], DriveError> {
    let path = drive.log.display();
    for (corner, kpa) in Corner::ALL.into_iter().zip(drive.pressures_kpa) {
        let label = corner.label();
        let why = if kpa.is_nan() {
            Some(format!(
                "no pressure is given of {label}, and no tire sensor in the log sends a plausible one ({label}_tpms_kpa); expected --pressure-kpa for every wheel"
            ))
        } else {
            no_pressure(kpa).map(|why| format!("{label}: {why}"))
        };
        if let Some(why) = why {
            return Err(DriveError::Mismatch(format!("{path}: {why}")));
        }
    }
    Ok(drive.pressures_kpa)
}

/// The whole drive as a calibration.
fn calibrate(
    file: &Vehicle,
    config: &itpms_core::wheel_speed::WheelSpeedConfig<f64>,
    drive: &KnownDrive,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<RadiusCalibration<f64>, DriveError> {
    let mut log = drive.open()?;
    let mut wheels = Box::new(MonitoredWheels::unconfigured());
    wheels.configure(config)?;
    wheels.begin_calibration(1e8)?;
    let rolling_radius_m = file.rolling_radius_m().unwrap_or(f64::NAN);
    let mut count = 0u64;
    while let Some(row) = log.next_row()? {
        if count.is_multiple_of(ROWS_PER_LOOK) && watch(log.progress()).is_break() {
            return Err(DriveError::Stopped);
        }
        count += 1;
        wheels.update(&row.motion.sample(row.time_s, rolling_radius_m));
    }
    wheels.end_calibration();
    wheels.calibration().copied().ok_or_else(|| {
        DriveError::Log(format!(
            "{}: teaches nothing of the wheel speeds, expected some minutes of driving above 18 km/h on a dry road with the speeds of all four wheels",
            drive.log.display()
        ))
    })
}

/// Covariance of the difference of two drives: their own errors, loads, and the radii's own changes.
fn covariance(a: &RadiusCalibration<f64>, b: &RadiusCalibration<f64>, rear_load_sd: f64) -> Matrix3<f64> {
    let shapes = [[0.0, 0.0, PER_LN_LOAD * rear_load_sd], [0.0, 2.0 * PER_LN_LOAD * 0.03, 0.0], PASSENGER];
    Matrix3::from_fn(|i, j| {
        let loads: f64 = shapes.iter().map(|shape| shape[i] * shape[j]).sum();
        let shown = 1e-6 * (a.covariance_1e6[i][j] + b.covariance_1e6[i][j]);
        shown + loads + SEEN.row(i).dot(&SEEN.row(j)) * BY_ITSELF * BY_ITSELF
    })
}
