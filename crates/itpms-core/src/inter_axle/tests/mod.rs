//! The parts of the shared road against closed forms: quarter cars solved here, from their equations of motion, for one
//! frequency at a time.

extern crate std;

mod pieces;
mod residual;
mod search;

use std::vec::Vec;

use nalgebra::Complex;
// Where another crate of the build brings `std`, numbers have these functions by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use crate::belief::measurement::BINS;
use crate::belief::state::{BAR, COUPLING, DAMPING, GAIN, MASS, SPRING, State, TIRE};
use crate::inter_axle::alignment::channel::{BOTH, FRONT, SEEN, place};
use crate::inter_axle::residual::instrument::Instrument;
use crate::inter_axle::residual::model::{Axle, AxleFrame, Mode, Wheel};
use crate::inter_axle::{Frame, HOP_S, SIGNALS};
use crate::memory::configured;
use crate::model::Corner;
use crate::spectrum::FrameClock;
use crate::spectrum::transfer::Body;

type C = Complex<f64>;
const PERIOD_S: f64 = 0.004;
/// Steps after which an instrument has forgotten that it began at rest: six seconds, 1e-5 of a body's slowest swing.
const SETTLED: i32 = 1500;

/// The unlike axles of a family car, on the left; friction damps a fifth as much as the dampers.
fn wheels() -> [Wheel<f64>; 2] {
    let wheel = |corner: Corner,
                 sprung_mass_kg,
                 unsprung_mass_kg,
                 damping_n_s_per_m,
                 spring_n_per_m,
                 stiffness: f64| {
        let body = Body { sprung_mass_kg, unsprung_mass_kg, damping_n_s_per_m, spring_n_per_m };
        let coupled_kg = [0.0, unsprung_mass_kg][corner.axle()];
        let friction_n_s_per_m = 0.2 * damping_n_s_per_m;
        Wheel { body, friction_n_s_per_m, theta: 1.0 / stiffness, coupled_kg, corner }
    };
    [
        wheel(Corner::FrontLeft, 240.8, 56.9, 925.8, 29_114.0, 233_000.0),
        wheel(Corner::RearLeft, 216.0, 50.0, 870.0, 26_000.0, 220_000.0),
    ]
}

/// A car that is not as its vehicle file says.
fn deviating() -> State<f64> {
    let mut state = State::zeros();
    for (at, value) in [
        (TIRE, 0.18),
        (TIRE + 2, -0.07),
        (MASS, 0.02),
        (MASS + 2, -0.01),
        (DAMPING, -0.15),
        (DAMPING + 2, 0.1),
        (SPRING, 0.08),
        (SPRING + 2, -0.05),
        (BAR, 0.35),
        (BAR + 1, 0.12),
        (COUPLING, 0.15),
        (GAIN, 0.015),
    ] {
        state[at] = value;
    }
    state
}

/// What moves an axle at one frequency: the road, the other side's relative velocity through the anti-roll bar, and its wheel's jerk
/// through an axle that is one body.
#[derive(Debug, Clone, Copy)]
struct Moved {
    road: C,
    other: C,
    other_jerk: C,
}

const STILL: Moved = Moved { road: ZERO, other: ZERO, other_jerk: ZERO };
const ZERO: C = C::new(0.0, 0.0);

impl Moved {
    fn by_road(road: C) -> Self {
        Self { road, ..STILL }
    }
}

