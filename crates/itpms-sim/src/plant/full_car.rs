//! A whole car with seven degrees of freedom: heave, pitch and roll of one body, and four wheels; with five more where
//! the body bends or wheels have hop dampers.
//!
//! Called by the simulation where a scenario has a `[car]`. Axes as in ISO 8855 (x forward, y left, z up), angles small;
//! a point of the body at `(x, y)` is at height `z - x pitch + y roll`. Everything is a deviation from the unloaded car
//! at rest (`simulation.md`, eq. 6-7).

use itpms_core::model::{ParameterError, QuarterCar};

use super::matrix::{inverse, times};
use super::oscillator::Oscillator;
use super::{Bending, Deviations, GRAVITY_M_S2, Strut, Tire};

/// Heave, pitch, roll, then the four wheels.
const RIGID: usize = 7;
/// Where the body's bending stands, and the first of four hop dampers.
const BENDING: usize = RIGID;
const HOP: usize = BENDING + 1;
const FREEDOMS: usize = HOP + 4;

/// The rigid body without its load, and what ties its corners together. Places are in m from its center of gravity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    pub mass_kg: f64,
    /// Moment of inertia in kg m² against pitch.
    pub pitch_kg_m2: f64,
    /// Moment of inertia in kg m² against roll.
    pub roll_kg_m2: f64,
    /// Height of the center of gravity over the road in m.
    pub height_m: f64,
    /// Where the struts stand, forward and to the left, in the order of `Corner::ALL`.
    pub struts_m: [[f64; 2]; 4],
    /// Anti-roll bars front and rear in N m per rad of roll between body and axle.
    pub antiroll_n_m_per_rad: [f64; 2],
    pub bending: Option<Bending>,
}

/// A load at one place, in m forward and to the left of the body's center of gravity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    pub mass_kg: f64,
    pub at_m: [f64; 2],
}

/// Input of the car over one step: values at its start, middle and end, or at its ends (straight between). A step
/// starts with what the last one ended with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarInput {
    pub road_m: [[f64; 3]; 4],
    /// Tire stiffnesses in N/m at the step's ends.
    pub stiffness_n_per_m: [[f64; 2]; 4],
    pub wheel_force_n: [[f64; 3]; 4],
    /// Acceleration of the car in m/s² forward and to the left.
    pub car_m_s2: [[f64; 2]; 3],
}

#[derive(Clone, Copy)]
struct Instant {
    road_m: [f64; 4],
    road_m_s: [f64; 4],
    stiffness_n_per_m: [f64; 4],
    wheel_force_n: [f64; 4],
    /// On the body, from gravity on the load and from the car's acceleration: force, pitch and roll moment.
    body: [f64; 3],
    since_s: f64,
}

type Freedoms = [f64; FREEDOMS];

#[derive(Debug, Clone)]
pub struct FullCar {
    body: Body,
    struts: [Strut; 4],
    per_wheel_kg: [f64; 4],
    tires: [Tire; 4],
    hop_dampers: [Oscillator; 4],
    bending: Oscillator,
    /// Participation of the bending at the struts' tops.
    bends: [f64; 4],
    /// Whether anything bends or is damped at wheel hop.
    is_rigid: bool,
    /// Inverse of the loaded body's mass matrix.
    compliance: [[f64; 3]; 3],
    loaded_kg: f64,
    /// Weight of the load as force and moments.
    weight: [f64; 3],
    place: Freedoms,
    rate: Freedoms,
    acceleration: Freedoms,
    /// Whether `acceleration` is also that of the next step's start: a damped tire's is not, for its road's rate is that
    /// of the next parabola.
    carries_over: bool,
}

