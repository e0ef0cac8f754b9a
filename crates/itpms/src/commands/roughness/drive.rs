//! Tracks from a drive log: the road under every wheel, estimated as `itpms estimate` does.

use std::path::Path;

use itpms_analysis::roughness::{Anomaly, RoughnessTable, SideAnomaly, Way, WheelSurvey, of_a_side};
use itpms_console::{Failure, Interrupt, Screen};
use itpms_core::model::Corner;
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_data::log::PositionColumns;
use itpms_data::{LogReader, Vehicle};
use itpms_drive::{RoadTrack, common_corners};

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
    let mut wheels = Wheels::new(args, &corners, rate_hz)?;

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
        wheels.take(&mut road);
    }
    road.finish();
    wheels.take(&mut road);
    drop(progress);

    if !(wheels.distance_m > 0.0) {
        let path = args.input.display();
        let expected = "expected speeds above zero, or --speed-m-s V";
        return Err(Failure::Usage(format!(
            "{path}: speed_m_s never says that the car moves, so no distance: {expected}"
        )));
    }
    let about = format!("road under {} wheels, {:.1} m driven", corners.len(), wheels.distance_m);
    let mut warnings = log.repairs().warnings();
    if denied > 0 {
        let seconds = denied as f64 / rate_hz;
        warnings.push(format!(
            "for {seconds:.1} s speed_m_s says that the car stands while its wheels roll: that way is missing"
        ));
    }
    if wants_map {
        warnings.extend(wheels.doubt_of_positions());
    }
    Ok(wheels.finish(args.segment_m, vehicle.wheelbase_m, about, warnings))
}

fn estimator(vehicle: &Vehicle, corners: &[Corner], rate_hz: f64) -> Result<Box<MonitoredCar<f64>>, Failure> {
    let config = vehicle.car_config(corners);
    let fail = |error| Failure::Usage(format!("{error}"));
    Ok(Box::new(MonitoredCar::new(&MonitorConfig::new(&config), rate_hz).map_err(fail)?))
}

/// Within so many metres the wheels of a side have found the same hole, where the wheelbase is known, and where it is not.
const SAME_M: f64 = 1.0;
const SAME_WITHOUT_WHEELBASE_M: f64 = 4.0;
/// The way by the positions over that by the speed.
const SAME_WAY: std::ops::RangeInclusive<f64> = 0.9..=1.1;

/// A survey per wheel, and where the car was.
struct Wheels {
    surveys: Vec<(Corner, WheelSurvey)>,
    way: Way,
    distance_m: f64,
}

impl Wheels {
    fn new(args: &RoughnessArgs, corners: &[Corner], rate_hz: f64) -> Result<Self, Failure> {
        let survey = |corner: &Corner| {
            let survey = WheelSurvey::new(args.segment_m, rate_hz);
            survey
                .map(|survey| (*corner, survey.with_anomalies()))
                .map_err(|error| Failure::Usage(error.to_string()))
        };
        let surveys = corners.iter().map(survey).collect::<Result<_, _>>()?;
        Ok(Self { surveys, way: Way::default(), distance_m: 0.0 })
    }

    fn take(&mut self, road: &mut RoadTrack) {
        while let Some(late) = road.pop() {
            if late.distance_m.is_finite() {
                self.distance_m = late.distance_m;
                self.way.push(late.distance_m, late.row.motion.position_deg);
            }
            for (corner, survey) in &mut self.surveys {
                let height_m = late.estimates[corner.index()].map_or(f64::NAN, |estimate| estimate.road_m);
                survey.push(late.row.time_s, late.distance_m, height_m, late.speed_m_s);
            }
        }
    }

    /// What a wrong unit makes of the way.
    fn doubt_of_positions(&self) -> Option<String> {
        let share = self.way.length_share().filter(|share| !SAME_WAY.contains(share))?;
        Some(format!(
            "the positions are apart by {share:.2} times the way driven, expected 1: latitude_deg and longitude_deg in degrees, speed_m_s in m/s"
        ))
    }

    /// Distances of holes and bumps are the front wheels': a rear wheel comes to a place a wheelbase later.
    fn finish(self, segment_m: f64, wheelbase_m: Option<f64>, about: String, warnings: Vec<String>) -> Found {
        let mut sides: [Vec<Vec<Anomaly>>; 2] = Default::default();
        let mut tracks = Vec::new();
        for (corner, survey) in self.surveys {
            let (track, mut anomalies) = survey.finish_with_anomalies();
            let (is_rear, side) = (corner.index() >= 2, corner.index() % 2);
            if is_rear {
                anomalies.iter_mut().for_each(|anomaly| anomaly.at_m -= wheelbase_m.unwrap_or(0.0));
            }
            sides[side].push(anomalies);
            tracks.push((corner.label().to_owned(), track));
        }
        let within_m = if wheelbase_m.is_some() { SAME_M } else { SAME_WITHOUT_WHEELBASE_M };
        let anomalies: [Vec<SideAnomaly>; 2] = sides.map(|wheels| of_a_side(&wheels, within_m));
        let table = RoughnessTable::new(segment_m, tracks);
        Found { about, table, anomalies, way: self.way, warnings }
    }
}
