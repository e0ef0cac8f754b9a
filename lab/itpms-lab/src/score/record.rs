//! How well the road is recorded: error in the wavelengths that shake a car, and roughness.
//!
//! Called by the score. The stiffness comes from the estimator, the road from the recorder; both may look at the
//! truth only through the accelerations.

use itpms_paper::EstimatorKind;
use itpms_road::{RoadConfig, RoadRecorder, RoadRow, Segment, window_for};
use itpms_sim::road::RoadClass;
use itpms_sim::time_profile::Speed;

use super::case::Case;
use super::row::{Column, Goal, Row};
use super::stats::Spread;
use crate::runner::{Result, Runner, StudyError, Turn};
use itpms_analysis::roughness::{Enveloping, iri_m_per_km};
use itpms_analysis::spectrum::Welch;

const SPEEDS_KM_H: [f64; 2] = [20.0, 80.0];
const DURATION_S: f64 = 60.0;
/// Left out at both ends, in s: the stiffness is being found, and the record's end has no look-ahead.
const MARGIN_S: f64 = 6.0;
/// Frequencies compared, in cycles/m: wavelengths from 10 m to 0.5 m.
const BAND_PER_M: (f64, f64) = (0.1, 2.0);
/// Length in m of a spectrum's segment: the longest wave fits ten times.
const SEGMENT_M: f64 = 100.0;
/// Seconds between updates of the recorder's stiffness: each costs it some work.
const STIFFNESS_PERIOD_S: f64 = 0.1;
const ERROR_PERCENT: f64 = 8.0;
const IRI_PERCENT: f64 = 5.0;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Fidelity {
    /// Rms of the error over rms of the road, in the band.
    error: f64,
    /// IRI of the record over IRI of the road, less one.
    iri: f64,
}

pub(super) struct Plan {
    cases: Vec<(Case, usize)>,
}

impl Plan {
    pub(super) fn new(kind: EstimatorKind, drives: usize) -> Result<Self> {
        let case = |km_h: f64| {
            let mut case = Case::paper("paper-drop", kind)?.with_road(RoadClass::B, 2.14);
            if let Some(corner) = &mut case.scenario.corner.fl {
                corner.pressure = itpms_sim::time_profile::Pressure::ConstantKpa(corner.placard_kpa);
            }
            case.scenario.duration_s = DURATION_S;
            case.scenario.speed = Speed::ConstantKmH(km_h);
            Ok((case.named(format!("{km_h} km/h")), drives))
        };
        Ok(Self { cases: SPEEDS_KM_H.into_iter().map(case).collect::<Result<_>>()? })
    }

    pub(super) fn drives(&self) -> u64 {
        self.cases.iter().map(|(_, drives)| *drives as u64).sum()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        const ERROR: Column = Column::new("error_median_percent", "error %", 2);
        const ERROR_P90: Column = Column::new("error_p90_percent", "p90", 2);
        const IRI: Column = Column::new("iri_error_abs_median_percent", "|IRI error| %", 2);
        const IRI_P90: Column = Column::new("iri_error_abs_p90_percent", "p90", 2);
        let found = runner.run(&self.cases, fidelity)?;
        let row = |((case, drives), found): (&(Case, usize), &Vec<Fidelity>)| {
            let error = Spread::of(found.iter().map(|f| f.error));
            let iri = Spread::of(found.iter().map(|f| f.iri.abs()));
            let cells = vec![
                ERROR.judged(error.median, Goal::AtMost(ERROR_PERCENT)),
                ERROR_P90.plain(error.p90),
                IRI.judged(iri.median, Goal::AtMost(IRI_PERCENT)),
                IRI_P90.plain(iri.p90),
            ];
            Row::new("road", case.name.clone(), case.kind, *drives, cells)
        };
        Ok(self.cases.iter().zip(&found).map(row).collect())
    }
}

fn fidelity(case: &Case, turn: Turn) -> Result<Fidelity> {
    let (record, truth) = record(case, turn)?;
    let rate = case.scenario.rate_hz;
    let margin = (MARGIN_S * rate) as usize;
    let inner = margin..truth.len().min(record.len()).saturating_sub(margin);
    let (Some(record), Some(truth)) = (record.get(inner.clone()), truth.get(inner)) else {
        return Ok(Fidelity { error: f64::NAN, iri: f64::NAN });
    };
    let speed = case.scenario.speed.profile_m_s().map_or(f64::NAN, |profile| profile.value(0.0));
    compare(record, truth, speed / rate)
}

