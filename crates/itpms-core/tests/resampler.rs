//! What stands before every estimator: each kind of bad sample counted once and kept out, the rest on equal steps.
use itpms_core::conditioning::{GridSample, Resampler, SampleClock, SampleCounts};

use crate::common::quarter_plant::{Random, rms};

const RATE_HZ: f64 = 500.0;
const PERIOD_S: f64 = 1.0 / RATE_HZ;

/// Feeds (time, body, wheel) rows, gives the grid and the counts.
fn regrid(
    rows: impl IntoIterator<Item = (f64, f64, f64)>,
) -> (Vec<GridSample<f64>>, SampleCounts, Resampler<f64>) {
    let mut intake = Resampler::new(RATE_HZ, 400.0);
    let mut grid = vec![];
    for (time_s, body, wheel) in rows {
        intake.push(time_s, 10.0, body, wheel, |sample| grid.push(sample));
    }
    (grid, intake.counts(), intake)
}

/// A signal that never repeats a value at once.
fn lively(k: usize) -> f64 {
    3.0 * (k as f64 * 0.7).sin() + (k as f64 * 0.31).cos()
}

fn row(k: usize) -> (f64, f64, f64) {
    (k as f64 * PERIOD_S, lively(k), lively(k + 50))
}

#[test]
fn a_clean_signal_passes_unchanged_four_samples_late() {
    let (grid, counts, intake) = regrid((0..100).map(row));
    assert_eq!(counts, SampleCounts { accepted: 100, ..SampleCounts::default() });
    assert!(!intake.is_bad());
    // The first interval with four samples on each side starts at sample 3; the last one before sample 96 ends there.
    assert_eq!(grid.len(), 93);
    for (i, sample) in grid.iter().enumerate() {
        let (time_s, body, wheel) = row(i + 3);
        // Rounding of eight weights that sum to one.
        assert!((sample.time_s - time_s).abs() < 1e-9);
        assert!(
            (sample.body_accel_m_s2 - body).abs() < 1e-5 && (sample.wheel_accel_m_s2 - wheel).abs() < 1e-5
        );
        assert_eq!(sample.after_gap, i == 0);
        assert!(!sample.invalid);
    }
}

/// Seconds since 1970 have quarters of a microsecond, loggers round to microseconds: each step of the grid comes with the same sample.
#[test]
fn a_rounded_stamp_moves_no_step_to_another_sample() {
    let steps = |stamp: fn(f64) -> f64| -> Vec<usize> {
        let mut intake = Resampler::<f64>::new(RATE_HZ, 400.0);
        let push = |k: usize| {
            let (time_s, body, wheel) = row(k);
            let mut steps = 0;
            intake.push(stamp(time_s), 10.0, body, wheel, |_| steps += 1);
            steps
        };
        (0..20_000).map(push).collect()
    };
    let plain = steps(|time_s| time_s);
    assert_eq!(plain.iter().sum::<usize>(), 19_993);
    assert_eq!(steps(|time_s| 1_772_352_000.0 + time_s), plain);
    assert_eq!(steps(|time_s| (1e6 * (time_s + 0.000_123_4)).round() / 1e6), plain);
}

#[test]
fn every_kind_of_bad_sample_is_counted_once() {
    let mut rows: Vec<_> = (0..200).map(row).collect();
    rows[20].1 = f64::NAN;
    rows[30].2 = f64::INFINITY;
    rows[40].1 = 1500.0;
    rows[50].2 = -1e300;
    rows[60].0 = rows[59].0;
    rows[70].0 = f64::NAN;
    rows[80].0 = rows[10].0;
    rows[90].0 = f64::INFINITY;
    let (grid, counts, _) = regrid(rows);
    let expected =
        SampleCounts { accepted: 192, missing: 2, absurd: 2, out_of_order: 4, ..SampleCounts::default() };
    assert_eq!(counts, expected);
    // Single holes are bridged: no step is lost, no value invented far from the signal's range of four.
    assert_eq!(grid.len(), 193);
    assert!(grid.iter().all(|s| s.body_accel_m_s2.abs() < 5.0 && s.wheel_accel_m_s2.abs() < 5.0));
}

#[test]
fn holes_of_up_to_two_samples_are_bridged_and_longer_ones_interrupt() {
    for (hole, gaps) in [(1, 0), (2, 0), (3, 1), (30, 1)] {
        let (grid, counts, _) = regrid((0..100).chain(100 + hole..300).map(row));
        assert_eq!((counts.gaps, counts.accepted), (gaps, 300 - hole as u64), "hole of {hole}");
        let after = grid.iter().filter(|s| s.after_gap).count() as u64;
        assert_eq!(after, 1 + gaps);
        let longest = grid.windows(2).map(|w| w[1].time_s - w[0].time_s).fold(0.0, f64::max);
        if gaps == 0 {
            assert!((longest - PERIOD_S).abs() < 1e-9);
        } else {
            // Four samples are lost on each side of a gap.
            assert!((longest - (hole as f64 + 8.0) * PERIOD_S).abs() < 1e-9, "{longest}");
        }
    }
}

