//! The belief against textbook formulas: Kalman filter, information filter, exact enumeration of all histories.

extern crate std;

use std::vec::Vec;

use nalgebra::{SMatrix, SVector};
// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use super::covariance::Covariance;
use super::floor::Floor;
use super::gaussian::{self, Hypothesis};
use super::hypotheses::{CONSTANT, HYPOTHESES, RANDOM_WALK, SIDE};
use super::hypothesis_bank::HypothesisBank;
use super::measurement::{Gram, Score};
use super::state::{
    BAR, COUPLING, DAMPING, GAIN, LEVEL, MASS, RATE, ROAD_BIAS, SIDE_SIZE, SIDE_TIRES, SIZE, SPRING,
    SideReading, State, TIRE, WHEELBASE, prior_sd, read_compliance, return_rate, side_indices, wander_sd,
};
use super::update::{Lesson, Likelihood, own_covariance};
use super::{Belief, Onset};
use crate::memory::{Blank, configured};
use crate::model::{CarConfig, Corner, CornerConfig, Inflation, Side};

type Dense = SMatrix<f64, SIZE, SIZE>;

/// Unsprung masses as a measured car's, axle by axle.
const MASS_SD: [f64; 4] = [0.01; 4];

/// A bank at its start, the tires' compliances around `tires`.
fn bank(tires: &[f64; 4]) -> HypothesisBank<f64> {
    configured(|bank: &mut HypothesisBank<f64>| {
        bank.circumstances = gaussian::Circumstances::of_a_car(MASS_SD);
        bank.start(tires);
    })
}

/// A bank in which every hypothesis has a share, each with a mean of its own.
fn spread_out() -> HypothesisBank<f64> {
    let mut bank = bank(&[0.05, -0.02, 0.0, 0.1]);
    let weights = [0.6999, 0.1, 0.04, 0.08, 0.02, 1e-4, 6e-5, 0.05994];
    for (i, (hypothesis, weight)) in bank.hypotheses.iter_mut().zip(weights).enumerate() {
        hypothesis.weight = weight;
        for q in 0..SIZE {
            hypothesis.mean[q] += 0.01 * (((3 * i + 5 * q) % 7) as f64 - 3.0);
        }
        if i == CONSTANT || i == RANDOM_WALK {
            hypothesis.mean[RATE] = 0.0;
            hypothesis.covariance.isolate(RATE, 0.0);
        }
    }
    bank
}

/// A scalar update is the textbook's: P' = (P^-1 + h h^T/r)^-1, m' = m + P' h (innovation / r), for each hypothesis by itself.
#[test]
fn a_scalar_update_is_the_information_filters() {
    let mut bank = bank(&[0.0; 4]);
    for hypothesis in &mut bank.hypotheses {
        hypothesis.covariance = Covariance::of(&correlated());
        hypothesis.weight = 1.0 / HYPOTHESES as f64;
    }
    let before = bank.clone();
    let h = State::<f64>::from_fn(|i, _| ((5 * i) % 9) as f64 / 9.0 - 0.3);
    let (variance, measured) = (2e-3, 0.4);
    bank.update(variance, |state| (h, measured - h.dot(state)));
    for (after, before) in bank.hypotheses.iter().zip(&before.hypotheses) {
        let inverse = before.covariance.dense().try_inverse().unwrap();
        let covariance = (inverse + h * h.transpose() / variance).try_inverse().unwrap();
        let mean = before.mean + covariance * h * ((measured - h.dot(&before.mean)) / variance);
        assert!((after.covariance.dense() - covariance).amax() < 1e-12 * covariance.amax());
        assert!((after.mean - mean).amax() < 1e-11);
        assert_eq!(after.weight, before.weight, "tells nothing about which holds");
    }
}

/// The same with weights: each goes with the normal density at its own innovation.
#[test]
fn weights_follow_bayes_rule() {
    let mut bank = spread_out();
    let before = bank.clone();
    let h = State::<f64>::from_fn(|i, _| if i == TIRE { 1.0 } else { 0.0 });
    let (variance, measured) = (1e-3, 0.12);
    bank.update_reweighted(Side::Left, variance, |state| (h, measured - state[TIRE]));
    let density = |hypothesis: &super::Hypothesis<f64>| {
        let total = hypothesis.covariance[(TIRE, TIRE)] + variance;
        let t2 = (measured - hypothesis.mean[TIRE]).powi(2) / total;
        (-0.5 * t2).exp() / total.sqrt()
    };
    let joint: Vec<f64> = before.hypotheses.iter().map(|h| h.weight * density(h)).collect();
    let sum: f64 = joint.iter().sum();
    for (after, joint) in bank.hypotheses.iter().zip(joint) {
        assert!((after.weight - joint / sum).abs() < 1e-12);
    }
}

