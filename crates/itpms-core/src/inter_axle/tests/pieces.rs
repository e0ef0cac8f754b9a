//! Delay line and instrument.

use core::f64::consts::TAU;

use nalgebra::ComplexField;

use crate::belief::state::{BAR, COUPLING, DAMPING, MASS, State};
use crate::inter_axle::alignment::channel::Entry;
use crate::inter_axle::alignment::delay_line::{DelayLine, Read};
use crate::inter_axle::alignment::way::Way;
use crate::inter_axle::residual::instrument::{Instrument, of_both_wheels};
use crate::inter_axle::residual::model::{Axle, Mode, Wheel};
use crate::inter_axle::tests::{C, Moved, PERIOD_S, SETTLED, STILL, deviating, signals, wheels};
use crate::memory::{Blank, configured};

/// A car that gains 3 m/s², as far as it came and as fast as it is.
fn way(time_s: f64) -> Way {
    Way::BLANK.ahead(10.0 * time_s + 1.5 * time_s * time_s)
}

fn read(delay_line: &DelayLine<f64>, time_s: f64) -> Option<Read<f64>> {
    delay_line.read_back(delay_line.steps_back(time_s))
}

fn remembered(signal: impl Fn(f64) -> f64) -> DelayLine<f64> {
    let mut delay_line = configured(|line: &mut DelayLine<f64>| line.configure(PERIOD_S));
    for k in 0..400 {
        let time_s = f64::from(k) * PERIOD_S;
        let entry = Entry {
            time_s,
            way: Some(way(time_s)),
            speed_m_s: 10.0 + 3.0 * time_s,
            signals: [signal(time_s), 1.0, 2.0 * time_s, -signal(time_s)],
            invalid: k == 300,
            unloaded: k == 300,
            after_gap: k == 0,
        };
        delay_line.push(&entry, way(time_s));
    }
    delay_line
}

#[test]
fn the_time_at_a_place_is_right_at_changing_speed() {
    let delay_line = remembered(|_| 0.0);
    // Straight lines of 4 ms through a parabola of 3 m/s²: off by a dt²/8 = 6e-6 m at most, at 12 m/s or more 0.5 µs; three
    // places rounded to 1.2e-7 m.
    for k in 0..200 {
        let time_s = 0.7 + 0.0043 * f64::from(k);
        let found_s = delay_line.newest_s() - PERIOD_S * delay_line.steps_back_at(way(time_s)).unwrap();
        assert!((found_s - time_s).abs() < 5.3e-7, "{}", found_s - time_s);
    }
}

#[test]
fn places_not_remembered_have_no_time() {
    let delay_line = remembered(|_| 0.0);
    // 256 entries: back to 1.596 - 1.02 s.
    assert!(delay_line.steps_back_at(way(0.5)).is_none());
    assert!(delay_line.steps_back_at(way(1.6)).is_none());
    assert!(read(&delay_line, 0.5).is_none());
    assert!(read(&delay_line, 1.595).is_none(), "less than two entries on the young side");
    assert!(read(&delay_line, f64::NAN).is_none());
}

#[test]
fn six_points_read_a_polynomial_of_fifth_degree() {
    let signal = |t: f64| 1.0 + t * (2.0 + t * (-3.0 + t * (1.0 + t * (0.5 - t))));
    let delay_line = remembered(signal);
    for k in 0..150 {
        let time_s = 0.7 + 0.00571 * f64::from(k);
        let read = read(&delay_line, time_s).unwrap();
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
        worst = worst.max((read(&delay_line, time_s).unwrap().signals[0] - (w * time_s).sin()).abs());
    }
    assert!(worst < bound && worst > 0.8 * bound, "{worst:e} of {bound:e}");
}

#[test]
fn invalid_entries_are_read_as_invalid() {
    let delay_line = remembered(|t| t);
    let at = |entry: f64| read(&delay_line, entry * PERIOD_S).unwrap().invalid;
    assert!(at(300.5) && at(299.5) && at(297.5) && at(302.5));
    assert!(!at(296.5) && !at(303.5));
    let unloaded = |entry: f64| read(&delay_line, entry * PERIOD_S).unwrap().unloaded;
    assert!(unloaded(300.5) && unloaded(299.5) && !unloaded(301.5) && !unloaded(298.5));
}

