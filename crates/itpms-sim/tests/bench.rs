//! The test bed: a road that repeats, an actuator with a bandwidth, sensors with the stated noise, a slow reference.

use std::f64::consts::TAU;

use itpms_core::model::Corner;
use itpms_fourier::Complex;
use itpms_sim::road::{Actuator, BenchRoad, Road, Side, Surface};
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::{CornerRow, Simulation};
use itpms_sim::time_profile::{Pressure, Speed};

use crate::drive::builtin;

/// Samples of a segment: 0.66 s at 500 Hz.
const SEGMENT: usize = 330;

fn corner(scenario: &mut Scenario) -> &mut CornerSpec {
    scenario.corner.get_mut(Corner::FrontLeft).unwrap()
}

fn bench(scenario: &mut Scenario) -> &mut BenchRoad {
    match &mut scenario.road.surface {
        Surface::Bench(bench) => bench,
        other => panic!("{other:?}"),
    }
}

fn drive(scenario: &Scenario, seed: u64) -> Vec<CornerRow> {
    let rows = Simulation::new(scenario, seed).unwrap();
    rows.map(|row| row.corners[Corner::FrontLeft.index()].unwrap()).collect()
}

/// One-sided amplitudes of a record's harmonics, from the mean on.
fn harmonics(x: &[f64]) -> Vec<Complex<f64>> {
    let forward = itpms_fourier::forward(x.len());
    let (mut x, mut bins) = (x.to_vec(), forward.make_output_vec());
    let n = x.len() as f64;
    forward.process(&mut x, &mut bins).unwrap();
    bins.into_iter().map(|b| b * 2.0 / n).collect()
}

#[test]
fn the_scenarios_are_those_of_the_contract() {
    for (name, placard, times_and_pressures) in [
        ("bench-drop", 224.0, [(0.0, 224.0), (38.0, 224.0), (40.5, 183.0), (43.0, 142.0), (59.9, 142.0)]),
        (
            "bench-drop-recover",
            224.0,
            [(5.0, 224.0), (7.5, 183.0), (10.0, 142.0), (25.0, 161.0), (40.0, 180.0)],
        ),
        ("bench-slow", 220.0, [(0.0, 220.0), (5.0, 220.0), (20.0, 190.0), (35.0, 160.0), (39.9, 160.0)]),
    ] {
        let s = builtin(name);
        let rows = drive(&s, 1);
        for (time_s, pressure) in times_and_pressures {
            let found = rows[(time_s * 500.0_f64).round() as usize].pressure_kpa;
            assert!((found - pressure).abs() < 1e-9, "{name}, {time_s} s: {found}");
        }
        let configured = s.corner_config(Corner::FrontLeft).unwrap();
        let car = configured.quarter_car;
        assert_eq!((car.spring_n_per_m(), car.damping_n_s_per_m()), (20_663.0, 435.2));
        assert_eq!((car.sprung_mass_kg(), configured.placard_kpa), (240.0, placard));
        assert!((configured.initial_stiffness_n_per_m() - 200_000.0).abs() < 1e-6);
    }
}

#[test]
fn the_road_repeats_after_0_66_s_and_holds_nothing_but_harmonics() {
    let rows = drive(&builtin("bench-drop"), 3);
    let road: Vec<f64> = rows.iter().map(|r| r.road_m).collect();
    let rms = (road.iter().map(|z| z * z).sum::<f64>() / road.len() as f64).sqrt();
    assert!(rms > 1e-4, "{rms}");
    // 60 s are 333 m: their rounding, 6e-14 m, times the road's grade is what may differ.
    for (now, later) in road.iter().zip(&road[SEGMENT..]) {
        assert!((now - later).abs() < 1e-13, "{now} {later}");
    }
    // Twenty segments: only every twentieth line of the spectrum is a multiple of 1/0.66 Hz.
    let lines = harmonics(&road[..20 * SEGMENT]);
    let between = lines.iter().enumerate().filter(|(k, _)| k % 20 != 0).map(|(_, c)| c.norm());
    assert!(between.fold(0.0, f64::max) < 1e-12 * lines[20].norm().max(rms));
}

#[test]
fn a_seam_is_no_step() {
    // Without an actuator that could smooth it.
    let mut s = builtin("bench-drop");
    bench(&mut s).actuator = Actuator { natural_frequency_hz: 1e4, damping_ratio: 0.7 };
    for seed in 0..10 {
        let mut road = Road::at_speed(&s.road, Side::Left, seed, 0.005, 20.0 / 3.6).unwrap();
        let period_m = 0.66 * 20.0 / 3.6;
        let step = |x: f64, road: &mut Road| (road.height_m(x + 0.002) - road.height_m(x - 0.002)).abs();
        let usual: f64 =
            (1..500).map(|i| step(f64::from(i) * period_m / 500.0, &mut road).powi(2)).sum::<f64>() / 499.0;
        // The rise over 4 mm is Gaussian: five sd hold with 10 seeds.
        assert!(step(period_m, &mut road) < 5.0 * usual.sqrt(), "seed {seed}");
    }
}

