//! The roughness of the last hundred metres under each wheel, in bounded memory however long the drive.
//!
//! Fed by the drive with causal road heights, which are less exact than the late, smoothed ones that `itpms roughness` uses.

use itpms_analysis::roughness::WheelSurvey;
use itpms_core::model::{CarEstimate, Corner};

use crate::clock::Clock;
use crate::error::LiveError;

const SEGMENT_M: f64 = 100.0;

/// A survey per wheel and its newest complete segment.
#[derive(Debug)]
pub(crate) struct Roughness {
    wheels: [Option<WheelSurvey>; 4],
    pub(crate) iri_m_per_km: [f64; 4],
}

impl Roughness {
    pub(crate) fn new(clock: &Clock) -> Result<Self, LiveError> {
        let mut wheels = [const { None }; 4];
        for corner in &clock.corners {
            let survey = WheelSurvey::new(SEGMENT_M, clock.sample_rate_hz);
            wheels[corner.index()] = Some(survey.map_err(|error| LiveError::Refused(error.to_string()))?);
        }
        Ok(Self { wheels, iri_m_per_km: [f64::NAN; 4] })
    }

    pub(crate) fn push(&mut self, estimate: &CarEstimate<f64>, speed_m_s: f64, distance_m: f64) {
        for corner in Corner::ALL {
            let (Some(survey), Some(estimate)) =
                (&mut self.wheels[corner.index()], &estimate.corners[corner.index()])
            else {
                continue;
            };
            survey.push(estimate.time_s, distance_m, estimate.road_m, speed_m_s);
            if let Some(segment) = survey.take_newest() {
                // A segment with too little road says nothing, and what was before it is no longer the last.
                self.iri_m_per_km[corner.index()] = segment.iri_m_per_km.unwrap_or(f64::NAN);
            }
        }
    }
}