#[test]
fn the_instrument_is_the_quarter_car() {
    let mut state = deviating();
    state[BAR] = 0.0;
    state[BAR + 1] = 0.0;
    state[COUPLING] = 0.0;
    let plain = wheels().map(|wheel| (wheel, state, state, Mode::Together));
    let [_, rear] = wheels();
    let mut coupled = state;
    coupled[COUPLING] = 0.15;
    // Against each other the wheels have less mass by twice that.
    let mut lighter = state;
    lighter[MASS + rear.corner.index()] -= 0.3;
    // So much was taken out for friction that a damper which drives its wheel stands for the rest.
    let sticking = plain.map(|(wheel, mut state, _, mode)| {
        state[DAMPING + wheel.corner.index()] = -1.3;
        (Wheel { friction_n_s_per_m: 1.1 * wheel.body.damping_n_s_per_m, ..wheel }, state, state, mode)
    });
    let against = [(rear, coupled, lighter, Mode::Against)];
    for (wheel, configured, state, mode) in plain.into_iter().chain(sticking).chain(against) {
        for frequency_hz in [1.0, 5.0, 9.7, 12.0, 25.0] {
            let mut instrument = Instrument::new();
            instrument.tune(&Axle::new(&wheel, &configured), mode, wheel.body.sprung_mass_kg, PERIOD_S);
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

/// Two equal wheels on a rod of length `t`, mass `M` and inertia `J` about its middle: as both move alike each carries `M/2`, against each
/// other `J/(t/2)²/2`. A uniform rod, `J = M t²/12`, leaves a third of the mass.
#[test]
fn a_uniform_rod_has_a_third_of_its_mass_in_roll() {
    let [_, wheel] = wheels();
    let mut state = State::zeros();
    state[COUPLING] = 1.0 / 3.0;
    let axle = Axle::new(&wheel, &state);
    let (length_m, mass_kg) = (1.6, 2.0 * wheel.body.unsprung_mass_kg);
    let inertia = mass_kg * length_m * length_m / 12.0;
    let against = inertia / (0.5 * length_m).powi(2) / 2.0;
    assert!((axle.mode_mass_kg(Mode::Against) - against).abs() < 1e-9);
    assert!((axle.mode_mass_kg(Mode::Together) - mass_kg / 2.0).abs() < 1e-9);
    // The force on a wheel is that of both modes together.
    let (own, other) = (3.0, -7.0);
    let force = 0.5 * (own + other) * mass_kg / 2.0 + 0.5 * (own - other) * against;
    let signals = [0.0, own, 0.0, 0.0, 0.0, other - own];
    assert!((axle.road_velocity(&signals) / axle.theta - force).abs() < 1e-9);
    // Of a front axle it is not known.
    let [front, _] = wheels();
    let axle = Axle::new(&front, &state);
    assert_eq!(axle.mode_mass_kg(Mode::Against), axle.mode_mass_kg(Mode::Together));
}

/// A road under one wheel of an axle that couples both: each wheel's equations of motion with the other one's jerk, `J = a + b J_o` and
/// `J_o = b J`, against what the two modes make of it.
#[test]
fn both_wheels_of_an_axle_answer_the_road_under_one() {
    let ([_, rear], mut state) = (wheels(), deviating());
    let wheel = Wheel { friction_n_s_per_m: 0.0, ..rear };
    (state[BAR + 1], state[COUPLING]) = (0.0, 0.2);
    let modes = [Mode::Together, Mode::Against];
    for frequency_hz in [5.0, 9.7, 12.0, 15.0, 25.0] {
        let s = C::new(0.0, 2.0 / PERIOD_S * (0.5 * TAU * frequency_hz * PERIOD_S).tan());
        let one = C::new(1.0, 0.0);
        let alone = signals(&wheel, &state, s, Moved::by_road(one))[1];
        let by_other = signals(&wheel, &state, s, Moved { other_jerk: one, ..STILL })[1];
        let own_jerk = alone / (one - by_other * by_other);
        let own =
            signals(&wheel, &state, s, Moved { other_jerk: by_other * own_jerk, ..Moved::by_road(one) });
        let other = signals(&wheel, &state, s, Moved { other_jerk: own_jerk, ..STILL });
        let mut instruments = modes.map(|mode| {
            let mut instrument = Instrument::new();
            instrument.tune(&Axle::new(&wheel, &state), mode, wheel.body.sprung_mass_kg, PERIOD_S);
            instrument
        });
        let mut worst = 0.0f64;
        for step in -4 * SETTLED..100 {
            let turn = C::new(0.0, TAU * frequency_hz * f64::from(step) * PERIOD_S).exp();
            let there = instruments.each_mut().map(|instrument| instrument.push(turn.re));
            let found = of_both_wheels(&there);
            for (found, expected) in found.iter().zip([&own, &other]).filter(|_| step >= 0) {
                for (found, expected) in found.iter().zip(expected) {
                    worst = worst.max((found - (expected * turn).re).abs() / own[1].modulus().max(1.0));
                }
            }
        }
        assert!(worst < 1e-8, "{frequency_hz} Hz: {worst:e}");
    }
}

#[test]
fn a_strut_never_drives_its_wheel() {
    for damping in [-1.0, -1.4, -3.0] {
        let mut state = State::zeros();
        state[DAMPING] = damping;
        let [wheel, _] = wheels();
        let mut instrument = Instrument::new();
        instrument.tune(&Axle::new(&wheel, &state), Mode::Together, wheel.body.sprung_mass_kg, PERIOD_S);
        let mut largest = [0.0f64; 4];
        for signal in core::iter::once(1.0).chain([0.0; 250]).map(|road| instrument.push(road)) {
            largest = core::array::from_fn(|i| largest[i].max(signal[i].abs()));
        }
        // On half of its damper the body swings out with c/2m = 0.96/s.
        (0..10 * SETTLED).for_each(|_| _ = instrument.push(0.0));
        let last = instrument.push(0.0);
        assert!(
            last.iter().zip(largest).all(|(last, largest)| last.abs() < 1e-4 * largest),
            "{damping}: {last:?}"
        );
    }
}
