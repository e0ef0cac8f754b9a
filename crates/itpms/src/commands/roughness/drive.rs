//! Tracks from a drive log: the road under every wheel, estimated as `itpms estimate` does.

use std::path::Path;

use itpms_console::{Failure, Interrupt, Screen};
use itpms_core::model::Corner;
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_data::log::PositionColumns;
use itpms_data::{LogReader, Vehicle};
use itpms_drive::{RoadSurvey, RoadTrack, common_corners};

use super::Found;
use crate::args::RoughnessArgs;
use crate::commands::ROWS_PER_LOOK;

pub(super) fn survey(
    args: &RoughnessArgs,
    vehicle: &Path,
    screen: &Screen,
    interrupt: &Interrupt,
) -> Result<Found, Failure> {
    let vehicle = Vehicle::read(vehicle)?;
    let mut log = LogReader::open_with(&args.input, &args.reading.options())?;
    if !log.columns().speed && args.speed_m_s.is_none() {
        let path = args.input.display();
        return Err(Failure::Usage(format!("{path}: no speed_m_s, so no distance: expected --speed-m-s V")));
    }
    let wants_map = args.geojson.is_some() || args.map.is_some();
    if wants_map && log.columns().motion.position == PositionColumns::Absent {
        let path = args.input.display();
        return Err(Failure::Usage(format!(
            "{path}: no latitude_deg and longitude_deg, so no map: expected both columns, or a map that names them (--signals)"
        )));
    }
    let corners = common_corners(&log, &vehicle)?;
    let rate_hz = log.survey().estimator_rate_hz();
    let mut car = estimator(&vehicle, &corners, rate_hz)?;
    let mut road = RoadTrack::new(&vehicle, &corners, rate_hz)?;
    let survey = RoadSurvey::new(args.segment_m, &corners, rate_hz);
    let mut survey = survey.map_err(|error| Failure::Usage(error.to_string()))?;

    let progress = screen.progress("estimating the road");
    let (mut count, mut denied) = (0u64, 0u64);
    while let Some(mut row) = log.next_row()? {
        if count.is_multiple_of(ROWS_PER_LOOK) {
            interrupt.check()?;
            progress.set(log.progress());
        }
        count += 1;
        if let (false, Some(speed)) = (row.speed_m_s.is_finite(), args.speed_m_s) {
            row.speed_m_s = speed;
        }
        let estimate = car.update(&row.sample());
        if car.denies_standstill() {
            row.speed_m_s = args.speed_m_s.unwrap_or(f64::NAN);
            denied += 1;
        }
        road.push(&row, &estimate.corners, &car.estimator().quarter_cars());
        while let Some(late) = road.pop() {
            survey.take(&late);
        }
    }
    road.finish();
    while let Some(late) = road.pop() {
        survey.take(&late);
    }
    drop(progress);

    if !(survey.distance_m() > 0.0) {
        let path = args.input.display();
        let expected = "expected speeds above zero, or --speed-m-s V";
        return Err(Failure::Usage(format!(
            "{path}: speed_m_s never says that the car moves, so no distance: {expected}"
        )));
    }
    let about = format!("road under {} wheels, {:.1} m driven", corners.len(), survey.distance_m());
    let mut warnings = log.repairs().warnings();
    if denied > 0 {
        let seconds = denied as f64 / rate_hz;
        warnings.push(format!(
            "for {seconds:.1} s speed_m_s says that the car stands while its wheels roll: that way is missing"
        ));
    }
    if wants_map {
        warnings.extend(survey.doubt_of_positions());
    }
    Ok(Found { about, road: survey.finish(vehicle.wheelbase_m), warnings })
}

fn estimator(vehicle: &Vehicle, corners: &[Corner], rate_hz: f64) -> Result<Box<MonitoredCar<f64>>, Failure> {
    let config = vehicle.car_config(corners);
    let fail = |error| Failure::Usage(format!("{error}"));
    Ok(Box::new(MonitoredCar::new(&MonitorConfig::new(&config), rate_hz).map_err(fail)?))
}
