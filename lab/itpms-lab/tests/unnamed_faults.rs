//! Sensors that are wrong in ways no detector looks for: what no pressure of a tire explains must not become one.

use itpms_core::model::{CarSample, Corner, Misfit};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::warning::WheelState;
use itpms_sim::scenario::{Scenario, ToleranceSpec};
use itpms_sim::simulation::Simulation;

const DRIVE_S: f64 = 160.0;
/// Seconds after which it has to have been seen, and what was reported before taken back.
const SEEN_S: f64 = 90.0;
/// Error in kPa of a pressure that is absurd: three standard deviations of one that rests on a file of confidence `typical`.
const ABSURD_KPA: f64 = 60.0;
/// A sample as a wrong sensor or a wrong cable gives it.
type Spoil = fn(CarSample<f64>) -> CarSample<f64>;

/// Wheel sensors that read so many times what they should.
fn gains(mut sample: CarSample<f64>, gains: [f64; 4]) -> CarSample<f64> {
    let corners = sample.corners.iter_mut().flatten();
    corners.zip(gains).for_each(|(corner, gain)| corner.wheel_accel_m_s2 *= gain);
    sample
}

/// Sensors of the front axle's wheels that read too little.
fn front_gain(sample: CarSample<f64>) -> CarSample<f64> {
    gains(sample, [0.75, 0.75, 1.0, 1.0])
}

fn exchanged(mut sample: CarSample<f64>, corners: [[usize; 2]; 2]) -> CarSample<f64> {
    corners.iter().for_each(|&[one, other]| sample.corners.swap(one, other));
    sample
}

fn diagonal_exchanged(sample: CarSample<f64>) -> CarSample<f64> {
    exchanged(sample, [[0, 3], [1, 1]])
}

fn axles_exchanged(sample: CarSample<f64>) -> CarSample<f64> {
    exchanged(sample, [[0, 2], [1, 3]])
}

/// A speed in other units than stated.
fn fast(sample: CarSample<f64>) -> CarSample<f64> {
    CarSample { speed_m_s: 1.3 * sample.speed_m_s, ..sample }
}

/// The findings on a drive of a car that is about as its file says and has all its air.
struct Found {
    /// Seconds in which a wheel was low at all.
    ever_low_s: f64,
    /// Seconds in which a wheel was low, and in which a pressure that may be shown was absurd, once that has to have been seen.
    low_s: f64,
    absurd_s: f64,
    /// What does not fit, of each corner at the end.
    misfits: [Option<Misfit>; 4],
    valid_s: f64,
}

fn drive(spoil: Spoil, seed: u64) -> Found {
    let mut scenario = Scenario::builtin("drive-normal").unwrap();
    let file = scenario.car_config().unwrap();
    scenario.journey.as_mut().unwrap().tolerances = None;
    ToleranceSpec::typical().apply(seed, &mut scenario);
    scenario.duration_s = DRIVE_S;
    let step_s = 1.0 / scenario.rate_hz;
    let mut car = Box::new(MonitoredCar::unconfigured());
    car.configure(&MonitorConfig::new(&file), scenario.rate_hz).unwrap();
    let mut found = Found { ever_low_s: 0.0, low_s: 0.0, absurd_s: 0.0, misfits: [None; 4], valid_s: 0.0 };
    for row in Simulation::new(&scenario, seed).unwrap() {
        let estimate = car.update(&spoil(row.car_sample()));
        let is_low = |i: usize| car.report().wheels[i].unwrap().state == WheelState::Low;
        found.ever_low_s += if (0..4).any(is_low) { step_s } else { 0.0 };
        if row.time_s < SEEN_S {
            continue;
        }
        for (i, (estimate, truth)) in estimate.corners.iter().zip(&row.corners).enumerate() {
            let (estimate, truth) = (estimate.unwrap(), truth.unwrap());
            let valid = estimate.validity.is_valid();
            let absurd = valid && (estimate.pressure_kpa - truth.pressure_kpa).abs() > ABSURD_KPA;
            found.valid_s += if valid { 0.25 * step_s } else { 0.0 };
            found.absurd_s += if absurd { step_s } else { 0.0 };
            found.low_s += if is_low(i) { step_s } else { 0.0 };
        }
    }
    found.misfits = Corner::ALL.map(|corner| car.estimator().fit(corner).unwrap().1);
    found
}

#[test]
fn a_fault_that_no_tire_explains_is_no_pressure() {
    let healthy = drive(|sample| sample, 1);
    assert_eq!((healthy.low_s, healthy.absurd_s, healthy.misfits), (0.0, 0.0, [None; 4]));
    assert!(healthy.valid_s > 0.8 * (DRIVE_S - SEEN_S), "{}", healthy.valid_s);
    let faults: [(&str, Spoil); 3] = [
        ("corners exchanged across", diagonal_exchanged),
        ("axles exchanged", axles_exchanged),
        ("speed x 1.3", fast),
    ];
    for (name, spoil) in faults {
        let found = drive(spoil, 1);
        assert_eq!(found.misfits, [Some(Misfit::Apart); 4], "{name}");
        assert_eq!((found.low_s, found.absurd_s), (0.0, 0.0), "{name}");
    }
}

/// From the first second on, long before it is reported that a sensor is wrong; one drive of 24 may have a road that hides it.
#[test]
fn a_gain_of_a_wheel_or_of_a_side_makes_no_tire_low() {
    let faults: [(&str, Spoil); 6] = [
        ("fl x 0.6", |sample| gains(sample, [0.6, 1.0, 1.0, 1.0])),
        ("fr x 1.25", |sample| gains(sample, [1.0, 1.25, 1.0, 1.0])),
        ("rl x 0.8", |sample| gains(sample, [1.0, 1.0, 0.8, 1.0])),
        ("rr x 1.6", |sample| gains(sample, [1.0, 1.0, 1.0, 1.6])),
        ("left x 0.75", |sample| gains(sample, [0.75, 1.0, 0.75, 1.0])),
        ("right x 1.35", |sample| gains(sample, [1.0, 1.35, 1.0, 1.35])),
    ];
    let drives = faults.iter().flat_map(|fault| (1..5).map(move |seed| (fault, seed)));
    let low: Vec<_> = drives
        .map(|((name, spoil), seed)| (name, seed, drive(*spoil, seed).ever_low_s))
        .filter(|(.., low_s)| *low_s > 0.0)
        .collect();
    assert!(low.len() <= 1, "{low:?}");
}

/// A gain that is common to both wheels of an axle has no witness among the sensors, and is not named in every drive: pressures of the
/// rear axle are up to a third too high (docs/math/monitor.md, section 6). No tire is called low for it.
#[test]
fn a_gain_of_both_front_wheels_makes_no_tire_low() {
    for seed in 1..4 {
        assert_eq!(drive(front_gain, seed).low_s, 0.0, "seed {seed}");
    }
}
