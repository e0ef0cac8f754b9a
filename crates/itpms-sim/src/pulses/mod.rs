//! Tooth pulses of a rolling wheel: when each tooth of its speed sensor's ring passes, in a clock's ticks.
//!
//! A rigid ring of belt turns on its sidewalls about the rim; road slopes shake it along and around, and the rim's speed shows how
//! stiff the sidewalls are, that is, the pressure. Nothing here knows of an estimator. `docs/math/simulation.md`, "Tooth pulses".
//!
//! | module | idea |
//! |---|---|
//! | `ring` | rim, belt, contact and suspension of one wheel in motion |
//! | `teeth` | the sensor's ring: where its teeth are, and when they pass |
//! | `car` | the four wheels of a scenario's drive |
//!
//! ```
//! use itpms_sim::pulses::{PulseSpec, PulseWheel};
//!
//! let spec = PulseSpec::default();
//! let mut wheel = PulseWheel::new(&spec, 1, 0);
//! // A second at 20 m/s, all of it at 240 kPa: 20 / 0.31 / 2π turns of 48 teeth.
//! let mut times_s = vec![];
//! wheel.roll(1.0, |_| (20.0, 240.0), |time_s| times_s.push(time_s));
//! assert!((times_s.len() as f64 - 20.0 / 0.31 / 6.283 * 48.0).abs() < 3.0);
//! ```

mod car;
mod ring;
mod teeth;

use rand_pcg::Pcg64;

pub use self::car::PulseCar;
use self::ring::Ring;
use self::teeth::Teeth;
use crate::road::Roughness;
use crate::streams::{Purpose, generator};

/// Steps of the wheel's motion in s.
const STEP_S: f64 = 2.5e-4;
/// Speed in m/s below which a wheel turns as it rolls, and nothing of its belt is seen.
const SLOWEST_M_S: f64 = 1.0;

/// A wheel, its road and its sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseSpec {
    pub radius_m: f64,
    /// Moments of inertia in kg m²: rim with what turns with it, and belt.
    pub rim_kg_m2: f64,
    pub belt_kg_m2: f64,
    /// Torsional stiffness of the sidewalls at 240 kPa in N m/rad, and the air's share of it there.
    pub sidewall_n_m: f64,
    pub air_share: f64,
    pub slip_stiffness_n: f64,
    /// How rough the road is; its slopes are white along the way (`w` = 2).
    pub roughness: Roughness,
    /// Teeth of the ring, standard deviation of where they are in pitches, and of an edge's variation from turn to turn.
    pub teeth: u32,
    /// Standard deviation of where the teeth are, in pitches.
    pub tooth_error: f64,
    /// Standard deviation of an edge's variation from turn to turn, in pitches.
    pub jitter: f64,
    pub tick_s: f64,
}

impl Default for PulseSpec {
    fn default() -> Self {
        Self {
            radius_m: 0.31,
            rim_kg_m2: 1.1,
            belt_kg_m2: 0.6,
            sidewall_n_m: 90e3,
            air_share: 0.55,
            slip_stiffness_n: 120e3,
            roughness: crate::road::RoadClass::B.into(),
            teeth: 48,
            tooth_error: 3e-3,
            jitter: 3e-4,
            tick_s: 1e-6,
        }
    }
}

/// How a wheel rolls at an instant.
#[derive(Debug, Clone, Copy)]
struct Rolling {
    speed_m_s: f64,
    pressure_kpa: f64,
    /// How fast it turns over how fast that speed turns a wheel of its radius; load and slip stiffness over what they are usually.
    turns: f64,
    load: f64,
    slip_stiffness: f64,
    /// How rough the road is over the wheel's.
    amplitude: f64,
}

impl Rolling {
    const FREELY: Self = Self {
        speed_m_s: 0.0,
        pressure_kpa: 0.0,
        turns: 1.0,
        load: 1.0,
        slip_stiffness: 1.0,
        amplitude: 1.0,
    };
}

#[derive(Debug, Clone)]
pub struct PulseWheel {
    radius_m: f64,
    ring: Ring,
    teeth: Teeth,
    random: Pcg64,
    steps: u64,
}

impl PulseWheel {
    /// At rest on its road. `wheel` tells apart the four of a car.
    pub fn new(spec: &PulseSpec, seed: u64, wheel: u64) -> Self {
        Self::of_car(spec, seed, seed, wheel)
    }

    /// The same on a drive of its own: `car_seed` says where the teeth are.
    pub fn of_car(spec: &PulseSpec, car_seed: u64, seed: u64, wheel: u64) -> Self {
        let mut car = generator(car_seed, Purpose::WheelCar, [1, wheel]);
        Self {
            radius_m: spec.radius_m,
            ring: Ring::new(spec),
            teeth: Teeth::new(spec, &mut car),
            random: generator(seed, Purpose::WheelSpeeds, [2, wheel]),
            steps: 0,
        }
    }

    /// On for so many s: `at` says speed in m/s and pressure in kPa at a time in s, `pulse` takes the time of each edge.
    pub fn roll(&mut self, for_s: f64, mut at: impl FnMut(f64) -> (f64, f64), mut pulse: impl FnMut(f64)) {
        let until = self.steps + (for_s / STEP_S).round() as u64;
        while self.steps < until {
            let (speed_m_s, pressure_kpa) = at(self.time_s());
            self.step(&Rolling { speed_m_s, pressure_kpa, ..Rolling::FREELY }, &mut pulse);
        }
    }

    fn time_s(&self) -> f64 {
        self.steps as f64 * STEP_S
    }

    fn step(&mut self, rolling: &Rolling, pulse: &mut impl FnMut(f64)) {
        let time_s = self.time_s();
        let shaken_rad = if rolling.speed_m_s > SLOWEST_M_S {
            self.ring.step(STEP_S, rolling, &mut self.random)
        } else {
            self.ring.rest();
            0.0
        };
        let turned_rad = rolling.turns * rolling.speed_m_s.max(0.0) * STEP_S / self.radius_m + shaken_rad;
        self.teeth.turn(time_s, STEP_S, turned_rad, &mut self.random, pulse);
        self.steps += 1;
    }

    /// Where the teeth are: by how many pitches each lies too far on.
    pub fn tooth_errors(&self) -> &[f64] {
        self.teeth.errors()
    }
}
