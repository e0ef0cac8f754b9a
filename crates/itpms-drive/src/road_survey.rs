//! How rough the road of a drive was, where its holes and bumps are, and where on earth that is: made of its rows once their road is there.

use itpms_analysis::roughness::{
    Anomaly, RoughnessTable, SideAnomaly, SurveyError, Way, WheelSurvey, geojson, of_a_side,
};
use itpms_core::model::Corner;
use serde_json::{Value, json};

use crate::road::LateRow;

/// Within so many metres the wheels of a side have found the same hole, where the wheelbase is known, and where it is not.
const SAME_M: f64 = 1.0;
const SAME_WITHOUT_WHEELBASE_M: f64 = 4.0;
/// The way by the positions over that by the speed.
const SAME_WAY: std::ops::RangeInclusive<f64> = 0.9..=1.1;
/// How the tracks of [`SurveyedRoad::anomalies`] are called.
const SIDES: [&str; 2] = ["left", "right"];

/// A survey per wheel, and where the car was.
#[derive(Debug)]
pub struct RoadSurvey {
    wheels: Vec<(Corner, WheelSurvey)>,
    way: Way,
    distance_m: f64,
    segment_m: f64,
}

impl RoadSurvey {
    /// By segments of so many metres. Errors: they are none, or the rate is none.
    pub fn new(segment_m: f64, corners: &[Corner], rate_hz: f64) -> Result<Self, SurveyError> {
        let wheel = |corner: &Corner| Ok((*corner, WheelSurvey::new(segment_m, rate_hz)?.with_anomalies()));
        let wheels = corners.iter().map(wheel).collect::<Result<_, _>>()?;
        Ok(Self { wheels, way: Way::default(), distance_m: 0.0, segment_m })
    }

    pub fn take(&mut self, late: &LateRow) {
        if late.distance_m.is_finite() {
            self.distance_m = late.distance_m;
            self.way.push(late.distance_m, late.row.motion.position_deg);
        }
        for (corner, survey) in &mut self.wheels {
            let height_m = late.estimates[corner.index()].map_or(f64::NAN, |estimate| estimate.road_m);
            survey.push(late.row.time_s, late.distance_m, height_m, late.speed_m_s);
        }
    }

    /// The way driven so far in m.
    pub fn distance_m(&self) -> f64 {
        self.distance_m
    }

    /// The way's factor by a wrong unit.
    pub fn doubt_of_positions(&self) -> Option<String> {
        let share = self.way.length_share().filter(|share| !SAME_WAY.contains(share))?;
        Some(format!(
            "the positions are apart by {share:.2} times the way driven, expected 1: latitude_deg and longitude_deg in degrees, speed_m_s in m/s"
        ))
    }

    /// Distances of holes and bumps are the front wheels': a rear wheel comes to a place a wheelbase later.
    pub fn finish(self, wheelbase_m: Option<f64>) -> SurveyedRoad {
        let mut sides: [Vec<Vec<Anomaly>>; 2] = Default::default();
        let mut tracks = Vec::new();
        for (corner, survey) in self.wheels {
            let (track, mut anomalies) = survey.finish_with_anomalies();
            let (is_rear, side) = (corner.index() >= 2, corner.index() % 2);
            if is_rear {
                anomalies.iter_mut().for_each(|anomaly| anomaly.at_m -= wheelbase_m.unwrap_or(0.0));
            }
            sides[side].push(anomalies);
            tracks.push((corner.label().to_owned(), track));
        }
        let within_m = if wheelbase_m.is_some() { SAME_M } else { SAME_WITHOUT_WHEELBASE_M };
        let anomalies = sides.map(|wheels| of_a_side(&wheels, within_m));
        let table = RoughnessTable::new(self.segment_m, tracks);
        SurveyedRoad { table, anomalies, way: self.way }
    }
}

/// The road of a drive or of a profile.
#[derive(Debug)]
pub struct SurveyedRoad {
    pub table: RoughnessTable,
    /// Holes and bumps of the left and the right track, of a drive.
    pub anomalies: [Vec<SideAnomaly>; 2],
    /// Where the car was, of a drive.
    pub way: Way,
}

impl SurveyedRoad {
    /// Of a profile, of which there are no holes and no places.
    pub fn of_table(table: RoughnessTable) -> Self {
        Self { table, anomalies: Default::default(), way: Way::default() }
    }

    /// Holes and bumps with their tracks, in the order of the road.
    pub fn along_the_road(&self) -> Vec<(&'static str, SideAnomaly)> {
        let sides = SIDES.into_iter().zip(&self.anomalies);
        let mut all: Vec<_> =
            sides.flat_map(|(track, found)| found.iter().map(move |one| (track, *one))).collect();
        all.sort_by(|(_, a), (_, b)| a.anomaly.at_m.total_cmp(&b.anomaly.at_m));
        all
    }

    pub fn anomalies_json(&self) -> Value {
        let one = |(track, SideAnomaly { anomaly, passes }): (&str, SideAnomaly)| {
            json!({
                "kind": anomaly.kind(),
                "track": track,
                "distance_m": anomaly.at_m,
                "time_s": anomaly.time_s,
                "height_m": anomaly.height_m,
                "height_sd_m": anomaly.height_sd_m,
                "length_m": anomaly.length_m,
                "passes": passes,
            })
        };
        self.along_the_road().into_iter().map(one).collect()
    }

    /// The map, and how much of it has no place.
    pub fn geojson(&self) -> (Value, usize) {
        let [left, right] = [0, 1].map(|side| (SIDES[side], self.anomalies[side].as_slice()));
        geojson(&self.table, &[left, right], &self.way)
    }
}
