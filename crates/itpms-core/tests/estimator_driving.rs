//! The default estimator on rides as they happen: standing, stop and go, a pothole, any sampling rate, either scalar.

use itpms_core::model::CornerEstimate;

use crate::common::ride::{Ride, Row, estimator, feed, informed, normalised};

const SEEDS: [u64; 4] = [1, 2, 3, 4];

/// The largest normalised error among valid estimates from `from_s` on, and when.
fn worst(rows: &[Row], estimates: &[CornerEstimate<f64>], from_s: f64) -> (f64, f64) {
    let valid = rows.iter().zip(estimates).filter(|(row, e)| row.time_s >= from_s && e.validity.is_valid());
    valid.fold((0.0, 0.0), |worst: (f64, f64), (row, e)| {
        let z = normalised(e, row.pressure_kpa);
        if z.abs() > worst.0.abs() { (z, row.time_s) } else { worst }
    })
}

fn without_speed(mut rows: Vec<Row>) -> Vec<Row> {
    for row in &mut rows {
        row.speed_m_s = f64::NAN;
    }
    rows
}

/// 0 for 2 s, up to 14 m/s within 4 s, 8 s at that, down within 4 s, 0 for 2 s.
fn stop_and_go(time_s: f64) -> f64 {
    let phase = time_s % 20.0;
    14.0 * (phase.min(20.0 - phase) / 4.0 - 0.5).clamp(0.0, 1.0)
}

/// Half a minute of driving, five minutes parked, driving again.
fn parked(time_s: f64) -> f64 {
    if (30.0..330.0).contains(&time_s) { 0.0 } else { 14.0 }
}

/// 30 mm deep, 0.4 m long, at 20 s and 50 km/h.
fn pothole_m(time_s: f64) -> f64 {
    let along = (time_s - 20.0) * 50.0 / 3.6 / 0.4;
    if (0.0..1.0).contains(&along) { -0.015 * (1.0 - (std::f64::consts::TAU * along).cos()) } else { 0.0 }
}

fn at(estimates: &[CornerEstimate<f64>], time_s: f64) -> &CornerEstimate<f64> {
    estimates.iter().find(|e| e.time_s >= time_s).unwrap()
}

#[test]
fn a_plain_ride_stays_within_three_standard_deviations() {
    for seed in SEEDS {
        for offset_m_s2 in [0.0, 9.81] {
            let ride = Ride { offset_m_s2, ..Ride::new(seed) };
            let rows = ride.rows();
            let estimates = informed(ride.rate_hz, &rows);
            let (z, when) = worst(&rows, &estimates, 0.0);
            println!("seed {seed}, offset {offset_m_s2}: worst {z:.2} sd at {when:.1} s");
            assert!(z.abs() < 3.0);
            assert!(estimates.iter().all(|e| e.diagnostics.pressure_variance_kpa2 > 0.0));
            assert!(estimates.last().unwrap().validity.is_valid());
        }
    }
}

#[test]
fn rates_and_jitter_agree_within_one_standard_deviation() {
    for seed in SEEDS {
        let base = Ride::new(seed);
        let reference = informed(500.0, &base.rows());
        for (rate_hz, jitter) in [(100.0, 0.0), (200.0, 0.0), (1000.0, 0.0), (2000.0, 0.0), (500.0, 0.2)] {
            let ride = Ride { rate_hz, jitter, ..base.clone() };
            let estimates = informed(rate_hz, &ride.rows());
            let mut largest = 0.0f64;
            for k in 5..39 {
                let (a, b) = (at(&reference, f64::from(k)), at(&estimates, f64::from(k)));
                let difference = a.pressure_kpa - b.pressure_kpa;
                largest = largest.max((difference / a.pressure_sd_kpa.max(b.pressure_sd_kpa)).abs());
            }
            println!("seed {seed}, {rate_hz} Hz, jitter {jitter}: at most {largest:.2} sd from 500 Hz");
            assert!(largest < 1.0);
        }
    }
}

#[test]
fn single_and_double_precision_agree() {
    for seed in SEEDS {
        let ride = Ride { pressure_kpa: |t| if t < 20.0 { 241.3 } else { 180.0 }, ..Ride::new(seed) };
        let mut single = estimator::<f32>(ride.rate_hz);
        let mut double = estimator::<f64>(ride.rate_hz);
        let (mut pressure, mut sd) = (0.0f64, 0.0f64);
        for row in &ride.rows() {
            let (a, b) = (feed(&mut single, row), feed(&mut double, row));
            assert_eq!(a.validity, b.validity);
            pressure = pressure.max((f64::from(a.pressure_kpa) - b.pressure_kpa).abs());
            sd = sd.max((f64::from(a.pressure_sd_kpa) - b.pressure_sd_kpa).abs());
        }
        println!("seed {seed}: f32 differs from f64 by at most {pressure:.1e} kPa, its sd by {sd:.1e} kPa");
        // Measured 6e-4 kPa. Why it may be so: a frame's log-likelihood, some ten nats between cells, keeps 1e-6 in f32;
        // a memory of 300 frames, random in sign, moves log-odds by 2e-5 and the mean by about that share of an sd of
        // 10-20 kPa. The bound leaves room for another processor's sine and exponential.
        assert!(pressure < 5e-3 && sd < 5e-3);
    }
}