/// Error of the grid relative to a sine of amplitude one that was sampled with jitter.
fn sine_error(per_rate: f64, jitter: f64) -> f64 {
    let sine = |t: f64| (std::f64::consts::TAU * per_rate * RATE_HZ * t + 0.3).sin();
    let mut random = Random::new(9);
    let rows = (0..4000).map(|k| {
        let t = (k as f64 + jitter * random.normal().clamp(-2.0, 2.0)) * PERIOD_S;
        (t, sine(t), sine(t + 0.1))
    });
    let (grid, _, _) = regrid(rows);
    rms(grid.iter().map(|s| s.body_accel_m_s2 - sine(s.time_s))) / 0.5f64.sqrt()
}

#[test]
fn jittered_samples_are_interpolated() {
    // Bounds: the remainder of the polynomial through eight equal steps at its largest, in the middle,
    // x^8/8! (1/2 3/2 5/2 7/2)² with x = 2 pi f/rate: 2.6e-5, 6.6e-3, 0.17. Its rms is less, jitter makes it more.
    for (per_rate, bound) in [(0.1, 2.6e-5), (0.2, 6.6e-3), (0.3, 0.17)] {
        let error = sine_error(per_rate, 0.2);
        println!("sine at {per_rate} of the rate, 20 % jitter: {error:.2e}");
        assert!(error < bound, "{per_rate}: {error}");
    }
}

#[test]
fn slow_samples_come_on_a_finer_grid() {
    let mut intake = Resampler::new(100.0, 400.0);
    assert_eq!(intake.grid_period_s(), 0.0025);
    let sine = |t: f64| (std::f64::consts::TAU * 12.0 * t).sin();
    let mut grid = vec![];
    for k in 0..500 {
        let t = f64::from(k) * 0.01;
        intake.push(t, 10.0, sine(t), sine(t + 0.02), |s| grid.push(s));
    }
    assert!(grid.windows(2).all(|w| (w[1].time_s - w[0].time_s - 0.0025).abs() < 1e-9));
    // Remainder at 0.12 of the rate: (2 pi 0.12)^8/8! (1/2 3/2 5/2 7/2)² = 1.1e-4.
    assert!(grid.iter().all(|s: &GridSample<f64>| (s.body_accel_m_s2 - sine(s.time_s)).abs() < 1.2e-4));
}

#[test]
fn a_flat_top_at_the_limit_is_saturation_and_one_below_is_not() {
    let clipped = |limit: f64| move |k: usize| (20.0 * (k as f64 * 0.05).sin()).clamp(-limit, limit);
    let feed = |limit: f64| {
        let signal = clipped(limit);
        regrid((0..2000).map(|k| (k as f64 * PERIOD_S, lively(k), signal(k))))
    };
    let (_, whole, _) = feed(30.0);
    assert_eq!(whole.saturated, 0);
    // Beyond the limit while |sin| > 0.75: 46 % of the time; the first two samples of a flat top are not known for one.
    let (grid, counts, _) = feed(15.0);
    let flat = 2000.0 * (1.0 - 2.0 / std::f64::consts::PI * 0.75f64.asin());
    let tops = 2000.0 * 0.05 / std::f64::consts::PI;
    assert!((counts.saturated as f64 - (flat - 2.0 * tops)).abs() < 2.0 * tops, "{}", counts.saturated);
    assert!(grid.iter().any(|s| s.invalid));
    // The same value three times in a row amid larger ones is chance.
    let (_, counts, _) = regrid((0..2000).map(|k| {
        (k as f64 * PERIOD_S, lively(k), if (50..53).contains(&(k % 100)) { 0.5 } else { lively(k) })
    }));
    assert_eq!(counts.saturated, 0);
}

#[test]
fn a_sensor_that_stops_moving_is_stuck_until_it_moves() {
    let (_, counts, intake) = regrid((0..1000).map(|k| (k as f64 * PERIOD_S, lively(k), lively(k.min(100)))));
    assert!(intake.is_bad());
    // After half a second, 250 samples, behind sample 100.
    assert!((649..=650).contains(&counts.stuck), "{}", counts.stuck);
    let (_, _, intake) = regrid(
        (0..1000).map(|k| (k as f64 * PERIOD_S, lively(k), if k < 999 { lively(k.min(100)) } else { 0.1 })),
    );
    assert!(!intake.is_bad());
}

