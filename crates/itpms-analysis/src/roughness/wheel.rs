//! The road under a wheel of a driven car, as a survey: samples in time become even cells of road.
//!
//! Called by the roughness command for every row of a drive's road. Knows nothing of estimators.

use super::anomaly::{Anomaly, AnomalySearch};
use super::cells::Cells;
use super::golden_car::Enveloping;
use super::survey::{Sampling, SegmentRoughness, SurveyError, SurveyOptions, TrackRoughness, TrackSurvey};

const CELL_M: f64 = 0.05;
/// A longer step from sample to sample is a hole in the log.
const LONGEST_STEP_M: f64 = 1.0;
/// Below this speed in m/s the accelerometers see little of the road.
const SLOWEST_M_S: f64 = 2.5;
/// Below this frequency in Hz the accelerometers drift (docs/math/road.md, section 5).
const SLOWEST_HZ: f64 = 0.5;
/// The shortest wave in m that a contact patch lets through.
const SHORTEST_M: f64 = 0.5;
/// Share of the sampling rate up to which a wave is seen, below the anti-alias filter.
const HIGHEST_SHARE: f64 = 0.25;

#[derive(Debug)]
pub struct WheelSurvey {
    cells: Cells<2>,
    start_m: f64,
    done: u64,
    rate_hz: f64,
    survey: TrackSurvey,
    anomalies: Option<AnomalySearch>,
}

impl WheelSurvey {
    /// A wheel about to roll; segments of `segment_m` count from the distance zero, samples come at `rate_hz`.
    /// Errors: the segment's length: see [`SurveyError`].
    pub fn new(segment_m: f64, rate_hz: f64) -> Result<Self, SurveyError> {
        let survey = TrackSurvey::new(SurveyOptions {
            origin_m: 0.0,
            segment_m,
            spacing_m: CELL_M,
            // The tire has averaged already.
            enveloping: Enveloping::Done,
            sampling: Sampling::CellMeans,
        })?;
        Ok(Self { cells: Cells::new(CELL_M), start_m: 0.0, done: 0, rate_hz, survey, anomalies: None })
    }

    /// The same, and looks for holes and bumps.
    pub fn with_anomalies(mut self) -> Self {
        self.anomalies = Some(AnomalySearch::new(CELL_M));
        self
    }

    /// The next sample: time in s, distance driven and road height in m, speed in m/s. A height that is not known, a standing car
    /// and a step of more than a metre end a stretch of road.
    pub fn push(&mut self, time_s: f64, distance_m: f64, height_m: f64, speed_m_s: f64) {
        let step = self.cells.last_m().map_or(0.0, |last_m| distance_m - last_m);
        let known = height_m.is_finite() && distance_m.is_finite() && speed_m_s > SLOWEST_M_S;
        if !(known && (0.0..=LONGEST_STEP_M).contains(&step)) {
            self.cells.restart();
            return;
        }
        if self.cells.last_m().is_none() {
            self.start_m = distance_m;
            self.done = 0;
        }
        let shortest_m = SHORTEST_M.max(speed_m_s / (HIGHEST_SHARE * self.rate_hz));
        let waves_m = (shortest_m, speed_m_s / SLOWEST_HZ);
        let Self { cells, start_m, done, survey, anomalies, .. } = self;
        cells.push(distance_m, [height_m, time_s], |[height_m, time_s]| {
            let at_m = *start_m + *done as f64 * CELL_M;
            survey.push(at_m, height_m, waves_m);
            if let Some(anomalies) = anomalies {
                anomalies.push(at_m, time_s, height_m);
            }
            *done += 1;
        });
    }

    /// The newest complete segment, taken away: see [`TrackSurvey::take_newest`].
    pub fn take_newest(&mut self) -> Option<SegmentRoughness> {
        self.survey.take_newest()
    }

    pub fn finish(self) -> TrackRoughness {
        self.survey.finish()
    }

    /// The same with the holes and bumps, if they were [looked for](Self::with_anomalies).
    pub fn finish_with_anomalies(self) -> (TrackRoughness, Vec<Anomaly>) {
        (self.survey.finish(), self.anomalies.map(AnomalySearch::finish).unwrap_or_default())
    }
}
