//! The estimator of a whole car, saved and restored, goes on bit by bit.
#![cfg(feature = "serde")]

use std::sync::LazyLock;

use itpms_core::Real;
use itpms_core::car::CarEstimator;
use itpms_core::model::CarSample;

use crate::common::car_ride::{CarRide, car, cast, config, drive};

static ROWS: LazyLock<Vec<CarSample<f64>>> = LazyLock::new(|| CarRide::new(5).rows());

fn resumes<T: Real + serde::Serialize + serde::de::DeserializeOwned>() {
    for moment in [300, 801, 2467, 5000] {
        let mut original = car(&config::<T>());
        drive(&mut original, &ROWS[..moment]);
        let saved = postcard::to_allocvec(&original).unwrap();
        let mut restored: CarEstimator<T> = postcard::from_bytes(&saved).unwrap();
        for row in &ROWS[moment..moment + 700] {
            let (a, b) = (original.update(&cast(row)), restored.update(&cast(row)));
            // As bytes, so that equal NaN count as equal and unequal zeros do not.
            assert_eq!(postcard::to_allocvec(&a).unwrap(), postcard::to_allocvec(&b).unwrap());
        }
        assert_eq!(postcard::to_allocvec(&original).unwrap(), postcard::to_allocvec(&restored).unwrap());
    }
}

#[test]
fn saved_and_restored_it_goes_on_bit_by_bit() {
    let both = || {
        resumes::<f64>();
        resumes::<f32>();
    };
    // Reading a whole car back takes more than the 2 MB of a test's thread while nothing is optimised.
    std::thread::Builder::new().stack_size(8 << 20).spawn(both).unwrap().join().unwrap();
}