/// Prediction merges what it cannot keep apart, which leaves mean and covariance of the whole as an exact enumeration has them: of
/// every way from one hypothesis to another, each moved on by its own rate.
#[test]
fn prediction_agrees_with_exact_enumeration() {
    let mut bank = spread_out();
    let before = bank.clone();
    let seconds = 0.1;
    let rates = [0.3, 0.0, 0.1, 0.0];
    bank.begin_prediction(seconds, [true; 3], &rates);
    (0..super::PREDICTION_PARTS).for_each(|part| bank.predict_part(part));

    // Rates per second of docs/math/shared-road.md, section 6.
    let end = 1.0 - (-0.5 * seconds).exp();
    let begin = |to: usize| match to {
        1..=4 => 2e-4 * seconds + rates[to - 1] * seconds,
        5 | 6 => 1e-6 * seconds,
        _ => 1e-8 * seconds,
    };
    let join = 1e-2 * seconds;
    let changes = |to: usize, i: usize| to == i + 1 || to == 5 + i % 2;
    // (weight, mean, covariance) after each way.
    let mut ways = Vec::new();
    let written = |part: gaussian::Part<'_, f64>| {
        configured(|hypothesis: &mut super::Hypothesis<f64>| part.write(1.0, hypothesis))
    };
    for (from, hypothesis) in before.hypotheses.iter().enumerate() {
        let w = hypothesis.weight;
        if from == CONSTANT {
            let stay = 1.0 - (1..HYPOTHESES).map(begin).sum::<f64>();
            ways.push((CONSTANT, w * stay, hypothesis.clone()));
            for to in 1..HYPOTHESES {
                ways.push((to, w * begin(to), written(hypothesis.part().with_onset(to != RANDOM_WALK))));
            }
        } else {
            ways.push((CONSTANT, w * end, written(hypothesis.part().without_rate())));
            ways.push((from, w * (1.0 - end), hypothesis.clone()));
        }
    }
    // A wheel by itself is joined by its side, in addition to going on.
    for from in 1..=4 {
        let joined = written(before.hypotheses[from].part().without_rate().with_onset(true));
        ways.push((5 + (from - 1) % 2, before.hypotheses[from].weight * join, joined));
    }
    let (wander, back) = (wander_sd::<f64>(), return_rate(&prior_sd(&MASS_SD)));
    let total: f64 = ways.iter().map(|way| way.1).sum();
    let (mut mean, mut square) = (State::<f64>::zeros(), Dense::zeros());
    for (to, weight, hypothesis) in &ways {
        let has_rate = *to != CONSTANT && *to != RANDOM_WALK;
        let mut transition = Dense::identity();
        for i in 0..4 {
            if has_rate && changes(*to, i) {
                transition[(TIRE + i, RATE)] = seconds;
            }
        }
        let decay = Dense::from_diagonal(&back.map(|rate| (-rate * seconds).exp()));
        let mut noise = wander.component_mul(&wander) * seconds;
        if has_rate {
            noise[RATE] += 0.01 * seconds;
        }
        if *to == RANDOM_WALK {
            (0..4).for_each(|i| noise[TIRE + i] += 0.06 * 0.06 * seconds);
        }
        // What wanders does so before the rate moves the tires.
        let m = transition * decay * hypothesis.mean;
        let mut p = decay * hypothesis.covariance.dense() * decay.transpose() + Dense::from_diagonal(&noise);
        for (i, j) in (TIRE..TIRE + 4).flat_map(|i| (TIRE..TIRE + 4).map(move |j| (i, j))) {
            p[(i, j)] += 1.2e-3 * 1.2e-3 * seconds;
        }
        let p = transition * p * transition.transpose();
        mean += m * *weight / total;
        square += (p + m * m.transpose()) * *weight / total;
    }
    let covariance = square - mean * mean.transpose();
    let weights: f64 = bank.hypotheses.iter().map(|h| h.weight).sum();
    assert!((weights - total).abs() < 1e-12, "{weights} {total}");
    for i in TIRE..TIRE + 4 {
        let (m, v) = bank.quantity(i);
        assert!((m - mean[i]).abs() < 1e-12, "{i}: {m} {}", mean[i]);
        assert!((v - covariance[(i, i)]).abs() < 1e-12, "{i}: {v} {}", covariance[(i, i)]);
    }
}