#[test]
fn parked_with_speed_the_estimate_is_held_and_its_sd_grows() {
    for seed in SEEDS {
        let ride = Ride { speed_m_s: parked, seconds: 345.0, ..Ride::new(seed) };
        let rows = ride.rows();
        let estimates = informed(ride.rate_hz, &rows);
        let (before, after) = (at(&estimates, 30.5), at(&estimates, 329.9));
        println!(
            "seed {seed}: {:.1} ± {:.1} kPa when parked, {:.1} ± {:.1} five minutes later",
            before.pressure_kpa, before.pressure_sd_kpa, after.pressure_kpa, after.pressure_sd_kpa
        );
        // A symmetric wandering: the mean moves only by what leaves the grid, which ends at 310 kPa, two sd of 35 kPa
        // above 240. A normal distribution cut there loses 0.05 sd/(1 - 0.02) from its mean, cut on the way a few times.
        assert!((before.pressure_kpa - after.pressure_kpa).abs() < 0.2 * after.pressure_sd_kpa);
        assert!(after.pressure_sd_kpa > 1.5 * before.pressure_sd_kpa);
        let steady = (31..329).all(|s| {
            let (a, b) = (at(&estimates, f64::from(s)), at(&estimates, f64::from(s + 1)));
            b.pressure_sd_kpa >= a.pressure_sd_kpa - 1e-6
        });
        assert!(steady);
        // The first bumps: no step of a frame moves the estimate by more than one of its standard deviations.
        let first: Vec<_> = estimates.iter().filter(|e| (330.0..332.0).contains(&e.time_s)).collect();
        let largest =
            first.windows(2).map(|w| (w[1].pressure_kpa - w[0].pressure_kpa).abs()).fold(0.0, f64::max);
        println!("seed {seed}: first bumps move it by at most {:.2} sd", largest / after.pressure_sd_kpa);
        assert!(largest < after.pressure_sd_kpa);
        let (z, when) = worst(&rows, &estimates, 0.0);
        println!("seed {seed}: worst {z:.2} sd at {when:.1} s");
        assert!(z.abs() < 3.0);
    }
}

/// The largest normalised error over all seeds from `from_s` on.
fn worst_of(name: &str, from_s: f64, rows_of: impl Fn(u64) -> Vec<Row>) -> f64 {
    let mut largest = 0.0f64;
    for seed in SEEDS {
        let rows = rows_of(seed);
        let estimates = informed(500.0, &rows);
        let (z, when) = worst(&rows, &estimates, from_s);
        println!("{name}, seed {seed}: worst {z:.2} sd at {when:.1} s");
        largest = largest.max(z.abs());
    }
    largest
}

fn stop_and_go_rows(seed: u64) -> Vec<Row> {
    Ride { speed_m_s: stop_and_go, seconds: 120.0, ..Ride::new(seed) }.rows()
}

#[test]
fn stop_and_go_stays_within_three_standard_deviations_after_the_first_stop() {
    assert!(worst_of("stop and go, later", 20.0, stop_and_go_rows) < 3.0);
}

#[test]
fn stop_and_go_stays_within_three_standard_deviations() {
    assert!(worst_of("stop and go", 0.0, stop_and_go_rows) < 3.0);
}

#[test]
fn stop_and_go_without_speed_stays_within_three_standard_deviations() {
    let rows = |seed| without_speed(stop_and_go_rows(seed));
    assert!(worst_of("stop and go without speed", 0.0, rows) < 3.0);
}

#[test]
fn parked_without_speed_stays_within_three_standard_deviations() {
    let rows = |seed| without_speed(Ride { speed_m_s: parked, seconds: 345.0, ..Ride::new(seed) }.rows());
    assert!(worst_of("parked without speed", 0.0, rows) < 3.0);
}

/// From a bad road to a motorway's asphalt and back: power by a factor of 30 within a sample.
fn resurfaced(time_s: f64) -> f64 {
    if (20.0..40.0).contains(&time_s) { 17e-6 } else { 512e-6 }
}

/// How loud a road is tells nothing of the tire, nor does that it changes.
#[test]
fn another_surface_is_no_other_pressure() {
    for seed in SEEDS {
        let rows = Ride { roughness_m3: resurfaced, seconds: 60.0, ..Ride::new(seed) }.rows();
        let estimates = informed(500.0, &rows);
        let (z, when) = worst(&rows, &estimates, 0.0);
        println!("seed {seed}: worst {z:.2} sd at {when:.1} s");
        assert!(z.abs() < 3.0);
        for edge_s in [20.0, 40.0] {
            let (before, after) = (at(&estimates, edge_s), at(&estimates, edge_s + 1.5));
            let moved = (after.pressure_kpa - before.pressure_kpa).abs() / before.pressure_sd_kpa;
            println!(
                "seed {seed}: {edge_s} s moves it by {moved:.2} sd, whose sd is {:.1}",
                before.pressure_sd_kpa
            );
            assert!(moved < 1.0);
        }
    }
}

fn pothole_rows(seed: u64) -> Vec<Row> {
    Ride { bump_m: pothole_m, ..Ride::new(seed) }.rows()
}

#[test]
fn a_pothole_is_overcome_in_five_seconds() {
    assert!(worst_of("pothole, later", 25.0, pothole_rows) < 3.0);
}

#[test]
fn a_pothole_stays_within_three_standard_deviations() {
    assert!(worst_of("pothole", 0.0, pothole_rows) < 3.0);
}
