//! Against a second way to compute it, and on drawn days.

// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use super::*;
use crate::decision::Since;
use crate::model::Corner;
use crate::random::Random;
use crate::torsion::TorsionEvidence;
use crate::wheel_speed::LoadUncertainty;
use crate::wheel_speed::hypotheses::{Decision, PLACES, add_load};
use crate::wheel_speed::tests::config;

const TUNING: Tuning = Tuning::DEFAULT;
const BEGAN_S: f64 = 1.7e9;
const MOST_DAYS: usize = 6;
const SIZE: usize = 3 * MOST_DAYS;

/// Log density of a Gaussian without its mean, its `2 pi` left out, by Cholesky's factor.
fn log_density(mut covariance: [[f64; SIZE]; SIZE], mut x: [f64; SIZE], size: usize) -> f64 {
    let mut log = 0.0;
    for i in 0..size {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| covariance[i][k] * covariance[j][k]).sum();
            let rest = covariance[i][j] - sum;
            covariance[i][j] = if i == j { rest.sqrt() } else { rest / covariance[j][j] };
        }
        let sum: f64 = (0..i).map(|k| covariance[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / covariance[i][i];
        log -= 0.5 * x[i] * x[i] + covariance[i][i].ln();
    }
    log
}

fn full(triangle: &Triangle<f64>) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    for (entry, (i, j)) in triangle.iter().zip(PLACES) {
        (out[i][j], out[j][i]) = (*entry, *entry);
    }
    out
}

/// All days side by side: what they share is in their covariance, and the rate is integrated over numerically.
fn by_brute_force(days: &[(f64, [f64; 3], Triangle<f64>)], usual: &Triangle<f64>) -> [f64; 4] {
    let size = 3 * days.len();
    let mut wear = [0.0; 6];
    add_radii(&mut wear, TUNING.wear[1]);
    let stacked = |rates: &Triangle<f64>| {
        let (usual, rates) = (full(usual), full(rates));
        let mut covariance = [[0.0; SIZE]; SIZE];
        for (a, (k, _, own)) in days.iter().enumerate() {
            for (b, (l, ..)) in days.iter().enumerate() {
                for i in 0..3 {
                    for j in 0..3 {
                        let own = if a == b { full(own)[i][j] } else { 0.0 };
                        covariance[3 * a + i][3 * b + j] = own + usual[i][j] + k * l * rates[i][j];
                    }
                }
            }
        }
        covariance
    };
    let without = |rate: [f64; 3]| {
        let mut x = [0.0; SIZE];
        for (a, (k, change, _)) in days.iter().enumerate() {
            (0..3).for_each(|i| x[3 * a + i] = change[i] - k * rate[i]);
        }
        x
    };
    let none = log_density(stacked(&wear), without([0.0; 3]), size);
    let mut any = wear;
    [0, 2, 5].into_iter().for_each(|i| any[i] += (2.0 * TUNING.leak_per_day).powi(2));
    let other = DECISION.unexplained
        * DECISION.one_loses
        * (log_density(stacked(&any), without([0.0; 3]), size) - none).exp();
    let covariance = stacked(&wear);
    let leaks = SEEN.map(|seen| {
        let (step, mut sum, mut prior) = (2e-4, 0.0, 0.0);
        for n in 0..5000 {
            let g = -step * (f64::from(n) + 0.5);
            let weight = (-0.5 * ((g + TUNING.leak_per_day) / TUNING.leak_per_day).powi(2)).exp();
            prior += weight;
            sum += weight * (log_density(covariance, without(seen.map(|x| x * g)), size) - none).exp();
        }
        DECISION.one_loses * sum / prior
    });
    let total = 1.0 + other + leaks.iter().sum::<f64>();
    leaks.map(|leak| leak / total)
}

#[test]
fn sums_say_what_all_days_side_by_side_say() {
    let mut random = Random(3);
    for leak in [0.0, -0.01, -0.04, 0.03] {
        let mut usual = [0.01, 0.002, 0.02, -0.003, 0.001, 0.05];
        add_load(&mut usual, &config(), 0.5);
        let mut sums = RadiusDays::<f64>::since(BEGAN_S);
        let mut days = [(0.0, [0.0; 3], [0.0; 6]); MOST_DAYS];
        for (n, day) in days.iter_mut().enumerate() {
            let k = 3.0 + 7.0 * n as f64 + random.uniform();
            let own = [0.02 + 0.03 * random.uniform(), 0.003, 0.05, -0.002, 0.004, 0.3 + random.uniform()];
            let change = core::array::from_fn(|i| SEEN[2][i] * leak * k + 0.15 * random.normal());
            *day = (k, change, own);
            assert!(sums.see(BEGAN_S + DAY_S * k, &change, &own));
        }
        let (found, expected) = (sums.verdict(&usual, &TUNING), by_brute_force(&days, &usual));
        assert_eq!(found.days, 6);
        for (found, expected) in found.probability.iter().zip(expected) {
            // The integral's steps, and the exponential in powers of two.
            assert!((found / expected - 1.0).abs() < 1e-3, "{leak}: {found} {expected}");
        }
        // The same in single precision.
        let mut single = RadiusDays::<f32>::since(BEGAN_S);
        for (k, change, own) in &days {
            single.see(BEGAN_S + DAY_S * k, &change.map(|x| x as f32), &own.map(|x| x as f32));
        }
        let single = single.verdict(&usual.map(|x| x as f32), &TUNING);
        for (single, double) in single.probability.iter().zip(found.probability) {
            assert!((f64::from(*single) - double).abs() < 1e-3 * double + 1e-12, "{single} {double}");
        }
    }
}