/// The signals of an axle at `s`: its two equations of motion in velocities, solved by Cramer's rule. Friction's part of the wheel's
/// jerk is taken out of it.
fn signals(wheel: &Wheel<f64>, state: &State<f64>, s: C, moved: Moved) -> [C; SEEN] {
    let (body, i) = (&wheel.body, wheel.corner.index());
    let mass = body.unsprung_mass_kg * (1.0 + state[MASS + i]);
    let z = s * (body.damping_n_s_per_m * (1.0 + state[DAMPING + i]) + wheel.friction_n_s_per_m)
        + body.spring_n_per_m * (1.0 + state[SPRING + i]);
    let coupled = [0.0, body.unsprung_mass_kg * state[COUPLING]][i / 2];
    let bar = body.spring_n_per_m * state[BAR + i / 2];
    let tire = 1.0 / (wheel.theta * (1.0 + state[TIRE + i]));
    // What friction is taken out for is the jerk times all of the wheel's mass.
    let friction = s * wheel.friction_n_s_per_m / mass;
    let held = z - friction * coupled;
    let (a, b) = (s * s * (mass - coupled) + held + bar + tire, -(held + bar));
    let (c, d) = (-(z + bar), s * s * body.sprung_mass_kg + z + bar);
    let wheel_side = moved.road * tire + moved.other * bar - moved.other_jerk * coupled;
    let body_side = -moved.other * bar;
    let determinant = a * d - b * c;
    let wheel = (wheel_side * d - body_side * b) / determinant;
    let relative = wheel - (body_side * a - wheel_side * c) / determinant;
    let jerk = s * s * wheel + friction * relative;
    [wheel, jerk, s * relative, relative, relative - moved.other, moved.other_jerk - jerk]
}

/// A frame of both axles at `frequency_hz`, front and rear moved as given, times `amplitude`; the state is the truth.
fn frame(frequency_hz: f64, moved: [Moved; 2], state: &State<f64>, amplitude: C) -> AxleFrame<f64> {
    let wheels = wheels();
    let s = C::new(0.0, core::f64::consts::TAU * frequency_hz);
    let gain = 1.0 + state[GAIN];
    let axles = [Axle::new(&wheels[0], state), Axle::new(&wheels[1], state)];
    // A front sensor that reads too little by this gain.
    let seen = [
        signals(&wheels[0], state, s, moved[0]).map(|x| x * amplitude / gain),
        signals(&wheels[1], state, s, moved[1]).map(|x| x * amplitude),
    ];
    let modes = [[Mode::Together; 2], [Mode::Together, Mode::Against]];
    let mut instruments: [[_; 2]; 2] = core::array::from_fn(|axle| {
        modes[axle].map(|mode| {
            let mut instrument = Instrument::new();
            instrument.tune(&axles[axle], mode, wheels[axle].body.sprung_mass_kg, PERIOD_S);
            instrument
        })
    });
    let mut clock = configured(|clock: &mut FrameClock<_, BINS, SIGNALS>| clock.configure(HOP_S, PERIOD_S));
    for step in -SETTLED.. {
        let turn = (s * (f64::from(step) * PERIOD_S)).exp();
        let now = seen.map(|seen| seen.map(|x| (x * turn).re));
        let common = 0.5 * (gain * axles[0].road_velocity(&now[0]) + axles[1].road_velocity(&now[1]));
        let mut all = [0.0; SIGNALS];
        for axle in 0..2 {
            let modes = instruments[axle].each_mut().map(|instrument| instrument.push(common));
            let [wheel, jerk, acceleration, relative] =
                core::array::from_fn(|i| 0.5 * (modes[0][i] + modes[1][i]));
            let (other, other_jerk) = (now[axle][3] - now[axle][4], now[axle][5] + now[axle][1]);
            let foretold = [wheel, jerk, acceleration, relative, relative - other, other_jerk - jerk];
            for at in 0..[FRONT, SEEN][axle] {
                let place = place(axle, at).unwrap();
                (all[place], all[BOTH + place]) = (now[axle][at], foretold[at]);
            }
        }
        if step >= 0
            && let Some(frame) = clock.push(&all)
        {
            return taken(frame);
        }
    }
    unreachable!()
}

fn taken(frame: Frame<f64>) -> AxleFrame<f64> {
    AxleFrame { frame, middle_s: 0.0, delay_s: 0.12, used_wheelbase: 0.0, used_skew: 0.0 }
}

/// Frames of unit cosines and sines at all frequencies that the bins see, half a hertz apart: a tenth of a bin.
fn unit_frames(state: &State<f64>, moved: impl Fn(f64) -> [Moved; 2]) -> Vec<AxleFrame<f64>> {
    (1..=100)
        .map(|k| 0.5 * f64::from(k))
        .flat_map(|f| [C::new(1.0, 0.0), C::new(0.0, -1.0)].map(|a| frame(f, moved(f), state, a)))
        .collect()
}
