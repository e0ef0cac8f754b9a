//! The road under every wheel: each row's height comes half a minute late, when what followed has been seen.
//!
//! Memory is that half minute of rows, whatever the length of the drive.

use std::collections::VecDeque;

use itpms_analysis::odometer::Odometer;
use itpms_core::model::{Corner, ParameterError};
use itpms_data::{LogRow, Vehicle};
use itpms_road::{RoadConfig, RoadPoint, RoadRecorder, RoadRow, Segment, window_for};

use crate::drive::{Estimates, QuarterCars};
use crate::error::DriveError;

/// How far the smoother looks ahead; more changes nothing worth having at any speed.
const LOOKAHEAD_S: f64 = 30.0;
/// Seconds between two updates of the recorders' stiffness, load and damping, each of which costs them some work.
const UPDATE_S: f64 = 0.1;

type Recorder = RoadRecorder<f64, Vec<RoadRow<f64>>, Vec<Segment<f64>>>;

/// A row with everything that is known of it once its road is there.
#[derive(Debug, Clone)]
pub struct LateRow {
    pub row: LogRow,
    /// The speed in m/s to go by; NaN while it is unknown.
    pub speed_m_s: f64,
    /// The distance in m driven so far; NaN while the speed was never known.
    pub distance_m: f64,
    /// As they were at the row's time, but for the road.
    pub estimates: Estimates,
}

/// The recorders of all corners, and the rows that wait for them.
pub struct RoadTrack {
    recorders: [Option<(Recorder, VecDeque<RoadPoint<f64>>)>; 4],
    waiting: VecDeque<LateRow>,
    odometer: Odometer,
    updated_s: f64,
}

impl RoadTrack {
    /// Recorders of these corners for a log of this rate. Errors: a corner's parameters are refused.
    pub fn new(vehicle: &Vehicle, corners: &[Corner], rate_hz: f64) -> Result<Self, DriveError> {
        let (rows, segments) = window_for(rate_hz, LOOKAHEAD_S);
        let mut recorders = [const { None }; 4];
        for corner in corners {
            let Some(config) = vehicle.corner(*corner) else { continue };
            let fail =
                |error: ParameterError| DriveError::Mismatch(format!("corner {}: {error}", corner.label()));
            let noise = config.accel_noise_or_usual_m_s2();
            let road = RoadConfig::new(config.quarter_car, config.initial_stiffness_n_per_m(), noise)
                .map_err(fail)?;
            let (rows, segments) = (vec![RoadRow::default(); rows], vec![Segment::default(); segments]);
            let recorder = RoadRecorder::new(&road, rows, segments)
                .map_err(|error| DriveError::Mismatch(error.to_string()))?;
            recorders[corner.index()] = Some((recorder, VecDeque::new()));
        }
        Ok(Self {
            recorders,
            waiting: VecDeque::new(),
            odometer: Odometer::new(),
            updated_s: f64::NEG_INFINITY,
        })
    }

    /// Takes a row of the log and what was estimated after it.
    pub fn push(&mut self, row: &LogRow, estimates: &Estimates, cars: &QuarterCars) {
        let speed_m_s = self.odometer.push(row.time_s, row.speed_m_s);
        let due = row.time_s - self.updated_s >= UPDATE_S;
        if due {
            self.updated_s = row.time_s;
        }
        for corner in Corner::ALL {
            let i = corner.index();
            let (Some((recorder, points)), Some(sample)) = (&mut self.recorders[i], &row.corners[i]) else {
                continue;
            };
            if let Some(estimate) = estimates[i].filter(|_| due) {
                // A filter that has diverged has no stiffness to give; then the last good one stays.
                let _ = recorder
                    .filter_mut()
                    .set_stiffness(estimate.stiffness_n_per_m, estimate.stiffness_sd_n_per_m);
            }
            if let Some(car) = cars[i].filter(|_| due) {
                recorder.filter_mut().set_quarter_car(car);
            }
            recorder.push(row.time_s, &sample.sample(), |point| points.push_back(point));
        }
        let distance_m = self.odometer.distance_m();
        self.waiting.push_back(LateRow { row: *row, speed_m_s, distance_m, estimates: *estimates });
    }

    /// The drive is over: nothing has to wait any more.
    pub fn finish(&mut self) {
        for (recorder, points) in self.recorders.iter_mut().flatten() {
            recorder.finish(|point| points.push_back(point));
        }
    }

    pub fn pop(&mut self) -> Option<LateRow> {
        if self.recorders.iter().flatten().any(|(_, points)| points.is_empty()) {
            return None;
        }
        let mut late = self.waiting.pop_front()?;
        for (estimate, recorder) in late.estimates.iter_mut().zip(&mut self.recorders) {
            let point = recorder.as_mut().and_then(|(_, points)| points.pop_front());
            if let (Some(estimate), Some(point)) = (estimate, point) {
                (estimate.road_m, estimate.road_sd_m) = (point.road_m, point.road_sd_m);
            }
        }
        Some(late)
    }
}