impl FullCar {
    /// A car at rest on the roads of the given heights, carrying nothing. The corners are the file's quarter cars with the
    /// true ones' deviations; their sprung masses are what each tire carries of the body at rest, the body's own mass
    /// moves. Errors: a factor that leaves a parameter without physical sense.
    pub fn new(
        body: &Body,
        corners: &[(QuarterCar<f64>, Deviations); 4],
        road_m: [f64; 4],
    ) -> Result<Self, ParameterError> {
        let true_car = |i: usize| corners[i].1.applied_to(&corners[i].0);
        let cars = [true_car(0)?, true_car(1)?, true_car(2)?, true_car(3)?];
        let all = [0, 1, 2, 3];
        let hop_dampers = all.map(|i| {
            let truth = &corners[i].1;
            match truth.hop_damper_kg > 0.0 {
                true => Oscillator::new(truth.hop_damper_kg, truth.hop_damper_hz, truth.hop_damper_ratio),
                false => Oscillator::default(),
            }
        });
        let static_n = |i: usize| {
            let mass_kg = cars[i].sprung_mass_kg() + cars[i].unsprung_mass_kg() + hop_dampers[i].mass_kg;
            GRAVITY_M_S2 * mass_kg
        };
        let mut car = Self {
            body: *body,
            struts: all.map(|i| Strut::new(&cars[i], &corners[i].1)),
            per_wheel_kg: cars.map(|car| car.unsprung_mass_kg().recip()),
            tires: all.map(|i| Tire::new(&corners[i].1, static_n(i))),
            is_rigid: body.bending.is_none() && hop_dampers.iter().all(|damper| damper.mass_kg == 0.0),
            hop_dampers,
            bending: body.bending.map_or_else(Oscillator::default, |mode| {
                Oscillator::new(mode.modal_mass_kg, mode.frequency_hz, mode.damping_ratio)
            }),
            bends: body.bending.map_or([0.0; 4], |mode| mode.participation),
            compliance: [[0.0; 3]; 3],
            loaded_kg: body.mass_kg,
            weight: [0.0; 3],
            place: [0.0; FREEDOMS],
            rate: [0.0; FREEDOMS],
            acceleration: [0.0; FREEDOMS],
            carries_over: false,
        };
        car.load(&[]);
        car.place[3..RIGID].copy_from_slice(&road_m);
        let plane = car.plane_through(road_m);
        car.place[..3].copy_from_slice(&plane);
        car.stand();
        Ok(car)
    }

    pub fn load(&mut self, loads: &[Load]) {
        let body = &self.body;
        let mut mass = [[0.0; 3]; 3];
        for (i, inertia) in [body.mass_kg, body.pitch_kg_m2, body.roll_kg_m2].into_iter().enumerate() {
            mass[i][i] = inertia;
        }
        self.weight = [0.0; 3];
        self.loaded_kg = body.mass_kg;
        for load in loads {
            let lever = lever(load.at_m);
            for (row, a) in mass.iter_mut().zip(lever) {
                row.iter_mut().zip(lever).for_each(|(m, b)| *m += load.mass_kg * a * b);
            }
            self.weight.iter_mut().zip(lever).for_each(|(w, a)| *w -= load.mass_kg * GRAVITY_M_S2 * a);
            self.loaded_kg += load.mass_kg;
        }
        self.compliance = inverse(&mass);
        self.carries_over = false;
    }

    /// Puts the car, at rest, where its load and the tires' stiffnesses leave it; exact for linear springs without
    /// anti-roll bars, and a good start for others.
    pub fn settle(&mut self, road_m: [f64; 4], stiffness_n_per_m: [f64; 4]) {
        let mut stiffness = [[0.0; 3]; 3];
        let mut load = self.weight;
        let series = |i: usize| 1.0 / (1.0 / self.struts[i].spring_n_per_m() + 1.0 / stiffness_n_per_m[i]);
        for (i, &road) in road_m.iter().enumerate() {
            let (k, lever) = (series(i), lever(self.body.struts_m[i]));
            for (row, a) in stiffness.iter_mut().zip(lever) {
                row.iter_mut().zip(lever).for_each(|(s, b)| *s += k * a * b);
            }
            load.iter_mut().zip(lever).for_each(|(f, a)| *f += k * road * a);
        }
        let place = times(&inverse(&stiffness), load);
        self.place[..3].copy_from_slice(&place);
        for (i, &road) in road_m.iter().enumerate() {
            let force = series(i) * (road - self.corner(&self.place, i));
            self.place[3 + i] = road - force / stiffness_n_per_m[i];
        }
        self.rate = [0.0; FREEDOMS];
        self.carries_over = false;
        self.stand();
    }

    /// Takes the struts for ones that have always been as long as they are now; the body is straight.
    fn stand(&mut self) {
        self.place.copy_within(3..RIGID, HOP);
        for i in 0..4 {
            let compression_m = self.compression_m(i);
            self.struts[i].place(compression_m);
        }
    }

    fn compression_m(&self, i: usize) -> f64 {
        self.place[3 + i] - self.corner(&self.place, i)
    }

    /// Heave in m at the body's center of gravity, pitch and roll in rad: nose down and left side up are positive.
    pub fn attitude(&self) -> [f64; 3] {
        [self.place[0], self.place[1], self.place[2]]
    }

