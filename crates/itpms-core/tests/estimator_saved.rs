//! Saved at any moment and restored, the estimator goes on as if nothing had happened, bit by bit.
#![cfg(feature = "serde")]

use itpms_core::Real;
use itpms_core::conditioning::{GridSample, Resampler};
use itpms_core::estimator::Estimator;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::common::quarter_plant::Random;
use crate::common::ride::{Ride, estimator, feed};

/// A ride with holes and jitter, so that every part of the state is in use.
fn ride() -> Ride {
    Ride { seconds: 8.0, jitter: 0.1, ..Ride::new(21) }
}

fn resumes<T: Real + Serialize + DeserializeOwned>() {
    let ride = ride();
    let mut rows = ride.rows();
    for k in [700, 701, 1500, 2900] {
        rows[k].wheel = f64::NAN;
    }
    let mut random = Random::new(3);
    for _ in 0..3 {
        let moment = 100 + (random.uniform() * 3000.0) as usize;
        let mut original = estimator::<T>(ride.rate_hz);
        for row in &rows[..moment] {
            feed(&mut original, row);
        }
        let saved = postcard::to_allocvec(&original).unwrap();
        let mut restored: Estimator<T> = postcard::from_bytes(&saved).unwrap();
        for row in &rows[moment..moment + 500] {
            let (a, b) = (feed(&mut original, row), feed(&mut restored, row));
            // As bytes, so that equal NaN count as equal and unequal zeros do not.
            assert_eq!(postcard::to_allocvec(&a).unwrap(), postcard::to_allocvec(&b).unwrap());
        }
        assert_eq!(postcard::to_allocvec(&original).unwrap(), postcard::to_allocvec(&restored).unwrap());
    }
}

#[test]
fn estimators_in_f64_resume_bit_identically() {
    resumes::<f64>();
}

#[test]
fn estimators_in_f32_resume_bit_identically() {
    resumes::<f32>();
}

#[test]
fn an_intake_resumes_bit_identically() {
    let rows = ride().rows();
    for moment in [3, 8, 500, 1501] {
        let mut original = Resampler::<f64>::new(500.0, 400.0);
        let step = |intake: &mut Resampler<f64>, k: usize| {
            let mut out: Vec<GridSample<f64>> = vec![];
            intake.push(rows[k].time_s, rows[k].speed_m_s, rows[k].body, rows[k].wheel, |sample| {
                out.push(sample)
            });
            out
        };
        for k in 0..moment {
            step(&mut original, k);
        }
        let saved = postcard::to_allocvec(&original).unwrap();
        let mut restored: Resampler<f64> = postcard::from_bytes(&saved).unwrap();
        for k in moment..moment + 200 {
            assert_eq!(step(&mut original, k), step(&mut restored, k));
        }
        assert_eq!(original, restored);
    }
}
