//! Caveats of a result, as sentences.

use itpms_analysis::report::ReportData;
use itpms_core::conditioning::SAMPLE_RATES_HZ;
use itpms_core::model::{Corner, Level, Misfit};
use itpms_core::wheel_speed::RadiusState;
use itpms_data::log::{Field, Slot};
use itpms_data::out::WheelSpeedUse;
use itpms_data::signals::doubt_of;
use itpms_data::{LogReader, Vehicle};
use itpms_paper::EstimatorKind;

use crate::drive::Drive;
use crate::error::DriveError;
use crate::job::Job;
use crate::settings::LOG_END_S;
use crate::wheel_speeds::{lacking, wheel_speed_use};

/// Logarithm of pressure over placard from which on no one fills all tires otherwise.
const ANOTHER_CAR: f64 = 0.26;
/// Seconds of driving that a calibration should have.
const SHORTEST_CALIBRATION_S: f64 = 10.0;
/// Standard deviations by which the spectra have to contradict a calibration.
const CONTRADICTION_SDS: f64 = 2.5;
/// Standard deviation in kPa of the level from which on a calibration is asked for: a fifth of a tire is some 50.
const ASK_KPA: f64 = 10.0;

/// The corners that the log has measured and the vehicle file describes; none where wheel speeds are all that both have.
/// Errors: there is none, or the accelerations are sampled too slowly.
pub fn common_corners(log: &LogReader, vehicle: &Vehicle) -> Result<Vec<Corner>, DriveError> {
    let measured = log.columns().present();
    let common: Vec<Corner> = measured.iter().copied().filter(|c| vehicle.corner(*c).is_some()).collect();
    if common.is_empty() && log.columns().motion.wheel_speeds() {
        return match wheel_speed_use(log.columns(), vehicle, &common) {
            Ok(_) => Ok(common),
            Err(key) => {
                Err(DriveError::Mismatch(format!("{}: {}", log.path().display(), lacking(vehicle, key))))
            }
        };
    }
    if common.is_empty() {
        let described = Corner::ALL.into_iter().filter(|c| vehicle.corner(*c).is_some()).collect::<Vec<_>>();
        if described.is_empty() {
            return Err(DriveError::Mismatch(format!(
                "{}: has accelerations, and the vehicle {:?} is for wheel speeds alone: expected a vehicle file with masses, springs and dampers (itpms vehicle init --mass and --front-share writes one), or the four wheel speeds in the log",
                log.path().display(),
                vehicle.name
            )));
        }
        return Err(DriveError::Mismatch(format!(
            "{} has the corners {}, but the vehicle {:?} describes {}",
            log.path().display(),
            labels(&measured),
            vehicle.name,
            labels(&described)
        )));
    }
    if !SAMPLE_RATES_HZ.contains(&log.survey().estimator_rate_hz()) {
        return Err(DriveError::Log(format!(
            "{}: sampled at {:.1} Hz, expected 100 Hz to 2 kHz: slower accelerations do not show how a wheel hops, and no pressure can be estimated",
            log.path().display(),
            log.survey().sample_rate_hz
        )));
    }
    if let Some(why) = one_sensor_twice(log, &common) {
        return Err(DriveError::Log(format!("{}: {why}", log.path().display())));
    }
    Ok(common)
}

/// Two corners with one sensor: those across are wrong, too. Where one body sensor serves all corners, they are found not to fit.
fn one_sensor_twice(log: &LogReader, common: &[Corner]) -> Option<String> {
    let same = |field: Field| {
        let of = |corner: &Corner| Slot::Corner(*corner, field).name();
        let names: Vec<String> = common.iter().map(of).collect();
        let twice =
            log.repairs().same_columns.iter().filter(move |(a, b)| names.contains(a) && names.contains(b));
        twice.cloned().collect::<Vec<_>>()
    };
    let (wheels, bodies) = (same(Field::WheelAccel), same(Field::BodyAccel));
    let all = common.len() * common.len().saturating_sub(1) / 2;
    let (a, b) = wheels.first().or_else(|| bodies.first().filter(|_| bodies.len() < all))?;
    Some(format!(
        "{a} and {b} have the same values: expected a sensor at each corner (one signal logged twice, or copied?)"
    ))
}