/// The nodes of one segment as the road is laid, so that nothing folds and nothing is read between them.
fn nodes(scenario: &Scenario, seed: u64) -> Vec<f64> {
    let speed = 20.0 / 3.6;
    let mut road = Road::at_speed(&scenario.road, Side::Left, seed, 0.005, speed).unwrap();
    let spacing_m = road.spacing_m();
    let count = (0.66 * speed / spacing_m).round();
    assert!((count * spacing_m - 0.66 * speed).abs() < 1e-12);
    (0..count as usize).map(|i| road.height_m(i as f64 * spacing_m)).collect()
}

#[test]
fn the_actuator_answers_as_its_closed_form() {
    let [mut wanted, mut played] = [builtin("bench-drop"), builtin("bench-drop")];
    let stiff = Actuator { natural_frequency_hz: 1e4, damping_ratio: 0.7 };
    let actuator = Actuator { natural_frequency_hz: 18.0, damping_ratio: 0.5 };
    (bench(&mut wanted).actuator, bench(&mut played).actuator) = (stiff, actuator);
    let [wanted, played] = [&wanted, &played].map(|s| harmonics(&nodes(s, 5)));
    for k in 1..700usize {
        let transfer = |a: Actuator| {
            let s = Complex::new(0.0, TAU * k as f64 / 0.66);
            let w = TAU * a.natural_frequency_hz;
            w * w / (s * s + 2.0 * a.damping_ratio * w * s + w * w)
        };
        let expected = wanted[k] / transfer(stiff) * transfer(actuator);
        assert!((played[k] - expected).norm() < 1e-15, "{k}: {} {expected}", played[k]);
    }
    assert!(wanted[1].norm() > 1e-4);
}

#[test]
fn the_actuators_differential_equation_holds_in_time() {
    // z'' + 2 ζ ω z' + ω² z = ω² demand, by differences of the road on a fine grid in time.
    let s = builtin("bench-drop");
    let mut demand = s.clone();
    bench(&mut demand).actuator = Actuator { natural_frequency_hz: 1e4, damping_ratio: 0.7 };
    let speed = 20.0 / 3.6;
    let [mut z, mut u] =
        [&s, &demand].map(|s| Road::at_speed(&s.road, Side::Left, 2, 0.0001, speed).unwrap());
    let (h, w, zeta) = (2e-4, TAU * 30.0, 0.7);
    let (mut error, mut size) = (0.0, 0.0);
    for i in 0..1000 {
        let t = f64::from(i) * 0.66 / 1000.0;
        let [before, now, after] = [t - h, t, t + h].map(|t| z.height_m(t * speed));
        let left = (after - 2.0 * now + before) / (h * h) + zeta * w * (after - before) / h + w * w * now;
        let right = w * w * u.height_m(t * speed);
        error += (left - right).powi(2);
        size += right * right;
    }
    // Differences miss (ωh)²/12 of a wave, 5e-4 at 60 Hz; the stand-in for the demand is late by 1.4/(2π 1e4) = 22 us,
    // which is 1.4e-3 of a wave at 10 Hz, 2.8e-2 at 200. An answer ahead of its demand would miss by about 1.
    assert!((error / size).sqrt() < 0.03, "{}", (error / size).sqrt());
}

#[test]
fn the_wheel_sensors_noise_has_the_stated_variances() {
    for variance in [0.248, 0.274, 0.380] {
        let mut noisy = builtin("bench-drop");
        corner(&mut noisy).wheel_sensor = Some(SensorSpec::with_noise(f64::sqrt(variance)));
        let mut quiet = noisy.clone();
        corner(&mut quiet).wheel_sensor = Some(SensorSpec::with_noise(0.0));
        corner(&mut quiet).body_sensor = Some(SensorSpec::with_noise(0.0));
        let (noisy_rows, quiet_rows) = (drive(&noisy, 1), drive(&quiet, 1));
        let mean_square = |read: fn(&CornerRow) -> f64| {
            let square = |(a, b): (&CornerRow, &CornerRow)| (read(a) - read(b)).powi(2);
            noisy_rows.iter().zip(&quiet_rows).map(square).sum::<f64>() / noisy_rows.len() as f64
        };
        // sd of a variance over 30 000 values: sqrt(2/30 000) = 0.8 %; four of them.
        assert!((mean_square(|r| r.wheel_accel_m_s2) / variance - 1.0).abs() < 0.033, "{variance}");
        assert!((mean_square(|r| r.body_accel_m_s2) / 0.0025 - 1.0).abs() < 0.033);
        // The estimator is given the nominal one throughout.
        let configured = noisy.corner_config(Corner::FrontLeft).unwrap().accel_noise_m_s2.unwrap();
        assert!((configured * configured - 0.248).abs() < 1e-5, "{configured}");
    }
    let nominal = builtin("bench-drop").corner.fl.unwrap().wheel_sensor.unwrap().noise_m_s2;
    assert!((nominal * nominal - 0.248).abs() < 1e-5);
}

