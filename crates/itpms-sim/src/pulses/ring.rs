//! A rim, the belt that turns on its sidewalls, and what a road does to both; `docs/math/simulation.md`, eq. 17-19.
//!
//! Deviations from free rolling, linear, with the tire's relaxation; a quarter car gives the load.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use rand_pcg::Pcg64;

use super::{PulseSpec, Rolling};
use crate::wheel_speeds::normal;

/// Damping of the sidewalls as a share of critical, of the rim alone on them.
const SIDEWALL_DAMPING: f64 = 0.03;
/// Vertical stiffness in N/m at [`REFERENCE_KPA`], the air's share, and how much of a deflection the rolling radius follows.
const TIRE_N_M: f64 = 200e3;
const TIRE_AIR_SHARE: f64 = 0.8;
const RADIUS_PER_DEFLECTION: f64 = 0.3;
const REFERENCE_KPA: f64 = 240.0;
/// Relaxation length of slip, and length of the contact over which a road is averaged, in m.
const RELAXATION_M: f64 = 0.02;
const CONTACT_M: f64 = 0.1;
/// Quarter car: wheel, body, spring, damper; load in N.
const WHEEL_KG: f64 = 40.0;
const BODY_KG: f64 = 350.0;
const SPRING_N_M: f64 = 25e3;
const DAMPER_N_S_M: f64 = 1500.0;
const LOAD_N: f64 = 4000.0;
/// The axle along the car: frequency in Hz, damping.
const ALONG_HZ: f64 = 18.0;
const ALONG_DAMPING: f64 = 0.12;
/// Distance between the road's heights in m.
const GRID_M: f64 = 5e-3;
/// Reference wave number of ISO 8608 in cycles/m.
const N0: f64 = 0.1;

/// Body and wheel (height, speed), the axle along the car (way, speed), twist of the sidewalls, speeds of rim and belt, force along.
const STATES: usize = 10;
type State = [f64; STATES];

#[derive(Debug, Clone)]
pub(super) struct Ring {
    spec: PulseSpec,
    state: State,
    /// Road heights under the contact, each the last one and a random slope; how far on, in shares of a grid's step.
    heights_m: VecDeque<f64>,
    sum_m: f64,
    part: f64,
    /// Standard deviation of the next height's rise.
    rise_m: f64,
    /// Averages of the contact at both ends of the grid's step under way.
    mean_m: [f64; 2],
}

/// Input of the wheel within a step.
#[derive(Debug, Clone, Copy)]
struct Driven {
    speed_m_s: f64,
    load_n: f64,
    slip_stiffness_n: f64,
    sidewall_n_m: f64,
    sidewall_n_m_s: f64,
    tire_n_m: f64,
    slope: f64,
}

impl Ring {
    pub(super) fn new(spec: &PulseSpec) -> Self {
        let number = (CONTACT_M / GRID_M) as usize;
        // Slopes white with (2π n0)² Gd(n0) per cycle/m, one-sided: half of that times the grid's rate is their variance.
        let slope = TAU * N0 * (spec.roughness.gd_n0_m3() * 0.5 / GRID_M).sqrt();
        Self {
            spec: *spec,
            state: [0.0; STATES],
            heights_m: VecDeque::from(vec![0.0; number]),
            sum_m: 0.0,
            part: 0.0,
            rise_m: slope * GRID_M,
            mean_m: [0.0; 2],
        }
    }

    /// Nothing trembles; the road stays.
    pub(super) fn rest(&mut self) {
        let road_m = self.height_m();
        self.state = [0.0; STATES];
        (self.state[0], self.state[2]) = (road_m, road_m);
    }

    /// A step later: by what angle the rim has turned more than it does by rolling.
    pub(super) fn step(&mut self, step_s: f64, rolling: &Rolling, random: &mut Pcg64) -> f64 {
        let Rolling { speed_m_s, amplitude, .. } = *rolling;
        let before_m = self.height_m();
        self.part += speed_m_s * step_s / GRID_M;
        while self.part >= 1.0 {
            self.part -= 1.0;
            let last = self.heights_m.back().copied().unwrap_or(0.0);
            self.push(last + amplitude * self.rise_m * normal(random));
        }
        let slope = (self.height_m() - before_m) / (speed_m_s * step_s);
        let driven = self.driven(rolling, slope);
        let rim_before = self.state[7];
        self.integrate(step_s, before_m, &driven);
        step_s * 0.5 * (rim_before + self.state[7])
    }

