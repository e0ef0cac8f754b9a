//! Surveys against published values, against the whole-profile functions, and against roads of known spectrum.

use std::io::{Write as _, stderr};
use std::path::Path;

use super::*;
use crate::spectrum::{IsoClass, PowerLaw};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const ALL_WAVES: (f64, f64) = (0.1, 1e6);

fn options(segment_m: f64, spacing_m: f64) -> SurveyOptions {
    SurveyOptions {
        origin_m: 0.0,
        segment_m,
        spacing_m,
        enveloping: Enveloping::MovingAverage,
        sampling: Sampling::Points,
    }
}

fn survey(heights_m: &[f64], segment_m: f64, spacing_m: f64) -> TrackRoughness {
    let mut track = TrackSurvey::new(options(segment_m, spacing_m)).unwrap();
    for (i, height) in heights_m.iter().enumerate() {
        track.push(i as f64 * spacing_m, *height, ALL_WAVES);
    }
    track.finish()
}

/// A Gaussian road as a sum of 1500 waves of random phase and amplitude, their frequencies even in the logarithm.
fn road(law: PowerLaw, length_m: f64, spacing_m: f64, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut normal = || <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let (low, high, waves) = (0.005f64, 4.0f64, 1500);
    let step = (high / low).ln() / f64::from(waves);
    let waves: Vec<(f64, f64, f64)> = (0..waves)
        .map(|i| {
            let n = low * (step * (f64::from(i) + 0.5)).exp();
            let sd = (law.density_m3(n) * n * step).sqrt();
            (std::f64::consts::TAU * n, sd * normal(), sd * normal())
        })
        .collect();
    (0..(length_m / spacing_m) as usize)
        .map(|i| i as f64 * spacing_m)
        .map(|x| waves.iter().map(|(k, a, b)| a * (k * x).cos() + b * (k * x).sin()).sum())
        .collect()
}

/// Distances and heights of a surveyed road. `None` where the file is not, which is reported on the stream itself: what the
/// macros print in a test that passes is not shown.
pub(super) fn surveyed_road() -> Option<(Vec<f64>, Vec<f64>)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/profile_1.txt");
    let Ok(text) = std::fs::read_to_string(path) else {
        stderr().write_all(b"skipped: no ../shared/data/profile_1.txt\n").unwrap();
        return None;
    };
    let columns = text.lines().map(|line| line.split_once(char::is_whitespace).unwrap());
    Some(columns.map(|(x, z)| (x.parse::<f64>().unwrap(), z.trim().parse::<f64>().unwrap())).unzip())
}

#[test]
fn a_surveyed_road_by_segments() {
    let Some((x, z)) = surveyed_road() else { return };
    let even = EvenProfile::new(&x, &z).unwrap();
    assert!((even.spacing_m - 0.25).abs() < 1e-12 && even.bridged == 0);
    let track = survey(&even.heights_m, 100.0, even.spacing_m);
    // From an independent script, four digits.
    assert!((track.iri_m_per_km.unwrap() - 3.3355).abs() < 1e-4);
    assert_eq!(track.segments.len(), 6);
    for (segment, expected) in track.segments.iter().zip([3.2985, 2.4421, 3.5551, 4.0855, 2.7079]) {
        assert!((segment.iri_m_per_km.unwrap() - expected).abs() < 1e-4, "{segment:?}");
        let fit = segment.fit.unwrap();
        // Points 0.25 m apart hold waves from 0.625 m; a third of 100 m, waves up to 22 m.
        assert!((1.0 / fit.band_per_m.1 - 0.625).abs() < 0.05 && 1.0 / fit.band_per_m.0 > 20.0);
    }
    let rest = &track.segments[5];
    assert_eq!(rest.note(), "too little road: 44 of 100 m");
    assert!(rest.iri_m_per_km.is_err() && rest.fit.is_err());
}

#[test]
fn level_slope_and_class_of_a_known_road() {
    let law = PowerLaw { gd_n0_m3: 64e-6, waviness: 2.0 };
    let track = survey(&road(law, 3000.0, 0.1, 7), 100.0, 0.1);
    assert_eq!(track.segments.len(), 30);
    let (mut level, mut slope) = (Vec::new(), Vec::new());
    for segment in &track.segments {
        let fit = segment.fit.unwrap();
        assert_eq!(fit.class, IsoClass::of_level(fit.law.gd_n0_m3).unwrap());
        level.push((fit.law.gd_n0_m3 / 64e-6).ln() / fit.level_sd_ln);
        slope.push((fit.law.waviness - 2.0) / fit.waviness_sd);
        assert_eq!(segment.note(), "");
    }
    // 30 standardised errors: mean within 0.6 (three of 1/sqrt(30)), rms within 0.6 to 1.6.
    for errors in [level, slope] {
        let mean = errors.iter().sum::<f64>() / 30.0;
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / 30.0).sqrt();
        assert!(mean.abs() < 0.6 && (0.6..1.6).contains(&rms), "mean {mean}, rms {rms}");
    }
}