/// Any belief with correlations: a sum of squares.
fn correlated() -> Dense {
    let mixing = Dense::from_fn(|i, j| ((7 * i + 3 * j) % 11) as f64 / 11.0 - 0.4);
    mixing * mixing.transpose() * 1e-3 + Dense::identity() * 1e-3
}

/// A frame tells the same of a tire and of the bias of reading it: the short update against the information of all quantities,
/// inverted whole.
#[test]
fn a_frame_tells_the_sum_of_tire_and_bias() {
    let side = Side::Right;
    let mut bank = bank(&[0.0; 4]);
    let hypothesis = &mut bank.hypotheses[0];
    hypothesis.covariance = Covariance::of(&correlated());
    let root = Gram::<f64>::from_fn(|i, j| ((5 * i + 2 * j) % 13) as f64 / 13.0 - 0.5);
    let information = root * root.transpose() * 300.0;
    let information_root = information.cholesky().unwrap().l();
    let score = Score::<f64>::from_fn(|i, _| 10.0 * (i as f64 - 6.0));
    let before = hypothesis.clone();
    let reading = SideReading { side, delay_s: 0.12 };
    learn(hypothesis, &reading, &score, &information_root, 1e6);

    let mut reads = SMatrix::<f64, SIDE_SIZE, SIZE>::zeros();
    for (own, place) in side_indices(side).into_iter().enumerate() {
        reads[(own, place)] = 1.0;
    }
    for (own, corner) in SIDE_TIRES.into_iter().zip([1, 3]) {
        reads[(own, ROAD_BIAS + corner)] = 1.0;
    }
    // 0.12 s later by wheelbase over speed, and a tenth of a second by the skew.
    reads[(SIDE_SIZE - 1, WHEELBASE)] = 1.2;
    let inverse = before.covariance.dense().try_inverse().unwrap();
    let covariance = (inverse + reads.transpose() * information * reads).try_inverse().unwrap();
    let mean = before.mean + covariance * reads.transpose() * score;
    assert!((hypothesis.covariance.dense() - covariance).amax() < 1e-10 * covariance.amax());
    assert!((hypothesis.mean - mean).amax() < 1e-9 * mean.amax());
    // So does the axle.
    let mut state = State::zeros();
    state[TIRE + 3] = 0.1;
    state[ROAD_BIAS + 3] = -0.02;
    assert!((read_compliance(&state, Corner::RearRight) - 1.08f64).abs() < 1e-15);
}

/// Learns from a frame whose residual has this squared Mahalanobis distance.
fn learn(
    hypothesis: &mut Hypothesis<f64>,
    reading: &SideReading<f64>,
    score: &Score<f64>,
    information_root: &Gram<f64>,
    mahalanobis_sq: f64,
) {
    let likelihood =
        Likelihood { log: 0.0, mahalanobis_sq, scale: 1.0, white: SVector::zeros(), root: SMatrix::zeros() };
    let (own, mut lesson) = (own_covariance(&hypothesis.covariance, reading), Lesson::BLANK);
    assert!(lesson.learn(&own, score, information_root, &likelihood, 1.0).is_some());
    lesson.teach(hypothesis, reading);
}

/// A score that asks for a longer step than the residual is, as of instruments that followed no road, moves the mean as far as
/// the residual and no farther, in the same direction; one that asks for less is left alone.
#[test]
fn no_step_is_longer_than_the_residual() {
    let reading = SideReading { side: Side::Left, delay_s: 0.1 };
    let moved = |times: f64, mahalanobis_sq: f64| {
        let mut bank = bank(&[0.0; 4]);
        let hypothesis = &mut bank.hypotheses[0];
        hypothesis.covariance = Covariance::of(&correlated());
        let before = hypothesis.clone();
        let information_root = Gram::<f64>::identity() * 10.0;
        let score = Score::<f64>::from_fn(|i, _| times * (i as f64 - 6.0));
        learn(hypothesis, &reading, &score, &information_root, mahalanobis_sq);
        let step = hypothesis.mean - before.mean;
        (step, step.dot(&(before.covariance.dense().try_inverse().unwrap() * step)))
    };
    let (small, length) = moved(1.0, 10.0);
    assert!(length > 0.0 && length < 10.0, "{length}");
    let (large, length) = moved(1000.0, 10.0);
    assert!((length - 10.0).abs() < 1e-9, "{length}");
    assert!((large.normalize() - small.normalize()).amax() < 1e-12);
}