fn labels(corners: &[Corner]) -> String {
    corners.iter().map(|corner| corner.label()).collect::<Vec<_>>().join(" ")
}

fn of_wheel_speeds(job: &Job<'_>, log: &LogReader, drive: &Drive) -> Option<String> {
    let (vehicle, settings) = (job.vehicle, job.settings);
    let wheel_speeds = match wheel_speed_use(log.columns(), vehicle, job.corners) {
        Err(key) => return Some(format!("the wheel speeds are not used: {}", lacking(vehicle, key))),
        Ok(wheel_speeds) => wheel_speeds,
    };
    let uncalibrated =
        matches!(drive.radii()?.radii.state, RadiusState::Uncalibrated | RadiusState::Calibrating);
    match (settings.calibrate_s, &settings.reference) {
        (Some(seconds), _) if drive.length_s() + LOG_END_S < seconds => Some(format!(
            "the calibration of {seconds} s outlasts the drive of {:.1} s: no wheel speed was compared with anything",
            drive.length_s()
        )),
        (Some(seconds), _) if drive.calibrated_on_snow() => Some(format!(
            "the calibration of {seconds} s taught nothing of the wheel speeds: the driven wheels slipped more than on any dry road, as on snow; calibrate on a dry one"
        )),
        (Some(seconds), _) if uncalibrated => Some(format!(
            "the calibration of {seconds} s taught nothing of the wheel speeds, expected 10 s or more of driving above 18 km/h without brakes and sharp bends, with a yaw rate where a limited slip couples the wheels"
        )),
        (None, None) if wheel_speeds == WheelSpeedUse::Alone => Some(
            "never calibrated: wheel speeds show how tires differ from the others since a calibration (--calibrate-s, --reference); without one nothing is known"
                .to_owned(),
        ),
        _ => None,
    }
}

/// From this standard deviation in kPa of a wheel's reading by its pulses on, a calibration has taught as good as nothing of them.
const TAUGHT_LITTLE_KPA: f64 = 20.0;

/// The wheels of whose tooth pulses a calibration has taught nothing, or too little.
fn of_pulses(job: &Job<'_>, drive: &Drive) -> Vec<String> {
    let calibrated = job.settings.pulses.is_some() && job.settings.calibrate_s.is_some();
    let learned = drive.learned();
    let Ok((configs, _)) = job.vehicle.torsion_config() else { return Vec::new() };
    if !calibrated || learned.wheel_speeds.is_none() {
        return Vec::new();
    }
    let mut concerns = Vec::new();
    for ((corner, learned), config) in Corner::ALL.into_iter().zip(&learned.torsion).zip(&configs) {
        let sd_kpa =
            learned.as_ref().map(|(learned, _)| learned.resonance_sd_hz() / config.resonance_per_kpa.abs());
        let taught = match sd_kpa {
            Some(sd_kpa) if sd_kpa > TAUGHT_LITTLE_KPA => {
                format!("little of its tooth pulses, which read its pressure to {sd_kpa:.0} kPa")
            }
            Some(_) => continue,
            None => "nothing of its tooth pulses, which will show no loss of it".to_owned(),
        };
        concerns.push(format!(
            "{}: the calibration taught {taught}: calibrate for half an hour, at 50 to 100 km/h on ordinary roads",
            corner.label()
        ));
    }
    concerns
}

/// The tires' own sensors that contradict the estimate for good.
pub(crate) fn of_tire_sensors(data: &ReportData) -> impl Iterator<Item = String> + '_ {
    data.corners.iter().filter_map(|corner| {
        let last = corner.figures.last?;
        let words = corner.tire_sensor?.contradiction(last.pressure_kpa, last.sd_kpa, data.pressure_unit)?;
        Some(format!("{}: {words}", corner.corner.label()))
    })
}