#[test]
fn missing_values_and_a_stopped_clock_make_the_signal_bad() {
    let (_, _, intake) = regrid((0..400).map(|k| if k < 100 { row(k) } else { (row(k).0, f64::NAN, 1.0) }));
    assert!(intake.is_bad());
    let (_, _, intake) = regrid((0..400).map(|k| if k < 100 { row(k) } else { (0.2, row(k).1, row(k).2) }));
    assert!(intake.is_bad());
}

#[test]
fn one_stamp_from_the_future_does_not_end_the_record() {
    for stamp in [1e9, 1e200, f64::MAX] {
        let mut clock = SampleClock::<f64>::new(RATE_HZ).unwrap();
        let stamped = (0..1000).map(|k| if k == 200 { (stamp, 0.1, 0.2) } else { row(k) });
        let (grid, counts, intake) = regrid(stamped.map(|(stamp_s, body, wheel)| {
            (clock.take(stamp_s, 10.0).time_s.unwrap_or(f64::NAN), body, wheel)
        }));
        assert!(!intake.is_bad());
        assert_eq!((counts.accepted, counts.out_of_order, counts.gaps), (999, 1, 0), "{stamp}");
        assert!(grid.last().is_some_and(|s| (s.time_s - row(996).0).abs() < 1.5 * PERIOD_S));
    }
}

#[test]
fn samples_on_top_of_each_other_give_finite_steps() {
    let mut intake = Resampler::<f32>::new(RATE_HZ, 400.0);
    let mut finite = true;
    for k in 0..400 {
        let (t, body, wheel) = row(k);
        for shift in [0.0, 1e-13, 1e-9, 1e-6] {
            intake.push(t + shift, 10.0, body as f32, wheel as f32, |s| {
                finite &= s.body_accel_m_s2.abs() < 10.0 && s.wheel_accel_m_s2.abs() < 10.0;
            });
        }
    }
    assert!(finite);
    assert_eq!(intake.counts().accepted, 400);
}

#[test]
fn stamps_since_1970_give_the_grid_of_stamps_since_the_start() {
    const START_S: f64 = 1_772_366_400.0;
    // Twenty minutes at 500 Hz: a grid whose steps were rounded to quarters of a microsecond would be 57 ms off.
    let rows = |start_s: f64| (0..600_000).map(move |k| (start_s + k as f64 * 0.002, lively(k), -lively(k)));
    let ((plain, ..), (dated, counts, _)) = (regrid(rows(0.0)), regrid(rows(START_S)));
    assert!(dated.len().abs_diff(plain.len()) <= 1 && counts.gaps == 0, "{} {}", dated.len(), plain.len());
    for (plain, dated) in plain.iter().zip(&dated) {
        // What is left: steps summed up twelve days after an epoch, where a time has a tenth of a nanosecond, half of that wrong at most.
        let off_s = dated.time_s - START_S - plain.time_s;
        assert!(off_s.abs() < 600_000.0 * 0.6e-10 + 5e-7, "{} {}", dated.time_s, plain.time_s);
        // The signal changes by less than 2500 in a second.
        assert!((dated.wheel_accel_m_s2 - plain.wheel_accel_m_s2).abs() < 2_500.0 * 4e-5);
    }
    // Across the seam between two epochs, 1690 times 2^20 s after 1970, one step at most is another.
    let seam_s = 1690.0 * f64::from(1 << 20);
    let (dated, counts, _) =
        regrid((0..4_000).map(|k| (seam_s - 4.0 + k as f64 * 0.002, lively(k), lively(k))));
    assert!(dated.len().abs_diff(3_994) <= 1 && counts.gaps == 0, "{}", dated.len());
    assert!(dated.windows(2).all(|pair| (pair[1].time_s - pair[0].time_s - 0.002).abs() < 2.1e-3));
}

/// A controller that states 200 Hz and samples at 100: what is bridged is no signal.
#[test]
fn samples_that_never_come_at_the_stated_rate_are_a_bad_signal() {
    let is_bad = |every: u32, lost: u32| {
        let mut resampler = Resampler::new(200.0, 400.0);
        for k in (0..2000).filter(|k| k % every == 0 && !(lost > 0 && k % lost == 0)) {
            let time_s = f64::from(k) / 200.0;
            resampler.push(time_s, 20.0, (3.0 * time_s).sin(), (70.0 * time_s).sin(), |_| {});
        }
        resampler.is_bad()
    };
    assert!(is_bad(2, 0) && is_bad(8, 0));
    // Every third is lost.
    assert!(!is_bad(1, 0) && !is_bad(1, 3));
}