/// However long nothing is learned of a car, it stays one that its file may describe.
#[test]
fn days_without_measurements_end_where_they_began() {
    let mut bank = bank(&[0.0; 4]);
    let before = prior_sd(&MASS_SD);
    let constant = |bank: &HypothesisBank<f64>, i: usize| bank.hypotheses[0].covariance[(i, i)].sqrt();
    bank.hypotheses[0].mean = State::repeat(0.01);
    // Days of tenths of a second would take long; the return is exact for any step, what is added nearly so.
    for _ in 0..4 * 24 * 360 {
        bank.hypotheses[0]
            .wander(&gaussian::Wandering::over(10.0, &gaussian::Circumstances::of_a_car(MASS_SD)));
    }
    for i in (MASS..LEVEL).filter(|i| *i != BAR + 1) {
        let after = constant(&bank, i);
        // The bias of reading is small at first.
        let expected = if (ROAD_BIAS..ROAD_BIAS + 4).contains(&i) { 0.03 } else { before[i] };
        assert!((after / expected - 1.0).abs() < 0.02, "{i}: {after} {expected}");
        // Bars and gains take more than a day; an axle is the same one for years.
        let most = if (BAR..GAIN + 2).contains(&i) { 0.3 } else { 0.02 };
        let most = if i == COUPLING { 1.0 } else { most };
        assert!(bank.hypotheses[0].mean[i] < most * 0.01, "{i}");
    }
    assert!(constant(&bank, TIRE) > 0.3);
}

/// A fifth of the pressure that all tires lose in an hour is two standard deviations; their differences stay known.
#[test]
fn tires_change_alike_further_than_each_by_itself() {
    let mut bank = bank(&[0.0; 4]);
    let before = bank.hypotheses[0].covariance.dense();
    let step = gaussian::Wandering::over(1.0, &gaussian::Circumstances::of_a_car(MASS_SD));
    (0..3600).for_each(|_| bank.hypotheses[0].wander(&step));
    let gained = bank.hypotheses[0].covariance.dense() - before;
    let tires = gained.fixed_view::<4, 4>(TIRE, TIRE).into_owned();
    let variance = |weights: [f64; 4]| {
        let weights = SVector::from(weights);
        (weights.transpose() * tires * weights)[(0, 0)]
    };
    // Their mean: 1.2e-3 in common, and half of each one's own 8e-4, times the root of 3600.
    let mean = variance([0.25; 4]).sqrt();
    assert!((mean / (60.0 * (1.2e-3f64.powi(2) + 4e-4f64.powi(2)).sqrt()) - 1.0).abs() < 1e-9, "{mean}");
    let difference = variance([1.0, 0.0, -1.0, 0.0]);
    assert!((difference / (2.0 * 3600.0 * 8e-4f64.powi(2)) - 1.0).abs() < 1e-9, "{difference}");
    // During a calibration, nothing does.
    let calibrating =
        gaussian::Circumstances { tires_set: true, ..gaussian::Circumstances::of_a_car(MASS_SD) };
    bank.hypotheses[0].wander(&gaussian::Wandering::over(60.0, &calibrating));
    assert_eq!((bank.hypotheses[0].covariance.dense() - before).fixed_view::<4, 4>(TIRE, TIRE), tires);
}