/// All tires of a car that was never calibrated are above or below their placards: the file is another car's.
pub(crate) fn of_level(data: &ReportData) -> Option<String> {
    let shares = data.corners.iter().map(|corner| {
        let by_file = corner.level == Some(Level::VehicleFile);
        Some(corner.figures.last.filter(|_| by_file)?.pressure_kpa / corner.placard_kpa)
    });
    let shares: Vec<f64> = shares.collect::<Option<_>>()?;
    let off = |share: &f64| share.ln().abs() > ANOTHER_CAR && share.ln().signum() == shares[0].ln().signum();
    (shares.len() > 1 && shares.iter().all(off)).then(|| {
        format!(
            "by the vehicle file alone every tire reads {:.2} of its placard pressure: masses or tires of another car? (itpms vehicle check; a calibration, --calibrate-s, sets the level)",
            shares.iter().sum::<f64>() / shares.len() as f64
        )
    })
}

/// The corners of the vehicle file that are not in the log, each with the reason, as the end of "it is".
pub(crate) fn not_estimated(job: &Job<'_>, log: &LogReader) -> Vec<(Corner, String)> {
    if job.corners.is_empty() {
        return Vec::new();
    }
    let present = log.columns().present();
    let absent = |corner: &Corner| job.vehicle.corner(*corner).is_some() && !present.contains(corner);
    let of = |corner: Corner| {
        let doubt = doubt_of(corner, log.mapping()).map_or_else(String::new, |doubt| format!(": {doubt}"));
        (corner, format!("not in the log{doubt}"))
    };
    Corner::ALL.into_iter().filter(absent).map(of).collect()
}

