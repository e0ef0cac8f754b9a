//! The axles' residual: exact signals, derivatives, expectations, and roads that are not quite the same.

use crate::inter_axle::tests::std::vec::Vec;

use nalgebra::Complex;
// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use crate::belief::measurement::{BINS, Gram, Products, Score, Slope};
use crate::belief::state::{BAR, COUPLING, GAIN, SIDE_SIZE, SKEW, State, WHEELBASE, side_indices};
use crate::cholesky;
use crate::inter_axle::alignment::channel::BOTH;
use crate::inter_axle::bin_hz;
use crate::inter_axle::residual::correction::FrfRatios;
use crate::inter_axle::residual::model::{AxleFrame, Signals, UnitRoad, linearize};
use crate::inter_axle::tests::{C, Moved, STILL, deviating, frame, signals, taken, unit_frames, wheels};
use crate::model::Side;
use crate::random::Random;
use crate::spectrum::front_end::high_pass_power;

const ONE: C = C::new(1.0, 0.0);

/// Axles that answer as their quarter cars do.
fn same() -> FrfRatios<f64> {
    [[ONE; BOTH]; BINS]
}

fn sum<'a>(parts: impl Iterator<Item = (f64, &'a AxleFrame<f64>)>) -> AxleFrame<f64> {
    let mut total: Option<AxleFrame<f64>> = None;
    for (weight, part) in parts {
        let total = total.get_or_insert_with(|| {
            let mut zero = part.frame.clone();
            zero.re *= 0.0;
            zero.im *= 0.0;
            taken(zero)
        });
        total.frame.re += part.frame.re * weight;
        total.frame.im += part.frame.im * weight;
    }
    total.unwrap()
}

/// Some frequencies of both axles on one road, the other side moving anyhow.
fn on_one_road(state: &State<f64>) -> AxleFrame<f64> {
    let frames: Vec<_> = [3.1, 6.0, 9.4, 12.7, 18.8, 24.0]
        .iter()
        .enumerate()
        .map(|(i, &f)| {
            let road = C::new(0.0, 1.7 * i as f64).exp();
            let other = [C::new(0.3, -0.2 * i as f64), C::new(-0.1, 0.4)];
            let other_jerk = C::new(-2e3, 7e2 * i as f64);
            frame(f, other.map(|other| Moved { road, other, other_jerk }), state, ONE)
        })
        .collect();
    sum(frames.iter().map(|frame| (1.0, frame)))
}

#[test]
fn on_one_road_nothing_is_left() {
    let state = deviating();
    let found = linearize(&on_one_road(&state), Signals::Measured, &wheels(), Side::Left, &state);
    for bin in 0..BINS {
        let left = found.rows[bin].hypot(found.rows[BINS + bin]);
        assert!(left < 1e-11 * found.road_power[bin].sqrt(), "bin {bin}: {left:e}");
    }
    // And with any one quantity wrong by 5 %, something is.
    for place in side_indices(Side::Left).into_iter().filter(|&place| place != SKEW) {
        let mut wrong = state;
        wrong[place] += 0.05;
        let found = linearize(&on_one_road(&state), Signals::Measured, &wheels(), Side::Left, &wrong);
        assert!(found.rows.norm() > 1e-4 * found.road_power.iter().sum::<f64>().sqrt(), "{place}");
    }
}

#[test]
fn derivatives_match_finite_differences() {
    let taken = on_one_road(&deviating());
    // Not at the truth, where the turning road would be the only one there is; in step with the alignment, as
    // the derivative of the turn by anything but the delay is left out.
    let mut state = deviating() * 0.4;
    state[WHEELBASE] = taken.used_wheelbase;
    state[SKEW] = taken.used_skew;
    let slope = linearize(&taken, Signals::Measured, &wheels(), Side::Left, &state).slope;
    for (column, place) in side_indices(Side::Left).into_iter().enumerate() {
        let step = 1e-4;
        let at = |by: f64| {
            let mut moved = state;
            moved[place] += by;
            linearize(&taken, Signals::Measured, &wheels(), Side::Left, &moved).rows
        };
        // Linear in every quantity by itself, so rounding is all there is: 1e-16 over the step.
        let difference = (at(step) - at(-step)) / (2.0 * step);
        let off = (difference - slope.column(column)).norm();
        assert!(off < 1e-9 * slope.column(column).norm(), "{column}: {off:e}");
    }
}