/// A car's usual load and the day's, its noise, and what a loss adds; the day on which a day alone names a wheel, and that on which days do.
fn first_named(random: &mut Random, leak_per_day: f64, wheel: usize) -> [Option<(usize, bool)>; 2] {
    let draw = |random: &mut Random, part: f64| {
        let load = LoadUncertainty::<f64>::unknown();
        let [a, b, c] = [0.0; 3].map(|_: f64| part.sqrt() * random.normal());
        [-0.3 * c, 2.0 * 6.4 * load.rear_left_right * b - 0.2 * c, 6.4 * load.rear_axle * a + 0.2 * c]
    };
    let usual_load = draw(random, 0.5);
    let calibration = [0.01, 0.0, 0.02, 0.0, 0.0, 0.05f64];
    let error = [0, 2, 5].map(|i| calibration[i].sqrt() * random.normal());
    let mut usual = calibration;
    add_load(&mut usual, &config(), 0.5);
    let mut days = RadiusDays::<f64>::since(BEGAN_S);
    // 13 000 km a year, by which tires wear otherwise.
    let wear = SEEN.map(|_| 0.0043 * random.normal());
    let mut named = [None; 2];
    for k in 1..=56usize {
        let own = [0.03, 0.0, 0.05, 0.0, 0.0, 0.2f64];
        let (load, by_itself) = (draw(random, 0.5), SEEN.map(|_| 0.1 * random.normal()));
        let lost = 7.0 * k as f64 * (1.0 - leak_per_day).ln();
        let change: [f64; 3] = core::array::from_fn(|i| {
            let radii: f64 =
                (0..4).map(|wheel| SEEN[wheel][i] * (by_itself[wheel] + wear[wheel] * k as f64)).sum();
            let noise = own[[0, 2, 5][i]].sqrt() * random.normal();
            usual_load[i] + load[i] + error[i] + radii + noise + SEEN[wheel][i] * lost
        });
        let mut covariance = own;
        add_load(&mut covariance, &config(), 0.5);
        add_radii(&mut covariance, 0.1);
        assert!(days.see(BEGAN_S + DAY_S * k as f64, &change, &covariance));
        let (by_days, probability) = days.verdict(&usual, &TUNING).likeliest();
        if probability > 0.99 {
            named[1] = named[1].or(Some((k, by_days.index() == wheel)));
        }
        let mut alone = core::array::from_fn(|i| own[i] + calibration[i]);
        add_load(&mut alone, &config(), 1.0);
        let (unseen, unexplained) = (TorsionEvidence::BLANK, DECISION.unexplained);
        let day = Decision::of(&change, &alone, Since::Ever, &unseen, unexplained, &config());
        if let Some(found) = (0..4).find(|wheel| day.sets.low(Corner::ALL[*wheel]) > 0.99) {
            named[0] = named[0].or(Some((k, found == wheel)));
        }
    }
    named
}

#[test]
fn no_healthy_car_is_named_in_eight_weeks() {
    let mut random = Random(11);
    let named = (0..40).filter(|_| first_named(&mut random, 0.0, 0)[1].is_some()).count();
    assert_eq!(named, 0);
}

#[test]
fn slow_leaks_are_named_before_a_day_alone_names_them() {
    let mut random = Random(12);
    for (leak_per_day, share_named) in [(0.005, 0.8), (0.01, 0.95)] {
        let (mut alone, mut by_days, mut right) = (0, 0, 0);
        for car in 0..40 {
            let [day, days] = first_named(&mut random, leak_per_day, car % 4);
            let weeks = |named: Option<(usize, bool)>| named.map_or(57, |(k, _)| k);
            (alone, by_days) = (alone + weeks(day), by_days + weeks(days));
            right += usize::from(days.is_some_and(|(_, right)| right));
        }
        assert!(f64::from(u32::try_from(right).unwrap()) >= share_named * 40.0, "{leak_per_day}: {right}");
        // A week at half a percent a day, and four days at one, are 4 % of the pressure.
        assert!(by_days + 40 * 4 <= alone, "{leak_per_day}: after {by_days} / 40 days, alone {alone} / 40");
    }
}

#[test]
fn a_day_counts_once_and_only_with_a_date_and_forward() {
    let mut days = RadiusDays::<f64>::since(BEGAN_S);
    let own = [0.03, 0.0, 0.05, 0.0, 0.0, 0.2];
    let at = |k: f64| BEGAN_S + DAY_S * k;
    assert!(!days.see(120.0, &[0.0; 3], &own) && !days.see(at(-3.0), &[0.0; 3], &own));
    assert!(days.see(at(2.0), &[0.1; 3], &own));
    let before = days;
    // The same drive again, and one of an earlier day.
    assert!(!days.see(at(2.0), &[0.1; 3], &own) && !days.see(at(1.0), &[0.1; 3], &own));
    assert_eq!(days, before);
    // Known better in the evening, and the next day.
    assert!(days.see(at(2.4), &[0.2; 3], &own.map(|x| 0.5 * x)) && days.count == 0);
    assert!(days.see(at(3.2), &[0.2; 3], &own) && days.count == 1 && days.is_sane());
    // A calibration whose date is not known has no days.
    assert!(!RadiusDays::since(30.0).see(at(1.0), &[0.0; 3], &own));
}