/// Friction that is not known is another damping and another spring within ten minutes, and no more than what the file has it be.
#[test]
fn friction_that_is_not_known_widens_struts() {
    let mut bank = bank(&[0.0; 4]);
    let before = bank.hypotheses[0].covariance.dense();
    // The front right corner's damping and spring: 0.4 and 0.3 besides what the file leaves.
    let mut circumstances = gaussian::Circumstances::of_a_car(MASS_SD);
    circumstances.friction_error[1] = gaussian::FrictionError { damping: 0.16, spring: 0.09, damped: 0.0 };
    let variance =
        |bank: &HypothesisBank<f64>, i: usize| bank.hypotheses[0].covariance[(i, i)] - before[(i, i)];
    let wander = |bank: &mut HypothesisBank<f64>, seconds: usize, steps: usize| {
        let step = gaussian::Wandering::over(seconds as f64 / steps as f64, &circumstances);
        (0..steps).for_each(|_| bank.hypotheses[0].wander(&step));
    };
    wander(&mut bank, 600, 6000);
    for (at, besides) in [(DAMPING + 1, 0.16), (SPRING + 1, 0.09)] {
        let share = variance(&bank, at) / besides;
        assert!((0.5..1.0).contains(&share), "{at}: {share}");
    }
    // The others wander as ever: not by a hundredth of their own variance in ten minutes.
    for at in [DAMPING, DAMPING + 2, SPRING, SPRING + 3] {
        assert!(variance(&bank, at).abs() < 0.01 * before[(at, at)], "{at}");
    }
    wander(&mut bank, 10_000, 100_000);
    for (at, besides) in [(DAMPING + 1, 0.16), (SPRING + 1, 0.09)] {
        assert!((variance(&bank, at) / besides - 1.0).abs() < 0.01, "{at}");
    }
    wander(&mut bank, 36_000, 36_000);
    // What the shared road reads too much does not depend on friction: within ten hours to 3 % from 1.5 %, by 1 - e^-2 of the difference of
    // the squares.
    let alone = bank.hypotheses[0].covariance[(ROAD_BIAS, ROAD_BIAS)];
    let expected =
        0.03f64.powi(2) - (0.03f64.powi(2) - 0.015f64.powi(2)) * (-2.0 * 46_600.0 / 36_000.0f64).exp();
    assert!((alone / expected - 1.0).abs() < 0.01, "{alone} {expected}");
}

/// Where roads differ beliefs fade, those of a calibrated car a third as far, and only those of the side.
#[test]
fn a_calibrated_belief_fades_less() {
    let grown = |calibrated| {
        let mut bank = bank(&[0.0; 4]);
        let before = bank.constant().1;
        [Corner::FrontLeft, Corner::RearLeft]
            .into_iter()
            .for_each(|corner| bank.inflate(corner, 4.0, calibrated));
        let after = bank.constant().1;
        core::array::from_fn::<f64, 4, _>(|i| (after[TIRE + i].powi(2) - before[TIRE + i].powi(2)).sqrt())
    };
    for (calibrated, expected) in [(false, 0.06), (true, 0.02)] {
        let [fl, fr, rl, rr] = grown(calibrated);
        assert!((fl - expected).abs() < 1e-9 && (rl - expected).abs() < 1e-9, "{calibrated}: {fl} {rl}");
        assert_eq!([fr, rr], [0.0; 2]);
    }
}

/// A tire that seems softer than flat is flat, and the others are what they were; what is no number is not sound.
#[test]
fn no_tire_is_softer_than_flat() {
    let softest = [3.0, 6.0, 3.0, 3.0];
    let mut bank = bank(&[3.5, 5.0, 0.1, 0.0]);
    let before = bank.hypotheses[0].clone();
    bank.drop_impossible(&softest);
    let constant = &bank.hypotheses[0];
    assert_eq!(constant.mean.as_slice()[..4], [3.0, 5.0, 0.1, 0.0]);
    assert!((constant.covariance[(0, 0)] - before.covariance[(0, 0)] - 0.25).abs() < 1e-12);
    assert!(bank.is_sound(&softest));
    bank.hypotheses[0].mean[1] = f64::NAN;
    bank.drop_impossible(&softest);
    assert!(!bank.is_sound(&softest));
}

/// Two of a side may lose pressure together, but axles that leave each other's track must not look like filled tires.
#[test]
fn several_are_not_filled_while_they_roll() {
    const SEVERAL: [usize; 2] = [5, 6];
    let cases = [(0.05, true), (-0.05, false), (f64::NAN, false)];
    for (several, (rate, followed)) in
        SEVERAL.into_iter().flat_map(|hypothesis| cases.map(|case| (hypothesis, case)))
    {
        let mut bank = bank(&[0.0; 4]);
        bank.hypotheses[0].weight = 0.1;
        bank.hypotheses[several].weight = 0.9;
        bank.hypotheses[several].mean[RATE] = rate;
        bank.drop_impossible(&[3.0; 4]);
        let expected = if followed { [0.1, 0.9] } else { [1.0, 0.0] };
        assert_eq!([bank.hypotheses[0].weight, bank.hypotheses[several].weight], expected, "{rate}");
    }
}