#[test]
fn expected_products_are_those_of_a_long_random_road() {
    // No bars, as the other side's answer to this side's road is left out, and no gain, as it is in the road's power.
    let mut state = deviating();
    for place in [BAR, BAR + 1, COUPLING, GAIN] {
        state[place] = 0.0;
    }
    let other_side = |f: f64| {
        let s = C::new(0.0, core::f64::consts::TAU * f);
        wheels().map(|wheel| {
            let seen = signals(&wheel, &state, s, Moved::by_road(ONE));
            [seen[3], seen[1]]
        })
    };
    let left = |f: f64| ONE * high_pass_power(f).sqrt();
    // On a road that is white before the signals' high-pass every frequency has a random amplitude of its own, so products average to the sum of those of
    // unit cosines and sines; the other side's road is another one.
    let mut products = [Gram::zeros(); BINS];
    let mut power = [0.0; BINS];
    let beside = |f: f64| {
        other_side(f).map(|[other, other_jerk]| Moved {
            road: C::new(0.0, 0.0),
            other: other * left(f),
            other_jerk: other_jerk * left(f),
        })
    };
    let own = unit_frames(&state, |f| [Moved::by_road(left(f)); 2]);
    for taken in own.iter().chain(&unit_frames(&state, beside)) {
        let found = linearize(taken, Signals::Measured, &wheels(), Side::Left, &state);
        for bin in 0..BINS {
            for row in [bin, BINS + bin] {
                let slope = found.slope.row(row);
                products[bin] += slope.transpose() * slope;
            }
            power[bin] += found.road_power[bin];
        }
    }
    let (wheels, ratios, packed) = (wheels(), same(), cholesky::packed::<SIDE_SIZE>);
    let road = UnitRoad::new(&wheels, Side::Left, &state, &ratios);
    let expected: [Products<f64>; BINS] = core::array::from_fn(|bin| road.expected_products(bin));
    for bin in 0..BINS {
        for i in 0..SIDE_SIZE {
            for j in 0..=i {
                let found = products[bin][(i, j)] / power[bin];
                let scale = (expected[bin][packed(i, i)] * expected[bin][packed(j, j)]).sqrt();
                let off = (found - expected[bin][packed(i, j)]) / scale;
                // Nine points, 2.5 Hz apart, stand for the window: as far apart as wheel hop is wide, so the peak counts
                // some 15 % too much or too little, and what comes through the window's skirt into the first bin more.
                assert!(off.abs() < 0.25, "bin {bin} {i} {j}: {off}");
            }
        }
    }
}

/// `sum Re(slope* e)` of every quantity, all bins alike.
fn pull(rows: &nalgebra::SVector<f64, { 2 * BINS }>, slope: &Slope<f64>) -> Score<f64> {
    slope.transpose() * rows
}

#[test]
fn roads_that_differ_do_not_pull_the_instruments() {
    let state = deviating();
    let share = 0.3;
    let fronts = unit_frames(&state, |_| [Moved::by_road(ONE), STILL]);
    let rears = unit_frames(&state, |_| [STILL, Moved::by_road(ONE)]);
    let mut random = Random(7);
    let frames = 1500;
    let mut sums = [[Score::zeros(); 2]; 2];
    for _ in 0..frames {
        let mut parts = Vec::new();
        for (front, rear) in fronts.iter().zip(&rears) {
            let common = (1.0f64 - 0.5 * share).sqrt() * random.normal();
            let own = (0.5f64 * share).sqrt();
            parts.push((common + own * random.normal(), front));
            parts.push((common + own * random.normal(), rear));
        }
        let taken = sum(parts.into_iter());
        let measured = linearize(&taken, Signals::Measured, &wheels(), Side::Left, &state);
        let instrument = linearize(&taken, Signals::Common(&same()), &wheels(), Side::Left, &state).slope;
        for (sums, slope) in sums.iter_mut().zip([&measured.slope, &instrument]) {
            let pull = pull(&measured.rows, slope);
            sums[0] += pull;
            sums[1] += pull.component_mul(&pull);
        }
    }
    let standard_errors = sums.map(|[sum, square]| {
        let n = f64::from(frames);
        (sum / n).zip_map(&square, |mean, square| mean / ((square / n - mean * mean) / n).sqrt())
    });
    // Thirteen means of nothing within three standard errors; the plain derivatives of both tires far out.
    let [plain, instrument] = standard_errors;
    assert!(instrument.amax() < 3.0, "{instrument}");
    assert!(plain[0].abs() > 10.0 && plain[5].abs() > 10.0, "{plain}");
}

#[test]
fn plain_derivatives_are_pulled_by_half_the_incoherent_power() {
    let state = State::zeros();
    // What only the front meets: the frame's products are half of kappa S, times T = 1 - 1/H of its tire.
    let fronts = unit_frames(&state, |_| [Moved::by_road(ONE), STILL]);
    let (mut pull, mut power) = ([0.0; BINS], [0.0; BINS]);
    for taken in &fronts {
        let found = linearize(taken, Signals::Measured, &wheels(), Side::Left, &state);
        for bin in 0..BINS {
            pull[bin] += found.rows[bin] * found.slope[(bin, 0)]
                + found.rows[BINS + bin] * found.slope[(BINS + bin, 0)];
            power[bin] += 2.0 * found.road_power[bin];
        }
    }
    for bin in [0, 2, 4] {
        // The window averages the transfer over its main lobe.
        let mut mean = (0.0, 0.0);
        for k in 1..=100 {
            let f = 0.5 * f64::from(k);
            let weight = crate::spectrum::transfer::sine_window_power((f - bin_hz::<f64>(bin)) / 5.0);
            let s = Complex::new(0.0, core::f64::consts::TAU * f);
            let over_road = 1.0 - signals(&wheels()[0], &state, s, Moved::by_road(ONE))[0].re;
            mean = (mean.0 + weight * over_road, mean.1 + weight);
        }
        let (found, expected) = (pull[bin] / power[bin], mean.0 / mean.1);
        // The sum over half hertz is not the integral, and a real signal has its image at negative frequencies.
        assert!((found - expected).abs() < 0.03, "bin {bin}: {found} {expected}");
    }
}
