//! Sensors that fail, in every way a sensor fails: what the default estimator says while it lasts and afterwards.

use itpms_core::model::{CornerEstimate, Validity};

use crate::common::ride::{Ride, Row, informed, normalised};

const SEEDS: [u64; 4] = [1, 2, 3, 4];
/// First row of every fault, and its time.
const FAULT: usize = 10_000;
const FAULT_S: f64 = 20.0;

fn worst(rows: &[Row], estimates: &[CornerEstimate<f64>]) -> f64 {
    let valid = rows.iter().zip(estimates).filter(|(_, e)| e.validity.is_valid());
    valid.map(|(row, e)| normalised(e, row.pressure_kpa).abs()).fold(0.0, f64::max)
}

fn between(
    estimates: &[CornerEstimate<f64>],
    from_s: f64,
    to_s: f64,
) -> impl Iterator<Item = &CornerEstimate<f64>> {
    estimates.iter().filter(move |e| (from_s..to_s).contains(&e.time_s))
}

/// A ride whose rows went through `fault`, and what became of it.
fn faulty(seed: u64, fault: impl Fn(&mut Vec<Row>)) -> (Vec<Row>, Vec<CornerEstimate<f64>>) {
    let ride = Ride::new(seed);
    let mut rows = ride.rows();
    fault(&mut rows);
    let estimates = informed(ride.rate_hz, &rows);
    assert!(estimates.iter().all(|e| e.pressure_kpa.is_finite() && e.pressure_sd_kpa > 0.0));
    (rows, estimates)
}

#[test]
fn bursts_of_missing_samples() {
    for seed in SEEDS {
        for burst in [5, 50, 500] {
            let (rows, estimates) = faulty(seed, |rows| {
                for row in &mut rows[FAULT..FAULT + burst] {
                    row.wheel = f64::NAN;
                }
            });
            let z = worst(&rows, &estimates);
            println!("seed {seed}: {burst} missing, worst {z:.2} sd");
            assert!(z < 3.0);
            let bad = estimates.iter().filter(|e| e.validity == Validity::BadSignal).count();
            // Bad once half a second, 250 samples, is missing; then until the first sample that is there.
            assert!(bad.abs_diff(burst.saturating_sub(250)) <= 2, "{bad} of {burst}");
            assert!(estimates.last().unwrap().validity.is_valid());
        }
    }
}

#[test]
fn dropped_rows() {
    for seed in SEEDS {
        for (every, dropped) in [(50, 1), (50, 2), (500, 10), (5000, 1500)] {
            let (rows, estimates) = faulty(seed, |rows| {
                let mut k = 0;
                rows.retain(|_| {
                    k += 1;
                    k % every >= dropped
                });
            });
            let z = worst(&rows, &estimates);
            println!("seed {seed}: {dropped} of {every} rows dropped, worst {z:.2} sd");
            assert!(z < 3.0 && estimates.last().unwrap().validity.is_valid());
        }
    }
}

#[test]
fn a_stuck_wheel_sensor_is_reported_and_forgotten() {
    for seed in SEEDS {
        let (rows, estimates) = faulty(seed, |rows| {
            let value = rows[FAULT].wheel;
            for row in &mut rows[FAULT..FAULT + 1500] {
                row.wheel = value;
            }
        });
        let end_s = FAULT_S + 3.0;
        // Noticed after half a second.
        assert!(between(&estimates, FAULT_S + 0.51, end_s).all(|e| e.validity == Validity::BadSignal));
        assert!(between(&estimates, end_s, 40.0).all(|e| e.validity.is_valid()));
        let z = worst(&rows, &estimates);
        println!("seed {seed}: stuck for 3 s, worst {z:.2} sd");
        assert!(z < 3.0);
    }
}

#[test]
fn saturated_sensors_on_a_bad_road_teach_nothing() {
    for seed in SEEDS {
        let ride = Ride { roughness_m3: |_| 1024e-6, speed_m_s: |_| 25.0, ..Ride::new(seed) };
        let mut rows = ride.rows();
        for row in &mut rows {
            (row.body, row.wheel) = (row.body.clamp(-20.0, 20.0), row.wheel.clamp(-20.0, 20.0));
        }
        let share = rows.iter().filter(|r| r.wheel.abs() == 20.0).count() as f64 / rows.len() as f64;
        let estimates = informed(ride.rate_hz, &rows);
        let (z, last) = (worst(&rows, &estimates), estimates.last().unwrap());
        let (p, sd) = (last.pressure_kpa, last.pressure_sd_kpa);
        println!(
            "seed {seed}: {:.0} % saturated, {p:.0} ± {sd:.0} kPa {:?}, worst {z:.2} sd",
            100.0 * share,
            last.validity
        );
        assert!(z < 3.0);
    }
}

/// Rows of one wheel reading of 500 m/s², at 20 s or every 5 s.
fn spiked(seed: u64, every: usize) -> (Vec<Row>, Vec<CornerEstimate<f64>>) {
    faulty(seed, |rows| {
        for row in rows[every..].iter_mut().step_by(every) {
            row.wheel = 500.0;
        }
    })
}

#[test]
fn a_single_spike_is_overcome_in_five_seconds() {
    for seed in SEEDS {
        let (rows, estimates) = spiked(seed, FAULT);
        let z = worst(&rows[FAULT + 2500..], &estimates[FAULT + 2500..]);
        println!("seed {seed}: five seconds after a spike, worst {z:.2} sd");
        assert!(z < 3.0);
    }
}

#[test]
fn spikes_stay_within_three_standard_deviations() {
    let mut largest = 0.0f64;
    for seed in SEEDS {
        for every in [FAULT, 2500] {
            let (rows, estimates) = spiked(seed, every);
            let z = worst(&rows, &estimates);
            println!("seed {seed}: a spike every {every} rows, worst {z:.2} sd");
            largest = largest.max(z);
        }
    }
    assert!(largest < 3.0);
}

#[test]
fn the_clock_jumps_forwards_backwards_and_stands() {
    for seed in SEEDS {
        for jump_s in [0.01, 1.0, 3600.0, 1e7, -0.5, -10.0, -3600.0] {
            let (rows, estimates) = faulty(seed, |rows| {
                for row in &mut rows[FAULT..] {
                    row.time_s += jump_s;
                }
            });
            let (z, last) = (worst(&rows, &estimates), estimates.last().unwrap());
            assert!(z < 3.0 && last.validity.is_valid(), "{jump_s} s: {z} sd, {last:?}");
        }
        let (rows, estimates) = faulty(seed, |rows| {
            // Every row twice, and one far ahead of its time.
            *rows = rows.iter().flat_map(|&row| [row, row]).collect();
            rows[FAULT].time_s = 1e9;
        });
        let (z, last) = (worst(&rows, &estimates), estimates.last().unwrap());
        println!("seed {seed}: doubled rows and one stray stamp, worst {z:.2} sd");
        assert!(z < 3.0 && last.validity.is_valid());
    }
}
