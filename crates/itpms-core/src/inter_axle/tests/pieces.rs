//! DelayLine, instrument, and what is left of knowledge.

use core::f64::consts::TAU;

use nalgebra::{ComplexField, SMatrix};

use crate::belief::hypothesis_bank::HypothesisBank;
use crate::belief::state::{
    BAR, Covariance, GAIN, MASS, RATE, ROAD_BIAS, SIZE, State, TIRE, prior_sd, read_compliance,
};
use crate::belief::update::{Likelihood, OwnCovariance};
use crate::inter_axle::BINS;
use crate::inter_axle::alignment::channel::Entry;
use crate::inter_axle::alignment::delay_line::DelayLine;
use crate::inter_axle::residual::instrument::Instrument;
use crate::inter_axle::residual::model::{Axle, Gram, OWN, OWN_TIRES, Score, places};
use crate::inter_axle::tests::{C, Moved, PERIOD_S, SETTLED, deviating, signals, wheels};

/// A car that gains 3 m/s², as far as it came and as fast as it is.
fn distance_m(time_s: f64) -> f64 {
    10.0 * time_s + 1.5 * time_s * time_s
}

fn remembered(signal: impl Fn(f64) -> f64) -> DelayLine<f64> {
    let mut delay_line = DelayLine::new(PERIOD_S);
    for k in 0..400 {
        let time_s = f64::from(k) * PERIOD_S;
        delay_line.push(&Entry {
            time_s,
            distance_m: distance_m(time_s),
            speed_m_s: 10.0 + 3.0 * time_s,
            signals: [signal(time_s), 1.0, 2.0 * time_s, -signal(time_s)],
            invalid: k == 300,
            unloaded: k == 300,
            after_gap: k == 0,
        });
    }
    delay_line
}

#[test]
fn the_time_at_a_place_is_right_at_changing_speed() {
    let delay_line = remembered(|_| 0.0);
    // Straight lines of 4 ms through a parabola of 3 m/s²: off by a dt²/8 = 6e-6 m at most, at 12 m/s or more 0.5 µs.
    for k in 0..200 {
        let time_s = 0.7 + 0.0043 * f64::from(k);
        let found_s = delay_line.time_at(distance_m(time_s)).unwrap();
        assert!((found_s - time_s).abs() < 5.1e-7, "{}", found_s - time_s);
    }
}

#[test]
fn places_not_remembered_have_no_time() {
    let delay_line = remembered(|_| 0.0);
    // 256 entries: back to 1.596 - 1.02 s.
    assert!(delay_line.time_at(distance_m(0.5)).is_none());
    assert!(delay_line.time_at(distance_m(1.6)).is_none());
    assert!(delay_line.time_at(f64::NAN).is_none());
    assert!(delay_line.read(0.5).is_none());
    assert!(delay_line.read(1.595).is_none(), "less than two entries on the young side");
    assert!(delay_line.read(f64::NAN).is_none());
}

#[test]
fn six_points_read_a_polynomial_of_fifth_degree() {
    let signal = |t: f64| 1.0 + t * (2.0 + t * (-3.0 + t * (1.0 + t * (0.5 - t))));
    let delay_line = remembered(signal);
    for k in 0..150 {
        let time_s = 0.7 + 0.00571 * f64::from(k);
        let read = delay_line.read(time_s).unwrap();
        // The values are about one, the weights below two.
        assert!((read.signals[0] - signal(time_s)).abs() < 1e-11);
        assert!((read.signals[2] - 2.0 * time_s).abs() < 1e-12);
    }
}

#[test]
fn six_points_read_the_highest_bin() {
    let w = TAU * 25.0;
    let delay_line = remembered(|t| (w * t).sin());
    // (w dt)⁶ / 6! times the largest |(x+2)(x+1) x (x-1)(x-2)(x-3)| between 0 and 1, 225/64.
    let bound = (w * PERIOD_S).powi(6) / 720.0 * 225.0 / 64.0;
    let mut worst = 0.0f64;
    for k in 0..500 {
        let time_s = 0.7 + 0.0017 * f64::from(k);
        worst = worst.max((delay_line.read(time_s).unwrap().signals[0] - (w * time_s).sin()).abs());
    }
    assert!(worst < bound && worst > 0.8 * bound, "{worst:e} of {bound:e}");
}