#[test]
fn a_segment_longer_than_the_road_is_the_road() {
    let law = PowerLaw { gd_n0_m3: 64e-6, waviness: 2.0 };
    let heights = road(law, 300.0, 0.1, 9);
    let whole = iri_m_per_km(&heights, 0.1, Enveloping::MovingAverage).unwrap().unwrap();
    let of_300 = survey(&heights, 300.0, 0.1);
    let [segment] = of_300.segments[..] else { panic!("{of_300:?}") };
    assert!((segment.iri_m_per_km.unwrap() / whole - 1.0).abs() < 1e-9);
    // A window of a third of the road holds waves up to two thirds of itself (docs/math/road.md, section 8).
    assert!(1.0 / segment.fit.unwrap().band_per_m.0 > 60.0);
    for asked_m in [301.0, 1e9, 1e300] {
        assert_eq!(survey(&heights, asked_m, 0.1), of_300);
    }
    // A wheel, whose cells begin and end anywhere.
    let rolled = |segment_m: f64| {
        let mut wheel = WheelSurvey::new(segment_m, 500.0).unwrap();
        heights
            .iter()
            .enumerate()
            .for_each(|(i, height)| wheel.push(i as f64 * 0.005, i as f64 * 0.1, *height, 20.0));
        wheel.finish()
    };
    assert!(rolled(1e300).segments[0].fit.is_ok());
    assert_eq!(rolled(1e300), rolled(300.0));
    // Nothing is reported of less than the shortest segment, nor of a road that is one leap.
    assert_eq!(survey(&heights[..21], 100.0, 0.1).segments[0].note(), "too little road: 2 of 2.5 m");
    let mut leap = TrackSurvey::new(options(1e300, 0.1)).unwrap();
    for (i, height) in heights.iter().enumerate() {
        leap.push(if i < 1500 { 0.1 } else { 1e15 } * i as f64, *height, ALL_WAVES);
    }
    let [segment] = leap.finish().segments[..] else { panic!("one segment") };
    assert!(segment.iri_m_per_km.is_err() && segment.fit.is_err());
}

#[test]
fn a_hole_costs_its_segment_and_no_other() {
    let law = PowerLaw { gd_n0_m3: 16e-6, waviness: 2.0 };
    let mut heights = road(law, 300.0, 0.1, 3);
    let whole = survey(&heights, 100.0, 0.1);
    heights[1200..1350].fill(f64::NAN);
    let track = survey(&heights, 100.0, 0.1);
    assert_eq!(track.segments[0], whole.segments[0]);
    assert_eq!(track.segments[1].note(), "too little road: 85 of 100 m");
    // The golden car has begun anew 65 m before the third segment and forgotten that: e^-(half a damped swing per 10 m).
    let (after, before) = (track.segments[2].iri_m_per_km.unwrap(), whole.segments[2].iri_m_per_km.unwrap());
    assert!((after / before - 1.0).abs() < 1e-3);
    // The same hole as a leap in distance.
    let mut leap = TrackSurvey::new(options(100.0, 0.1)).unwrap();
    for (i, height) in heights.iter().enumerate().filter(|(_, height)| height.is_finite()) {
        leap.push(i as f64 * 0.1, *height, ALL_WAVES);
    }
    assert_eq!(leap.finish(), track);
}

#[test]
fn segments_taken_on_the_way_are_those_of_the_whole_track_and_memory_does_not_grow() {
    let law = PowerLaw { gd_n0_m3: 64e-6, waviness: 2.0 };
    let mut heights = road(law, 530.0, 0.05, 4);
    heights[4000..4040].fill(f64::NAN);
    let whole = survey(&heights, 100.0, 0.05);
    let mut track = TrackSurvey::new(options(100.0, 0.05)).unwrap();
    let mut taken = Vec::new();
    for (i, height) in heights.iter().enumerate() {
        track.push(i as f64 * 0.05, *height, ALL_WAVES);
        taken.extend(track.take_newest());
    }
    assert_eq!(taken[..], whole.segments[..5]);
    assert_eq!(track.finish().segments[..], whole.segments[5..]);
}

