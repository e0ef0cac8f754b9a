//! The road estimate against a plant of its own: accuracy, honesty of its sd, robustness. The tables in
//! docs/math/road.md come from `cargo test -p itpms-road --test all road_estimate -- --ignored --nocapture`.

mod accuracy;
mod compare;
mod honesty;
mod plant;
mod robustness;

use itpms_core::model::{CornerSample, QuarterCar};
use itpms_road::{RoadConfig, RoadFilter, RoadPoint, RoadRecorder, RoadRow, Segment, window_for};
use plant::{Log, STIFFNESS};

/// The paper's corner, its stiffness known, the noise as given.
pub(crate) fn config(noise: f64) -> RoadConfig<f64> {
    RoadConfig::new(QuarterCar::paper_table_2(), STIFFNESS, noise).unwrap()
}

pub(crate) fn recorder(
    config: &RoadConfig<f64>,
    rate_hz: f64,
) -> RoadRecorder<f64, Vec<RoadRow<f64>>, Vec<Segment<f64>>> {
    let (rows, segments) = window_for(rate_hz, config.lookahead_s());
    RoadRecorder::new(config, vec![RoadRow::default(); rows], vec![Segment::default(); segments]).unwrap()
}

pub(crate) fn record(config: &RoadConfig<f64>, log: &Log) -> Vec<RoadPoint<f64>> {
    let mut recorder = recorder(config, log.rate_hz);
    let mut points = vec![];
    for (time, sample) in log.samples() {
        recorder.push(time, &sample, |p| points.push(p));
    }
    recorder.finish(|p| points.push(p));
    points
}

pub(crate) fn heights(points: &[RoadPoint<f64>]) -> Vec<f64> {
    points.iter().map(|p| p.road_m).collect()
}

/// The causal estimate: height and sd after every sample.
pub(crate) fn causal(config: &RoadConfig<f64>, log: &Log) -> Vec<(f64, f64)> {
    let mut filter = RoadFilter::new(config);
    log.samples()
        .map(|(time, sample)| {
            let e = filter.update(time, &sample);
            (e.road_m, e.road_sd_m)
        })
        .collect()
}

impl Log {
    pub(crate) fn samples(&self) -> impl Iterator<Item = (f64, CornerSample<f64>)> {
        self.time.iter().zip(self.body.iter().zip(&self.wheel)).map(|(&time, (&body, &wheel))| {
            (time, CornerSample { body_accel_m_s2: body, wheel_accel_m_s2: wheel })
        })
    }
}
