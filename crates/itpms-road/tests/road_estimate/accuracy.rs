//! Error of the record in wavelengths 0.5-10 m and of its IRI.

use super::compare::{band_error, iri};
use super::plant::{CLASS_A, CLASS_B, CLASS_C, Drive, Log, drive};
use super::{causal, config, heights, record};
use itpms_road::{RoadConfig, SensorDelay};

/// Result of one run, in percent.
struct Score {
    band: f64,
    /// Against the truth without what its sampling folds.
    unfolded: f64,
    iri: f64,
}

fn score(config: &RoadConfig<f64>, d: &Drive, log: &Log) -> Score {
    let road = heights(&record(config, log));
    let rate = d.rate_hz;
    let skip = (6.0 * rate) as usize;
    let spacing = d.speed() / rate;
    Score {
        band: 100.0 * band_error(&road, &log.road, rate, d.speed()),
        unfolded: 100.0 * band_error(&road, &log.road_unfolded, rate, d.speed()),
        iri: 100.0 * (iri(&road[skip..], spacing) / iri(&log.road[skip..], spacing) - 1.0),
    }
}

#[test]
fn class_b_is_recorded_within_the_goal() {
    // Goal: 8 % of rms and 5 % of IRI. The noise's share is 4.0 % at 20 km/h and 0.6 % at 80 km/h by theory
    // (docs/math/road.md, eq. 19); the truth column's own folding adds 3 % at 80 km/h.
    for (speed, band, unfolded) in [(20.0, 4.5, 4.5), (80.0, 4.5, 1.0)] {
        for seed in [11, 12] {
            let d = Drive::new(seed, speed, CLASS_B);
            let s = score(&config(0.05), &d, &drive(&d));
            assert!(
                s.band < band && s.unfolded < unfolded,
                "{speed} km/h: {:.2} {:.2} %",
                s.band,
                s.unfolded
            );
            assert!(s.iri.abs() < 1.5, "{speed} km/h: IRI {:+.2} %", s.iri);
        }
    }
}

#[test]
fn every_rate_works_without_options() {
    // At 100 Hz and 80 km/h the anti-alias filter (30 Hz) cuts into the band (to 44 Hz): 15 % there.
    for (rate, speed, limit) in [
        (100.0, 20.0, 8.0),
        (100.0, 80.0, 15.0),
        (200.0, 80.0, 4.0),
        (1000.0, 20.0, 4.0),
        (2000.0, 20.0, 4.0),
    ] {
        let d = Drive { rate_hz: rate, seconds: 40.0, ..Drive::new(21, speed, CLASS_B) };
        let s = score(&config(0.05), &d, &drive(&d));
        assert!(s.unfolded < limit, "{rate} Hz, {speed} km/h: {:.2} %", s.unfolded);
        assert!(s.iri.abs() < 5.0, "{rate} Hz, {speed} km/h: IRI {:+.2} %", s.iri);
    }
}

#[test]
fn parameters_that_are_a_little_wrong_cost_a_little() {
    // Relative errors of sprung and unsprung mass, damping, spring, tire stiffness that the estimator does not know.
    // Nominal is 3.0 % at 20 km/h; the limits leave one percent to the seed.
    let cases = [
        ([1.08, 1.0, 1.0, 1.0, 1.0], 5.0, 1.5),
        ([0.92, 1.0, 1.0, 1.0, 1.0], 5.0, 1.5),
        ([1.0, 1.0, 1.0, 1.1, 1.0], 5.0, 3.0),
        ([1.0, 1.0, 1.0, 1.0, 1.05], 5.0, 6.5),
        ([1.0, 1.0, 1.0, 1.0, 0.95], 5.0, 6.5),
    ];
    for (factors, slow, fast) in cases {
        for (speed, limit) in [(20.0, slow), (80.0, fast)] {
            let mut d = Drive { seconds: 40.0, ..Drive::new(31, speed, CLASS_B) };
            d.car = std::array::from_fn(|i| d.car[i] * factors[i]);
            let s = score(&config(0.05), &d, &drive(&d));
            assert!(s.unfolded < limit, "{factors:?} at {speed} km/h: {:.2} %", s.unfolded);
        }
    }
}

#[test]
fn the_sensors_delay_is_taken_out() {
    // A delay tau shifts by 2 pi tau sqrt(f_low f_high) of rms on a road of waviness 2: 17 % at 80 km/h for the
    // anti-alias filter's 2.8 ms, and it must come back when the compensation is switched off.
    let d = Drive { seconds: 40.0, ..Drive::new(41, 80.0, CLASS_B) };
    let log = drive(&d);
    let uncompensated = config(0.05).with_sensor_delay(SensorDelay::Seconds(0.0)).unwrap();
    let with = score(&config(0.05), &d, &log).unfolded;
    let without = score(&uncompensated, &d, &log).unfolded;
    assert!(with < 1.0 && (without - 17.3).abs() < 2.5, "{with:.2} {without:.2}");
}

#[test]
fn the_causal_height_follows_the_road_with_a_known_lead() {
    // Its high-pass leads by about (sqrt(2) 0.05 + 0.03) / f: 12 % of rms at 20 km/h, a quarter of that at 80 km/h
    // (docs/math/road.md, section 3), beside the sensors' delay, which is taken out of the comparison here.
    for (speed, limit) in [(20.0, 0.16), (80.0, 0.07)] {
        let d = Drive { seconds: 40.0, rate_hz: 1000.0, ..Drive::new(51, speed, CLASS_B) };
        let log = drive(&d);
        let height: Vec<f64> = causal(&config(0.05), &log).iter().map(|&(z, _)| z).collect();
        // 1.386 samples of delay: the nearest whole one, 0.4 ms off, leaves less than 3 %.
        let error = band_error(&height[1..], &log.road_unfolded[..height.len() - 1], d.rate_hz, d.speed());
        assert!(error < limit, "{speed} km/h: {:.1} %", 100.0 * error);
    }
}