    /// Heights in m of the strut tops and of the wheels.
    pub fn heights_m(&self) -> [[f64; 2]; 4] {
        [0, 1, 2, 3].map(|i| [self.corner(&self.place, i), self.place[3 + i]])
    }

    /// Vertical acceleration in m/s² of each strut's top and of each wheel at the end of the last step.
    pub fn accelerations_m_s2(&self) -> [[f64; 2]; 4] {
        [0, 1, 2, 3].map(|i| [self.corner(&self.acceleration, i), self.acceleration[3 + i]])
    }

    /// Tire loads in N, the static loads included, on roads of these heights in m with these stiffnesses in N/m.
    pub(crate) fn tires_n(&self, road_m: [f64; 4], stiffness_n_per_m: [f64; 4]) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| {
            let tire = &self.tires[i];
            let force_n = tire.force_n(stiffness_n_per_m[i], road_m[i] - self.place[3 + i], 0.0);
            tire.static_n + force_n.max(-tire.static_n)
        })
    }

    /// One classical Runge-Kutta step of `h` seconds; for damped tires see [`Plant::step`](super::Plant::step).
    pub fn step(&mut self, h: f64, input: &CarInput) {
        if self.is_rigid {
            self.step_of::<RIGID>(h, input);
        } else {
            self.step_of::<FREEDOMS>(h, input);
        }
    }

    /// The same with the first so many freedoms; the others stay where they are.
    fn step_of<const N: usize>(&mut self, h: f64, input: &CarInput) {
        let (middle, end) = (&self.instant(1, h, input), &self.instant(2, h, input));
        let half = 0.5 * h;
        let (q0, u0) = (first::<N>(&self.place), first::<N>(&self.rate));
        let a0 = if self.carries_over {
            first::<N>(&self.acceleration)
        } else {
            self.accelerations(&q0, &u0, &self.instant(0, h, input))
        };
        let (q1, u1) = (moved(&q0, half, &u0), moved(&u0, half, &a0));
        let a1 = self.accelerations(&q1, &u1, middle);
        let (q2, u2) = (moved(&q0, half, &u1), moved(&u0, half, &a1));
        let a2 = self.accelerations(&q2, &u2, middle);
        let (q3, u3) = (moved(&q0, h, &u2), moved(&u0, h, &a2));
        let a3 = self.accelerations(&q3, &u3, end);
        for i in 0..N {
            self.place[i] = q0[i] + h / 6.0 * (u0[i] + 2.0 * (u1[i] + u2[i]) + u3[i]);
            self.rate[i] = u0[i] + h / 6.0 * (a0[i] + 2.0 * (a1[i] + a2[i]) + a3[i]);
        }
        let (q4, u4) = (first::<N>(&self.place), first::<N>(&self.rate));
        let a4 = self.accelerations(&q4, &u4, end);
        self.acceleration[..N].copy_from_slice(&a4);
        for i in 0..4 {
            let compression_m = self.compression_m(i);
            self.struts[i].advance(compression_m, h);
        }
        self.carries_over = self.tires.iter().all(|tire| tire.damping_n_s_per_m == 0.0);
    }

    /// Inputs at the start (0), the middle (1) or the end (2) of a step.
    #[inline]
    fn instant(&self, at: usize, h: f64, input: &CarInput) -> Instant {
        let [forward, left] = input.car_m_s2[at];
        // Braking presses the nose down, a left turn lifts the left side.
        let moment = self.loaded_kg * self.body.height_m;
        let mut now = Instant {
            road_m: [0.0; 4],
            road_m_s: [0.0; 4],
            stiffness_n_per_m: [0.0; 4],
            wheel_force_n: [0.0; 4],
            body: [self.weight[0], self.weight[1] - moment * forward, self.weight[2] + moment * left],
            since_s: 0.5 * at as f64 * h,
        };
        for i in 0..4 {
            let ([r0, r1, r2], [k0, k2]) = (input.road_m[i], input.stiffness_n_per_m[i]);
            now.road_m[i] = input.road_m[i][at];
            now.road_m_s[i] = match at {
                0 => (4.0 * r1 - 3.0 * r0 - r2) / h,
                1 => (r2 - r0) / h,
                _ => (r0 - 4.0 * r1 + 3.0 * r2) / h,
            };
            now.stiffness_n_per_m[i] = k0 + 0.5 * at as f64 * (k2 - k0);
            now.wheel_force_n[i] = input.wheel_force_n[i][at];
        }
        now
    }

    /// Newton's and Euler's laws for the body, Newton's for the wheels and what hangs on them.
    fn accelerations<const N: usize>(&self, q: &[f64; N], u: &[f64; N], now: &Instant) -> [f64; N] {
        let bars = self.antiroll_n(q);
        let mut acceleration = [0.0; N];
        let mut body = now.body;
        let mut bending_n = 0.0;
        for i in 0..4 {
            let (wheel, wheel_rate) = (q[3 + i], u[3 + i]);
            let extension_m_s = self.corner(u, i) - wheel_rate;
            let compression_m = wheel - self.corner(q, i);
            let strut = self.struts[i].force_n(compression_m, extension_m_s, now.since_s) + bars[i];
            let (deflection_m, rate_m_s) = (now.road_m[i] - wheel, now.road_m_s[i] - wheel_rate);
            let tire = self.tires[i].force_n(now.stiffness_n_per_m[i], deflection_m, rate_m_s);
            // A tire pushes and does not pull: beyond its static load the wheel is in the air.
            let mut force = tire.max(-self.tires[i].static_n) + now.wheel_force_n[i] - strut;
            if N > RIGID {
                let damper = &self.hop_dampers[i];
                let pull = damper.pull_m_s2(q[HOP + i] - wheel, u[HOP + i] - wheel_rate);
                acceleration[HOP + i] = pull;
                force -= damper.mass_kg * pull;
                bending_n += self.bends[i] * strut;
            }
            acceleration[3 + i] = force * self.per_wheel_kg[i];
            body.iter_mut().zip(lever(self.body.struts_m[i])).for_each(|(f, a)| *f += a * strut);
        }
        if N > RIGID && self.bending.mass_kg > 0.0 {
            let pull = self.bending.pull_m_s2(q[BENDING], u[BENDING]);
            acceleration[BENDING] = bending_n / self.bending.mass_kg + pull;
        }
        let body = times(&self.compliance, body);
        acceleration[..3].copy_from_slice(&body);
        acceleration
    }

    /// Forces in N of the anti-roll bars on the body's corners.
    fn antiroll_n<const N: usize>(&self, q: &[f64; N]) -> [f64; 4] {
        let mut forces = [0.0; 4];
        for (axle, bar) in self.body.antiroll_n_m_per_rad.into_iter().enumerate() {
            let (left, right) = (2 * axle, 2 * axle + 1);
            let track_m = self.body.struts_m[left][1] - self.body.struts_m[right][1];
            let extension = |i: usize| self.corner(q, i) - q[3 + i];
            let force = bar * (extension(left) - extension(right)) / (track_m * track_m);
            forces[left] = -force;
            forces[right] = force;
        }
        forces
    }

    /// Motion of a strut's top.
    #[inline]
    fn corner<const N: usize>(&self, freedoms: &[f64; N], i: usize) -> f64 {
        let [x, y] = self.body.struts_m[i];
        let rigid = freedoms[0] - x * freedoms[1] + y * freedoms[2];
        if N > RIGID { rigid + self.bends[i] * freedoms[BENDING] } else { rigid }
    }

    /// Heave, pitch and roll of the plane that lies best on four heights.
    fn plane_through(&self, heights_m: [f64; 4]) -> [f64; 3] {
        let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for (height, at) in heights_m.into_iter().zip(self.body.struts_m) {
            let lever = lever(at);
            for (row, a) in normal.iter_mut().zip(lever) {
                row.iter_mut().zip(lever).for_each(|(n, b)| *n += a * b);
            }
            right.iter_mut().zip(lever).for_each(|(r, a)| *r += a * height);
        }
        times(&inverse(&normal), right)
    }
}

/// Height of a point by heave, pitch and roll; and force, pitch and roll moment of a vertical force there.
#[inline]
fn lever([x, y]: [f64; 2]) -> [f64; 3] {
    [1.0, -x, y]
}

#[inline]
fn first<const N: usize>(of: &Freedoms) -> [f64; N] {
    std::array::from_fn(|i| of[i])
}

#[inline]
fn moved<const N: usize>(from: &[f64; N], h: f64, rate: &[f64; N]) -> [f64; N] {
    let mut to = *from;
    to.iter_mut().zip(rate).for_each(|(x, r)| *x += h * r);
    to
}