#[test]
fn what_was_spoiled_is_read_as_spoiled() {
    let delay_line = remembered(|t| t);
    let at = |entry: f64| delay_line.read(entry * PERIOD_S).unwrap().invalid;
    assert!(at(300.5) && at(299.5) && at(297.5) && at(302.5));
    assert!(!at(296.5) && !at(303.5));
    let unloaded = |entry: f64| delay_line.read(entry * PERIOD_S).unwrap().unloaded;
    assert!(unloaded(300.5) && unloaded(299.5) && !unloaded(301.5) && !unloaded(298.5));
}

#[test]
fn the_instrument_is_the_quarter_car() {
    let mut state = deviating();
    state[BAR] = 0.0;
    state[BAR + 1] = 0.0;
    for wheel in wheels() {
        for frequency_hz in [1.0, 5.0, 9.7, 12.0, 25.0] {
            let mut instrument = Instrument::new();
            instrument.tune(&Axle::new(&wheel, &state), wheel.body.sprung_mass_kg, PERIOD_S);
            // The bilinear rule is exact at another frequency: s = 2/dt i tan(pi f dt).
            let s = C::new(0.0, 2.0 / PERIOD_S * (0.5 * TAU * frequency_hz * PERIOD_S).tan());
            let unit = signals(&wheel, &state, s, Moved::by_road(C::new(1.0, 0.0)));
            let mut worst = 0.0f64;
            for step in -4 * SETTLED..100 {
                let turn = C::new(0.0, TAU * frequency_hz * f64::from(step) * PERIOD_S).exp();
                let seen = instrument.push(turn.re);
                for (seen, unit) in seen.iter().zip(unit).filter(|_| step >= 0) {
                    worst = worst.max((seen - (unit * turn).re).abs() / unit.modulus());
                }
            }
            // After 24 seconds e^{-31} of a body that swings 1.3 times a second into rest is left of how it began.
            assert!(worst < 1e-8, "{frequency_hz} Hz: {worst:e}");
        }
    }
}

/// Any belief with correlations: a sum of squares.
fn correlated() -> Covariance<f64> {
    let mixing = Covariance::<f64>::from_fn(|i, j| ((7 * i + 3 * j) % 11) as f64 / 11.0 - 0.4);
    mixing * mixing.transpose() * 1e-3 + Covariance::identity() * 1e-3
}

/// A frame says the same of a tire and of what the shared road reads too much of it: the short way of learning from it against
/// the information of all quantities, inverted whole.
#[test]
fn a_frame_tells_the_sum_of_tire_and_bias() {
    let side = 1;
    let mut bank = HypothesisBank::<f64>::new(&[0.0; 4]);
    let hypothesis = &mut bank.bank[0];
    hypothesis.covariance = correlated();
    let root = Gram::<f64>::from_fn(|i, j| ((5 * i + 2 * j) % 13) as f64 / 13.0 - 0.5);
    let information = root * root.transpose() * 300.0;
    let score = Score::<f64>::from_fn(|i, _| 10.0 * (i as f64 - 6.0));
    let before = hypothesis.clone();
    OwnCovariance::new(&hypothesis.covariance, side).learn(
        hypothesis,
        &score,
        &information,
        &surprised(1e6),
        1.0,
    );

    let mut reads = SMatrix::<f64, OWN, SIZE>::zeros();
    for (own, place) in places(side).into_iter().enumerate() {
        reads[(own, place)] = 1.0;
    }
    for (own, corner) in OWN_TIRES.into_iter().zip([side, side + 2]) {
        reads[(own, ROAD_BIAS + corner)] = 1.0;
    }
    let inverse = before.covariance.try_inverse().unwrap();
    let covariance = (inverse + reads.transpose() * information * reads).try_inverse().unwrap();
    let mean = before.mean + covariance * reads.transpose() * score;
    assert!((hypothesis.covariance - covariance).amax() < 1e-10 * covariance.amax());
    assert!((hypothesis.mean - mean).amax() < 1e-9 * mean.amax());
    // The axle has it so, too.
    let mut state = State::zeros();
    state[TIRE + 3] = 0.1;
    state[ROAD_BIAS + 3] = -0.02;
    assert!((read_compliance(&state, 3) - 1.08f64).abs() < 1e-15);
}

/// A frame whose disagreement has this square over its standard deviations.
fn surprised(mahalanobis_sq: f64) -> Likelihood<f64> {
    Likelihood { log: 0.0, mahalanobis_sq, scale: 1.0, ratio: [1.0; BINS] }
}