/// Recorded and true heights in m, one each per sample of the log.
fn record(case: &Case, turn: Turn) -> Result<(Vec<f64>, Vec<f64>)> {
    let corner = case.corner()?;
    let noise = case.scenario.sensor.noise_m_s2;
    let config = RoadConfig::new(corner.quarter_car, corner.initial_stiffness_n_per_m(), noise)?;
    let (rows, segments) = window_for(case.scenario.rate_hz, config.lookahead_s());
    let mut recorder =
        RoadRecorder::new(&config, vec![RoadRow::default(); rows], vec![Segment::default(); segments])?;
    let (mut record, mut truth) = (vec![], vec![]);
    let mut updated_s = f64::NEG_INFINITY;
    case.drive(turn.seed, |row, corner, estimate| {
        if row.time_s - updated_s >= STIFFNESS_PERIOD_S {
            updated_s = row.time_s;
            // Refused where an estimator has diverged; then the last good one stays.
            let _ = recorder
                .filter_mut()
                .set_stiffness(estimate.stiffness_n_per_m, estimate.stiffness_sd_n_per_m);
        }
        recorder.push(row.time_s, &corner.sample(), |point| record.push(point.road_m));
        truth.push(corner.road_m);
    })?;
    recorder.finish(|point| record.push(point.road_m));
    Ok((record, truth))
}

/// Two profiles in m, both `spacing_m` apart.
fn compare(record: &[f64], truth: &[f64], spacing_m: f64) -> Result<Fidelity> {
    let difference = record.iter().zip(truth).map(|(r, t)| r - t);
    let error = band_rms(difference, spacing_m)? / band_rms(truth.iter().copied(), spacing_m)?;
    let iri = |profile: &[f64]| {
        let iri = iri_m_per_km(profile, spacing_m, Enveloping::MovingAverage)?;
        Ok::<f64, StudyError>(iri.unwrap_or(f64::NAN))
    };
    Ok(Fidelity { error: 100.0 * error, iri: 100.0 * (iri(record)? / iri(truth)? - 1.0) })
}

/// Rms in m within the band.
fn band_rms(heights_m: impl Iterator<Item = f64>, spacing_m: f64) -> Result<f64> {
    let half = (0.5 * SEGMENT_M / spacing_m) as usize;
    let mut welch = Welch::new(2 * half, spacing_m)?;
    heights_m.for_each(|height| welch.push(height));
    let (low, high) = BAND_PER_M;
    Ok(welch.psd().map_or(f64::NAN, |psd| psd.variance_between(low, high).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const SPACING_M: f64 = 0.02;

    fn sines(waves: &[(f64, f64)]) -> Vec<f64> {
        let height = |x: f64| waves.iter().map(|(per_m, m)| m * (TAU * per_m * x).sin()).sum();
        (0..20_000).map(|i| height(f64::from(i) * SPACING_M)).collect()
    }

    #[test]
    fn a_wave_of_the_band_missed_by_a_tenth_is_ten_percent() {
        let truth = sines(&[(0.5, 0.01)]);
        let record: Vec<f64> = truth.iter().map(|z| 0.9 * z).collect();
        let found = compare(&record, &truth, SPACING_M).unwrap();
        // Both figures are of first degree in the heights.
        assert!((found.error - 10.0).abs() < 1e-6 && (found.iri + 10.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn what_lies_outside_the_band_does_not_count() {
        // Waves of 50 m and 0.25 m missed, one of 2 m found: what leaks through the window is 60 dB down.
        let (truth, record) = (sines(&[(0.5, 0.01), (0.02, 0.05), (4.0, 0.001)]), sines(&[(0.5, 0.01)]));
        let found = compare(&record, &truth, SPACING_M).unwrap();
        assert!(found.error < 1.0, "{found:?}");
    }

    #[test]
    fn rms_of_a_sine_in_the_band() {
        let rms = band_rms(sines(&[(0.5, 0.01)]).into_iter(), SPACING_M).unwrap();
        assert!((rms / (0.01 / 2f64.sqrt()) - 1.0).abs() < 1e-3, "{rms}");
    }
}
