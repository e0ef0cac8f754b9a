//! Two references that differ in every number.
#![allow(dead_code, reason = "every test file uses its own part")]

use itpms_core::model::{CornerCalibration, Learned, VehicleCalibration};
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;

pub(crate) fn learned(scale: f64) -> VehicleCalibration<f64> {
    let pair = |value: f64, sd: f64| Learned { value: scale * value, sd: scale * sd };
    let corner = |i: f64| CornerCalibration {
        placard_kpa: 241.3,
        unsprung_mass: pair(0.01 * i, 0.004),
        damping: pair(-0.1 * i, 0.03),
        spring: pair(0.02, 0.05 + 0.001 * i),
        spectrum_bias_kpa: pair(4.2 - i, 1.5),
        shared_road_bias: pair(0.01 * i, 0.011),
    };
    VehicleCalibration {
        corners: [Some(corner(1.0)), Some(corner(2.0)), Some(corner(3.0)), Some(corner(4.0))],
        bar: [Learned { value: 0.25, sd: 0.02 }, Learned { value: 0.1, sd: 0.02 }],
        rear_axle_coupling: Learned { value: 0.07, sd: 0.02 },
        gain: [pair(0.011, 0.002), pair(-0.007, 0.002)],
        wheelbase: pair(0.003, 0.0004),
        skew_s: [pair(0.0004, 0.0001), pair(-0.0001, 0.0001)],
        learned_s: scale * 612.5,
    }
}

pub(crate) fn old() -> StoredReference {
    StoredReference::new(&Vehicle::paper(), learned(1.0), 1_900_000_000).unwrap()
}

pub(crate) fn new() -> StoredReference {
    StoredReference::new(&Vehicle::paper(), learned(0.5), 1_900_086_400).unwrap()
}