#[test]
fn another_load_is_carried_and_not_configured() {
    let mut s = builtin("bench-drop");
    s.duration_s = 5.0;
    for kg in [220.0, 260.0] {
        corner(&mut s).truth.sprung_mass_factor = kg / 240.0;
        corner(&mut s).wheel_sensor = Some(SensorSpec::with_noise(0.0));
        corner(&mut s).body_sensor = Some(SensorSpec::with_noise(0.0));
        assert_eq!(s.corner_config(Corner::FrontLeft).unwrap().quarter_car.sprung_mass_kg(), 240.0);
        // The filters before the samplers are alike and cancel. The body's transfer from the wheel, (c s + k) / (m s² + c s + k), holds the mass and nothing of the tire.
        let rows = drive(&s, 1);
        let rows = &rows[rows.len() - 3 * SEGMENT..];
        let signal = |read: fn(&CornerRow) -> f64| harmonics(&rows.iter().map(read).collect::<Vec<_>>());
        let (body, wheel) = (signal(|r| r.body_accel_m_s2), signal(|r| r.wheel_accel_m_s2));
        for k in [1, 2, 4] {
            let w = TAU * f64::from(k) / 0.66;
            let strut = Complex::new(20_663.0, 435.2 * w);
            let expected = strut / (strut - kg * w * w);
            let found = body[3 * k as usize] / wheel[3 * k as usize];
            // The start's transient after 18 s: 1e-5 of the swing.
            assert!((found - expected).norm() < 1e-3 * expected.norm(), "{kg} kg, {k}: {found} {expected}");
        }
    }
}

#[test]
fn a_log_holds_the_slow_sensors_reading_and_the_truth_stays_beside_it() {
    let mut s = builtin("bench-drop");
    let sensor = s.corner.fl.as_ref().unwrap().pressure_sensor.unwrap();
    assert_eq!(sensor.time_constant_s, 0.15);
    let rows = drive(&s, 1);
    assert!(rows.iter().all(|r| r.pressure_reading_kpa.fract() == 0.0));
    // Late in the ramp of -16.4 kPa/s the reading is 0.15 s behind: 2.46 kPa; 1000 readings of noise 0.3 and steps
    // of 1 kPa (0.29) have a mean known to 0.42/sqrt(1000) = 0.013.
    let ramp = &rows[20_000..21_000];
    let behind = ramp.iter().map(|r| r.pressure_reading_kpa - r.pressure_kpa).sum::<f64>() / 1000.0;
    assert!((behind - 2.46).abs() < 0.055, "{behind}");
    corner(&mut s).pressure_sensor = None;
    let without = drive(&s, 1);
    assert!(without.iter().all(|r| r.pressure_reading_kpa == r.pressure_kpa));
    // And nothing else has changed.
    assert!(without.iter().zip(&rows).all(|(a, b)| {
        (a.wheel_accel_m_s2, a.body_accel_m_s2, a.pressure_kpa)
            == (b.wheel_accel_m_s2, b.body_accel_m_s2, b.pressure_kpa)
    }));
}

#[test]
fn a_test_bed_needs_one_speed() {
    for speed in [Speed::ConstantKmH(0.0), Speed::PointsSKmH(vec![[0.0, 20.0], [5.0, 30.0]])] {
        let mut s = builtin("bench-slow");
        s.speed = speed;
        let error = s.validate().unwrap_err().to_string();
        assert!(error.contains("road.surface.bench is given with a speed that changes or is 0"), "{error}");
    }
    let s = builtin("bench-slow");
    let error = Road::new(&s.road, Side::Left, 1, 0.005).unwrap_err().to_string();
    assert!(error.contains("expected a constant speed above 0"), "{error}");
    let mut s = builtin("bench-slow");
    corner(&mut s).pressure = Pressure::ConstantKpa(200.0);
    corner(&mut s).pressure_sensor.as_mut().unwrap().noise_kpa = f64::NAN;
    let error = s.validate().unwrap_err().to_string();
    assert!(error.contains("corner.fl.pressure_sensor.noise_kpa is NaN"), "{error}");
}