/// A score that asks for more than the frame surprises, as of instruments that heard no road, moves the mean as far as that and
/// no farther, in the same direction; one that asks for less is left alone.
#[test]
fn no_step_is_longer_than_the_surprise() {
    let side = 0;
    let moved = |times: f64, mahalanobis_sq: f64| {
        let mut bank = HypothesisBank::<f64>::new(&[0.0; 4]);
        let hypothesis = &mut bank.bank[0];
        hypothesis.covariance = correlated();
        let before = hypothesis.clone();
        let information = Gram::<f64>::identity() * 100.0;
        let score = Score::<f64>::from_fn(|i, _| times * (i as f64 - 6.0));
        let own = OwnCovariance::new(&hypothesis.covariance, side);
        own.learn(hypothesis, &score, &information, &surprised(mahalanobis_sq), 1.0);
        let step = hypothesis.mean - before.mean;
        (step, step.dot(&(before.covariance.try_inverse().unwrap() * step)))
    };
    let (small, length) = moved(1.0, 10.0);
    assert!(length > 0.0 && length < 10.0, "{length}");
    let (large, length) = moved(1000.0, 10.0);
    assert!((length - 10.0).abs() < 1e-9, "{length}");
    assert!((large.normalize() - small.normalize()).amax() < 1e-12);
}

/// However long nothing is learned of a car, it stays one that its file may describe.
#[test]
fn days_without_evidence_end_where_they_began() {
    let mut bank = HypothesisBank::<f64>::new(&[0.0; 4]);
    let before = prior_sd::<f64>();
    let constant = |bank: &HypothesisBank<f64>, i: usize| bank.bank[0].covariance[(i, i)].sqrt();
    bank.bank[0].mean = State::repeat(0.01);
    // Days of tenths of a second would take long; the return is exact for any step, what is added nearly so.
    for _ in 0..4 * 24 * 360 {
        bank.bank[0].wander(10.0);
    }
    for i in (MASS..RATE).filter(|i| *i != BAR + 1) {
        let after = constant(&bank, i);
        // What the shared road reads too much is small at first.
        let expected = if (ROAD_BIAS..ROAD_BIAS + 4).contains(&i) { 0.03 } else { before[i] };
        assert!((after / expected - 1.0).abs() < 0.02, "{i}: {after} {expected}");
        // Bars and gains take more than a day.
        let most = if (BAR..GAIN + 2).contains(&i) { 0.3 } else { 0.02 };
        assert!(bank.bank[0].mean[i] < most * 0.01, "{i}");
    }
    assert!(constant(&bank, TIRE) > 0.3);
}

/// Where roads differ beliefs fade, those of a car that was taught a third as far, and only those of the side.
#[test]
fn what_was_taught_fades_less() {
    let grown = |calibrated| {
        let mut bank = HypothesisBank::<f64>::new(&[0.0; 4]);
        let before = bank.constant().1;
        wheels().iter().for_each(|wheel| bank.inflate(wheel.corner, 4.0, calibrated));
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
    let mut bank = HypothesisBank::<f64>::new(&[3.5, 5.0, 0.1, 0.0]);
    let before = bank.bank[0].clone();
    bank.drop_impossible(&softest);
    let constant = &bank.bank[0];
    assert_eq!(constant.mean.as_slice()[..4], [3.0, 5.0, 0.1, 0.0]);
    assert!((constant.covariance[(0, 0)] - before.covariance[(0, 0)] - 0.25).abs() < 1e-12);
    assert!(bank.is_sound(&softest));
    bank.bank[0].mean[1] = f64::NAN;
    bank.drop_impossible(&softest);
    assert!(!bank.is_sound(&softest));
}

/// Two of a side or all four may lose pressure together, but roads that part must not look like tires that are filled.
#[test]
fn several_are_not_filled_while_they_roll() {
    const SEVERAL: [usize; 3] = [5, 6, 7];
    let cases = [(0.05, true), (-0.05, false), (f64::NAN, false)];
    for (several, (rate, followed)) in
        SEVERAL.into_iter().flat_map(|hypothesis| cases.map(|case| (hypothesis, case)))
    {
        let mut bank = HypothesisBank::<f64>::new(&[0.0; 4]);
        bank.bank[0].weight = 0.1;
        bank.bank[several].weight = 0.9;
        bank.bank[several].mean[RATE] = rate;
        bank.drop_impossible(&[3.0; 4]);
        let expected = if followed { [0.1, 0.9] } else { [1.0, 0.0] };
        assert_eq!([bank.bank[0].weight, bank.bank[several].weight], expected, "{rate}");
    }
}