/// The caveats of a result.
pub(crate) fn of(job: &Job<'_>, log: &LogReader, drive: &Drive) -> Vec<String> {
    let (vehicle, settings) = (job.vehicle, job.settings);
    let unit = settings.pressure_unit;
    let mut concerns = log.repairs().warnings();
    concerns.extend(of_wheel_speeds(job, log, drive));
    concerns.extend(of_pulses(job, drive));
    concerns.extend(drive.yaw_fault().map(|fault| format!("yaw_rate_rad_s {fault}")));
    if job.corners.is_empty() {
        return concerns;
    }
    let present = log.columns().present();
    for corner in present.iter().filter(|corner| vehicle.corner(**corner).is_none()) {
        concerns.push(format!("corner {} is not in the vehicle file and was not estimated", corner.label()));
    }
    for (corner, why) in not_estimated(job, log) {
        concerns.push(format!("corner {} of the vehicle file is {why}", corner.label()));
    }
    let rate = log.survey().sample_rate_hz;
    if !SAMPLE_RATES_HZ.contains(&rate) {
        concerns.push(format!("sampled at {rate:.1} Hz, expected 100 Hz to 2 kHz: less accurate"));
    }
    let both =
        |front, rear| [front, rear].iter().all(|c| present.contains(c) && vehicle.corner(*c).is_some());
    let axles = both(Corner::FrontLeft, Corner::RearLeft) || both(Corner::FrontRight, Corner::RearRight);
    if axles && settings.estimator == EstimatorKind::Informed {
        let alone =
            "so front and rear cannot be held against each other: less accurate, every wheel is by itself";
        if !log.columns().speed {
            concerns.push(format!("no speed_m_s, {alone}"));
        }
        if vehicle.wheelbase_m.is_none() {
            concerns.push(format!("the vehicle file has no wheelbase_m, {alone}"));
        }
        if let Some(share) = drive.speed_unknown().filter(|_| log.columns().speed) {
            concerns.push(format!(
                "speed_m_s is unknown for {:.0} % of the time (a value goes on for half a second), and for as long every wheel is by itself: less accurate",
                100.0 * share
            ));
        } else if drive.never_met() && log.columns().speed && vehicle.wheelbase_m.is_some() {
            concerns.push(
                "front and rear were never found to meet the same road, so every wheel is by itself: speed_m_s in another unit, another wheelbase_m, wheels confused, or too many values missing?"
                    .to_owned(),
            );
        }
    }
    // A log that ends with its calibration is what a calibration is.
    if let Some(seconds) = settings.calibrate_s.filter(|seconds| drive.length_s() + LOG_END_S < *seconds) {
        concerns.push(format!(
            "the calibration of {seconds} s outlasts the drive of {:.1} s: every pressure is the placard's because it was given, not because it was found",
            drive.length_s()
        ));
    }
    if let Some(seconds) = settings.calibrate_s.filter(|seconds| *seconds < SHORTEST_CALIBRATION_S) {
        concerns.push(format!(
            "a calibration of {seconds} s teaches little of the car, expected {SHORTEST_CALIBRATION_S} s or more of driving"
        ));
    }
    if let Some([excess_kpa, sd_kpa]) = drive.calibration_excess_kpa()
        && excess_kpa.abs() > CONTRADICTION_SDS * sd_kpa
    {
        let way = if excess_kpa > 0.0 { "more" } else { "less" };
        concerns.push(format!(
            "during the calibration the road's spectra read {} {unit} {way} than the placard's pressures (sd {}): were the tires set to them? All pressures since rest on that",
            unit.number(excess_kpa.abs(), 0),
            unit.number(sd_kpa, 0)
        ));
    }
    let level_sd_kpa = vehicle.level_sd_kpa(job.corners);
    let calibrated = settings.calibrate_s.is_some() || settings.reference.is_some();
    if settings.estimator == EstimatorKind::Informed && !calibrated && level_sd_kpa > ASK_KPA {
        concerns.push(format!(
            "never calibrated: the level of all pressures rests on the vehicle file and is known to {} {unit}; calibrate the car with its tires at placard pressure to know it better",
            unit.number(level_sd_kpa, 0)
        ));
    }
    for (corner, misfit) in drive.misfits() {
        let what = match misfit {
            Misfit::PartlyUnexplained => "its standard deviation is larger for that",
            Misfit::Hop if calibrated => "its standard deviation is larger for that",
            _ => "its pressure is not valid",
        };
        concerns.push(format!("corner {}: {misfit}; {what}", corner.label()));
    }
    if let Some(seconds) = drive.speed_latency_s() {
        let way = if seconds > 0.0 { "late" } else { "early" };
        concerns.push(format!(
            "speed_m_s comes {:.2} s {way}: while the car brakes or speeds up front and rear do not meet the same road where it says; allowed for since that was found",
            seconds.abs()
        ));
    }
    if let Some((rows, first)) = drive.absurd_speeds() {
        concerns.push(format!(
            "{rows} rows have a speed_m_s that no car has, the first {first:e}; they count as rows without one"
        ));
    }
    if let Some(seconds) = drive.denied_s() {
        concerns.push(format!(
            "for {seconds:.1} s speed_m_s says that the car stands while its wheels roll; it was taken as unknown, and for as long every wheel is by itself: less accurate. Has the signal failed?"
        ));
    }
    let alone = !axles || vehicle.wheelbase_m.is_none();
    if settings.calibrate_s.is_some() && settings.estimator == EstimatorKind::Informed && alone {
        concerns.push(
            "the calibration teaches nothing that lasts unless the road repeats itself: what it teaches is of front and rear over the same road"
                .to_owned(),
        );
    }
    if let Some(path) = settings.reference.as_ref().filter(|_| alone) {
        concerns.push(format!(
            "{}: without effect: what a calibration teaches is of front and rear over the same road",
            path.display()
        ));
    }
    if settings.estimator.is_as_published() {
        let label = settings.estimator.label();
        concerns.push(format!(
            "{label} as published cannot find the stiffness: its pressure says nothing about the tire"
        ));
    }
    concerns
}