#[test]
fn waves_that_are_missing_are_reported() {
    let law = PowerLaw { gd_n0_m3: 64e-6, waviness: 2.0 };
    let heights = road(law, 100.0, 0.05, 5);
    let mut slow = TrackSurvey::new(options(50.0, 0.05)).unwrap();
    for (i, height) in heights.iter().enumerate() {
        slow.push(i as f64 * 0.05, *height, (0.5, if i < 1000 { 11.0 } else { 8.0 }));
    }
    let track = slow.finish();
    let (first, second) = (&track.segments[0], &track.segments[1]);
    assert!(first.fit.is_ok() && (0.93..0.98).contains(&first.iri_share));
    assert!(first.note().starts_with("IRI from 9") && first.note().ends_with("of its waves: reads low"));
    assert!(matches!(second.fit, Err(TooLittle::Waves { longest_m, .. }) if (longest_m - 8.0).abs() < 0.1));
    assert!(second.note().ends_with("m only: Gd(n0) needs 10 m"), "{}", second.note());
}

#[test]
fn a_wheel_rolls_over_the_road_at_any_speed() {
    let law = PowerLaw { gd_n0_m3: 64e-6, waviness: 2.0 };
    let heights = road(law, 400.0, 0.05, 11);
    let at = |x: f64| {
        let i = ((x / 0.05) as usize).min(heights.len() - 2);
        heights[i] + (x / 0.05 - i as f64) * (heights[i + 1] - heights[i])
    };
    let mut wheel = WheelSurvey::new(100.0, 500.0).unwrap();
    let (mut distance_m, mut time_s) = (0.0, 0.0f64);
    while distance_m < 395.0 {
        let speed_m_s = 20.0 + 5.0 * (0.3 * time_s).sin();
        wheel.push(time_s, distance_m, at(distance_m), speed_m_s);
        distance_m += speed_m_s * 0.002;
        time_s += 0.002;
    }
    let track = wheel.finish();
    let expected = segment_iri_m_per_km(&heights, 0.05, Enveloping::Done, 100.0).unwrap();
    assert_eq!(track.segments.len(), 4);
    for (segment, expected) in track.segments.iter().zip(&expected).take(3) {
        // Means over 5 cm take 0.1 % of waves of 2 m; the cells lie half of 5 cm beside the points.
        assert!((segment.iri_m_per_km.unwrap() / expected - 1.0).abs() < 5e-3);
        // 15 m/s at the slowest.
        assert!(segment.note().is_empty() || segment.note().contains("reads low"));
    }
    assert!(track.segments[3].iri_m_per_km.is_ok(), "the last is 95 m long");
}

#[test]
fn the_mean_of_the_sides() {
    let track = |iri: f64| TrackRoughness {
        segments: vec![SegmentRoughness {
            start_m: 0.0,
            length_m: 100.0,
            known_m: 100.0,
            iri_m_per_km: Ok(iri),
            iri_share: 1.0,
            fit: Err(TooLittle::Road { known_m: 0.0, segment_m: 100.0 }),
        }],
        iri_m_per_km: Some(iri),
        known_m: 100.0,
    };
    let table = |tracks: &[(&str, f64)]| {
        RoughnessTable::new(
            100.0,
            tracks.iter().map(|(name, iri)| ((*name).to_owned(), track(*iri))).collect(),
        )
    };
    assert_eq!(table(&[("left", 2.0), ("right", 3.0)]).mri_m_per_km(0), Some(2.5));
    // Three wheels: the left side is the mean of two.
    assert_eq!(table(&[("fl", 2.0), ("rl", 3.0), ("fr", 4.5)]).whole_mri_m_per_km(), Some(3.5));
    assert_eq!(table(&[("fl", 2.0), ("rl", 3.0)]).mri_m_per_km(0), None);
    assert_eq!(table(&[("road", 2.0)]).mri_m_per_km(0), None);
    let csv = table(&[("left", 2.0), ("right", 3.0)]).csv();
    assert!(
        csv.contains(
            "\n0.000000,100.000000,left,100.000000,2.000000,2.500000,1.000000,,,,,,,,too little road"
        )
    );
    assert!(csv.lines().all(|line| line.split(',').count() == 15), "{csv}");
}

#[test]
fn impossible_options_are_refused() {
    assert!(TrackSurvey::new(options(2.4, 0.1)).is_err());
    assert!(TrackSurvey::new(options(f64::NAN, 0.1)).is_err());
    assert_eq!(
        TrackSurvey::new(options(100.0, 1.5)).unwrap_err().to_string(),
        "heights are 1.5 m apart, expected more than 0 and at most 1 m"
    );
}