    fn driven(&self, rolling: &Rolling, slope: f64) -> Driven {
        let air = rolling.pressure_kpa / REFERENCE_KPA;
        let share = |air_share: f64| 1.0 - air_share + air_share * air;
        Driven {
            speed_m_s: rolling.speed_m_s,
            load_n: LOAD_N * rolling.load,
            slip_stiffness_n: self.spec.slip_stiffness_n * rolling.slip_stiffness,
            sidewall_n_m: self.spec.sidewall_n_m * share(self.spec.air_share),
            sidewall_n_m_s: 2.0 * SIDEWALL_DAMPING * (self.spec.sidewall_n_m * self.spec.rim_kg_m2).sqrt(),
            tire_n_m: TIRE_N_M * share(TIRE_AIR_SHARE),
            slope,
        }
    }

    fn push(&mut self, height_m: f64) {
        let oldest = self.heights_m.pop_front().unwrap_or(0.0);
        self.heights_m.push_back(height_m);
        self.sum_m += height_m - oldest;
        self.mean_m = [self.mean_m[1], self.sum_m / self.heights_m.len() as f64];
    }

    fn height_m(&self) -> f64 {
        self.mean_m[0] + self.part * (self.mean_m[1] - self.mean_m[0])
    }

    /// Runge and Kutta's fourth order.
    fn integrate(&mut self, step_s: f64, from_m: f64, driven: &Driven) {
        let after =
            |by: f64, rate: &State| -> State { std::array::from_fn(|i| self.state[i] + by * rate[i]) };
        let at = |by_s: f64| from_m + by_s * driven.speed_m_s * driven.slope;
        let first = self.rates(&self.state, at(0.0), driven);
        let second = self.rates(&after(0.5 * step_s, &first), at(0.5 * step_s), driven);
        let third = self.rates(&after(0.5 * step_s, &second), at(0.5 * step_s), driven);
        let fourth = self.rates(&after(step_s, &third), at(step_s), driven);
        for (i, value) in self.state.iter_mut().enumerate() {
            *value += step_s / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
    }

    fn rates(&self, state: &State, road_m: f64, driven: &Driven) -> State {
        let [body, body_rate, wheel, wheel_rate, along, along_rate, twist, rim, belt, force] = *state;
        let spec = &self.spec;
        let rolling = driven.speed_m_s / spec.radius_m;
        // A load that rises flattens the tire, which then rolls on a smaller radius.
        let pressed = road_m - wheel;
        let radius_m = -RADIUS_PER_DEFLECTION * pressed;
        let strut = SPRING_N_M * (wheel - body) + DAMPER_N_S_M * (wheel_rate - body_rate);
        let slipping = spec.radius_m * belt + radius_m * rolling - along_rate;
        let force_rate = (driven.slip_stiffness_n * slipping - driven.speed_m_s * force) / RELAXATION_M;
        let torque = driven.sidewall_n_m * twist + driven.sidewall_n_m_s * (rim - belt);
        let omega = TAU * ALONG_HZ;
        [
            body_rate,
            strut / BODY_KG,
            wheel_rate,
            (driven.tire_n_m * pressed - strut) / WHEEL_KG,
            along_rate,
            (force - driven.load_n * driven.slope) / WHEEL_KG
                - omega * omega * along
                - 2.0 * ALONG_DAMPING * omega * along_rate,
            rim - belt,
            -torque / spec.rim_kg_m2,
            (torque - spec.radius_m * force) / spec.belt_kg_m2,
            force_rate,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequency in Hz of the mode in which rim and belt turn against each other: an eigenvalue of the wheel's equations.
    fn resonance_hz(pressure_kpa: f64, speed_m_s: f64) -> f64 {
        let ring = Ring::new(&PulseSpec::default());
        let driven = ring.driven(&Rolling { speed_m_s, pressure_kpa, ..Rolling::FREELY }, 0.0);
        let unit = |column: usize| std::array::from_fn(|i| if i == column { 1.0 } else { 0.0 });
        let rates = nalgebra::SMatrix::<f64, STATES, STATES>::from_fn(|row, column| {
            ring.rates(&unit(column), 0.0, &driven)[row]
        });
        let modes_hz: Vec<f64> = rates.complex_eigenvalues().iter().map(|mode| mode.im / TAU).collect();
        modes_hz.into_iter().find(|hz| (30.0..70.0).contains(hz)).unwrap()
    }

    #[test]
    fn a_fifth_less_pressure_lowers_the_resonance_by_a_few_hertz() {
        for speed_m_s in [13.9, 19.4, 25.0] {
            let [full, low] = [240.0, 192.0].map(|kpa| resonance_hz(kpa, speed_m_s));
            let seen = format!("{speed_m_s} {full} {low}");
            assert!((2.2..=3.1).contains(&(full - low)) && (40.0..60.0).contains(&full), "{seen}");
        }
    }
}