#[test]
#[ignore = "prints the tables of docs/math/road.md; minutes"]
fn report() {
    let mean = |d: &Drive, c: &RoadConfig<f64>| {
        let runs: Vec<Score> = (1..=4)
            .map(|seed| {
                let d = Drive { seed, ..d.clone() };
                score(c, &d, &drive(&d))
            })
            .collect();
        let of = |f: fn(&Score) -> f64| runs.iter().map(f).sum::<f64>() / 4.0;
        format!("{:5.2} {:5.2} % IRI {:+.2} %", of(|s| s.band), of(|s| s.unfolded), of(|s| s.iri))
    };
    println!("rate, km/h, class, noise: error against the truth column, against unfolded truth, IRI");
    for (class, roughness) in [("A", CLASS_A), ("B", CLASS_B), ("C", CLASS_C)] {
        for speed in [20.0, 80.0] {
            for noise in [0.05, 0.3] {
                let d = Drive { noise, ..Drive::new(0, speed, roughness) };
                println!("500 {speed} {class} {noise}: {}", mean(&d, &config(noise)));
            }
        }
    }
    for rate in [100.0, 200.0, 1000.0, 2000.0] {
        for speed in [20.0, 80.0] {
            let d = Drive { rate_hz: rate, ..Drive::new(0, speed, CLASS_B) };
            println!("{rate} {speed} B 0.05: {}", mean(&d, &config(0.05)));
        }
    }
    println!("delay: filter in the data, compensation in the estimate");
    for rate in [200.0, 500.0, 1000.0] {
        for speed in [20.0, 80.0] {
            for cutoff_per_rate in [0.3, 0.0] {
                let d = Drive { cutoff_per_rate, rate_hz: rate, ..Drive::new(0, speed, CLASS_B) };
                let zero = config(0.05).with_sensor_delay(SensorDelay::Seconds(0.0)).unwrap();
                println!(
                    "{rate} {speed} cutoff {cutoff_per_rate}: on {} | off {}",
                    mean(&d, &config(0.05)),
                    mean(&d, &zero)
                );
            }
        }
    }
    println!("parameters: m_b, m_w, c_s, k_s, k_t wrong by a factor; waviness");
    let wrong =
        [(0, 1.08), (0, 0.92), (1, 1.03), (2, 1.2), (2, 0.8), (3, 1.1), (3, 0.9), (4, 1.05), (4, 0.95)];
    for speed in [20.0, 80.0] {
        for (index, factor) in wrong {
            let mut d = Drive::new(0, speed, CLASS_B);
            d.car[index] *= factor;
            let believing = config(0.05).with_body_mismatch(0.0).unwrap();
            println!(
                "{speed} parameter {index} x {factor}: {} | body believed {}",
                mean(&d, &config(0.05)),
                mean(&d, &believing)
            );
        }
        for waviness in [1.6, 2.14, 2.6] {
            let d = Drive { waviness, ..Drive::new(0, speed, CLASS_B) };
            println!("{speed} waviness {waviness}: {}", mean(&d, &config(0.05)));
        }
    }
}

/// Cost per sample; on a controller count the multiplications (docs/math/road.md, section 7).
#[test]
#[ignore = "prints times"]
fn cost_report() {
    use itpms_core::model::{CornerSample, QuarterCar};
    use itpms_road::RoadFilter;
    let log = drive(&Drive::new(1, 20.0, CLASS_B));
    let samples: Vec<_> = log.samples().collect();
    let per_sample = |seconds: f64| 1e9 * seconds / samples.len() as f64;
    let time = std::time::Instant::now();
    let mut filter = RoadFilter::new(&config(0.05));
    for (t, sample) in &samples {
        filter.update(*t, sample);
    }
    println!(
        "filter f64: {:.0} ns, {} bytes",
        per_sample(time.elapsed().as_secs_f64()),
        size_of_val(&filter)
    );
    let time = std::time::Instant::now();
    let config32 = RoadConfig::<f32>::new(QuarterCar::paper_table_2(), 2e5, 0.05).unwrap();
    let mut filter = RoadFilter::new(&config32);
    for (t, sample) in &samples {
        let (body, wheel) = (sample.body_accel_m_s2 as f32, sample.wheel_accel_m_s2 as f32);
        filter.update(*t, &CornerSample { body_accel_m_s2: body, wheel_accel_m_s2: wheel });
    }
    println!(
        "filter f32: {:.0} ns, {} bytes",
        per_sample(time.elapsed().as_secs_f64()),
        size_of_val(&filter)
    );
    let time = std::time::Instant::now();
    let mut filter = RoadFilter::new(&config(0.05));
    for (i, (t, sample)) in samples.iter().enumerate() {
        if i % 50 == 0 {
            filter.set_stiffness(2.3e5 + i as f64, 5e3).unwrap();
        }
        filter.update(*t, sample);
    }
    println!("filter f64, stiffness at 10 Hz: {:.0} ns", per_sample(time.elapsed().as_secs_f64()));
    let time = std::time::Instant::now();
    record(&config(0.05), &log);
    println!("record f64: {:.0} ns", per_sample(time.elapsed().as_secs_f64()));
}