/// The bound on a tire's loss is met by the likeliest state that it allows: the gradient of the squared distance from the
/// mean has, at the projection, no part but along the bound. The covariance stays, and so does a hypothesis that meets it.
#[test]
fn a_bound_is_met_by_the_likeliest_state() {
    let mut bank = bank(&[-0.2, 0.1, 0.0, 0.0]);
    for hypothesis in &mut bank.hypotheses {
        hypothesis.covariance = Covariance::of(&correlated());
    }
    let before = bank.clone();
    bank.hold_above(Some(&Floor::alone([Some(-0.05), Some(-0.05), None, None])), false);
    for (index, (after, before)) in bank.hypotheses.iter().zip(&before.hypotheses).enumerate() {
        assert_eq!(after.covariance, before.covariance);
        if index == RANDOM_WALK {
            assert_eq!(after.mean, before.mean, "may have been filled");
            continue;
        }
        assert!((after.loss(Corner::FrontLeft) + 0.05).abs() < 1e-12);
        let gradient = before.covariance.dense().try_inverse().unwrap() * (after.mean - before.mean);
        let along = gradient[TIRE];
        assert!(along > 0.0 && (gradient[LEVEL] / along + 1.0).abs() < 1e-9);
        for i in (0..SIZE).filter(|&i| i != TIRE && i != LEVEL) {
            assert!(gradient[i].abs() < 1e-9 * along, "{i}: {} of {along}", gradient[i]);
        }
    }
    let held = bank.clone();
    bank.hold_above(Some(&Floor::alone([Some(-0.05), None, None, None])), false);
    assert_eq!(bank, held);
}

/// What lies beyond a bound is not believed: a hypothesis that has its mean there, by so many standard deviations, loses weight as the
/// tail of the normal distribution tells (values of its tables), against one that has it at the bound.
#[test]
fn belief_beyond_a_bound_is_lost() {
    const TAILS: [(f64, f64); 4] =
        [(0.0, 0.5), (1.0, 0.158_655_25), (2.0, 0.022_750_13), (4.0, 3.167_124e-5)];
    for (deviations, tail) in TAILS {
        // Nothing moves, and the tire stands at its bound; one wheel loses air, and is beyond; or it would gain air.
        let floor = Floor::alone([None, Some(-0.1), None, None]);
        for (quantity, floor) in [(TIRE + 1, Some(&floor)), (RATE, None)] {
            let mut bank = bank(&[0.0, -0.1, 0.0, 0.0]);
            (bank.hypotheses[CONSTANT].weight, bank.hypotheses[2].weight) = (0.4, 0.6);
            let moving = &mut bank.hypotheses[2];
            moving.mean[RATE] = 0.0;
            moving.mean[quantity] -= deviations * moving.covariance[(quantity, quantity)].sqrt();
            bank.hold_above(floor, false);
            let expected = 2.0 * tail * 0.6 / (0.4 + 2.0 * tail * 0.6);
            let held = bank.hypotheses[2].weight;
            assert!((held / expected - 1.0).abs() < 0.02, "{deviations}: {held} and {expected}");
            assert!((bank.hypotheses[CONSTANT].weight + held - 1.0).abs() < 1e-12);
        }
    }
}

/// A pump fills a tire on the way.
#[test]
fn a_single_tire_gains_air_only_from_a_pump() {
    for (filling, rate) in [(true, -0.05), (false, 0.0)] {
        let mut bank = bank(&[0.0; 4]);
        for hypothesis in &mut bank.hypotheses {
            hypothesis.mean[RATE] = -0.05;
        }
        bank.hold_above(None, filling);
        assert!(bank.hypotheses[1..SIDE].iter().all(|single| (single.mean[RATE] - rate).abs() < 1e-15));
    }
}

/// A car whose tires only lose air while they roll: once their losses are counted none is believed to wander, unless a pump may fill it.
#[test]
fn tires_do_not_wander_while_their_losses_are_counted() {
    for (counted, inflation, wanders) in [
        (false, Inflation::AtStops, true),
        (true, Inflation::AtStops, false),
        (true, Inflation::WhileRolling, true),
    ] {
        let config = CarConfig { corners: [Some(CornerConfig::paper()); 4], wheelbase_m: Some(2.7) };
        let mut belief = configured(|belief: &mut Belief<f64>| belief.configure(&config));
        belief.set_inflation(inflation);
        let onset = Onset { rates: [0.0; 4], longest_step_s: 1.0 };
        belief.predict(0.0, &onset);
        belief.settle(if counted { 30.0 } else { 10.0 });
        (1..50).for_each(|step| belief.predict(0.1 * f64::from(step), &onset));
        assert_eq!(belief.bank.hypotheses[RANDOM_WALK].weight > 0.0, wanders, "{counted} {inflation:?}");
        assert!(belief.bank.hypotheses[1].weight > 0.0);
    }
}
