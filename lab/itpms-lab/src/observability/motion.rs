//! A steady motion over a road of six waves, looked at in one instant, and the exact derivatives of the accelerations there.
//!
//! Called by `rank`. Units that make everything of order one: heights in cm, time in `1 / omega` of the wheel hop,
//! stiffness in the first wheel's.

use std::f64::consts::{FRAC_PI_2, TAU};

use itpms_core::model::CornerConfig;
use nalgebra::{Complex, DMatrix, DVector};
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64;

use super::dual::Dual;
use itpms_analysis::bound::transfers;

/// A wheel: its corner and its pressure in kPa.
pub(super) type Wheel = (CornerConfig<f64>, f64);

/// Where the unknowns stand in their vector.
pub(super) struct Layout {
    pub(super) wheels: usize,
    pub(super) road_known: bool,
    pub(super) order: usize,
}

impl Layout {
    pub(super) fn stiffness(&self, wheel: usize) -> usize {
        4 * self.wheels + wheel
    }
    pub(super) fn road(&self, derivative: usize) -> usize {
        5 * self.wheels + derivative
    }
    pub(super) fn len(&self) -> usize {
        5 * self.wheels + if self.road_known { 0 } else { self.order + 1 }
    }
}

/// A steady motion over a road of six waves, looked at in one instant. Height in cm, time in `1 / omega`.
pub(super) struct Motion {
    /// Radians per second that are one unit of inverse time: the first wheel's hop.
    omega: f64,
    /// Stiffness in N/m that is one unit: the first wheel's.
    unit_n_per_m: f64,
    road: Vec<f64>,
    /// Body height, its rate, wheel height, its rate, of each wheel.
    states: Vec<[f64; 4]>,
    /// Taylor coefficients of the first wheel's tire deflection `x_r - x_w`.
    deflection: Vec<f64>,
}

impl Motion {
    pub(super) fn random(wheels: &[Wheel], order: usize, seed: u64) -> Self {
        let (corner, pressure) = &wheels[0];
        let unit_n_per_m = corner.tire.stiffness_n_per_m(*pressure);
        let omega = (unit_n_per_m / corner.quarter_car.unsprung_mass_kg()).sqrt();
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut road = vec![0.0; order + 1];
        let mut states = vec![[0.0; 4]; wheels.len()];
        let mut deflection = vec![0.0; order + 1];
        for hz in [1.3, 3.1, 5.9, 9.7, 14.3, 22.1] {
            let amplitude = rng.random_range(0.5..1.5);
            let phase = rng.random_range(0.0..TAU);
            let w = TAU * hz;
            let wave = Complex::from_polar(amplitude, phase);
            let coefficient = |wave: Complex<f64>, j: usize| {
                let turned = wave * Complex::from_polar(1.0, FRAC_PI_2 * j as f64);
                turned.re * (w / omega).powi(j as i32) / factorial(j)
            };
            for (j, sum) in road.iter_mut().enumerate() {
                *sum += coefficient(wave, j);
            }
            for (i, (corner, pressure)) in wheels.iter().enumerate() {
                // Accelerations over -w² are heights.
                let heights = transfers(corner, hz, *pressure).0.map(|a| -a / (w * w) * wave);
                for j in 0..2 {
                    states[i][j] += coefficient(heights[0], j);
                    states[i][2 + j] += coefficient(heights[1], j);
                }
                if i == 0 {
                    for (j, sum) in deflection.iter_mut().enumerate() {
                        *sum += coefficient(wave - heights[1], j);
                    }
                }
            }
        }
        Self { omega, unit_n_per_m, road, states, deflection }
    }

    /// Derivative of all outputs' Taylor coefficients by all unknowns (eq. 6).
    pub(super) fn jacobian(&self, wheels: &[Wheel], layout: &Layout) -> DMatrix<f64> {
        let n = layout.len();
        let road: Vec<Dual> = (0..=layout.order)
            .map(|j| match layout.road_known {
                true => Dual::constant(self.road[j], n),
                false => Dual::unknown(self.road[j], layout.road(j), n),
            })
            .collect();
        let mut rows = Vec::new();
        for (i, (corner, pressure)) in wheels.iter().enumerate() {
            let relative = corner.tire.stiffness_n_per_m(*pressure) / self.unit_n_per_m;
            let k_t = Dual::unknown(relative, layout.stiffness(i), n);
            let start = [0, 1, 2, 3].map(|s| Dual::unknown(self.states[i][s], 4 * i + s, n));
            rows.extend(self.outputs(corner, &start, &k_t, &road));
        }
        DMatrix::from_fn(rows.len(), n, |i, j| rows[i].gradient[j])
    }

    /// Taylor coefficients of both accelerations: those of the states follow one by one from eq. (1) of the paper.
    fn outputs(&self, corner: &CornerConfig<f64>, start: &[Dual; 4], k_t: &Dual, road: &[Dual]) -> Vec<Dual> {
        let car = &corner.quarter_car;
        let per_time = self.omega * self.omega;
        let (k_s, c_s) = (car.spring_n_per_m(), car.damping_n_s_per_m() * self.omega);
        let (m_b, m_w) = (car.sprung_mass_kg() * per_time, car.unsprung_mass_kg() * per_time);
        let [mut x_b, mut v_b, mut x_w, mut v_w] = start.clone();
        let mut outputs = Vec::new();
        for (j, x_r) in road.iter().enumerate() {
            let suspension = &(&(&x_w - &x_b) * k_s) + &(&(&v_w - &v_b) * c_s);
            let tire = &(k_t * &(x_r - &x_w)) * self.unit_n_per_m;
            let (a_b, a_w) = (&suspension * m_b.recip(), &(&tire - &suspension) * m_w.recip());
            let next = ((j + 1) as f64).recip();
            (x_b, x_w) = (&v_b * next, &v_w * next);
            (v_b, v_w) = (&a_b * next, &a_w * next);
            outputs.extend([a_b, a_w]);
        }
        outputs
    }

    /// Body, wheel and road lifted together, and set off together (eq. 9).
    pub(super) fn drifts(&self, layout: &Layout) -> Vec<DVector<f64>> {
        if layout.road_known {
            return Vec::new();
        }
        (0..2)
            .map(|derivative| {
                let mut v = DVector::zeros(layout.len());
                for wheel in 0..layout.wheels {
                    v[4 * wheel + derivative] = 1.0;
                    v[4 * wheel + 2 + derivative] = 1.0;
                }
                v[layout.road(derivative)] = 1.0;
                v
            })
            .collect()
    }

    /// A stiffer tire on a road nearer to the wheel (eq. 8).
    pub(super) fn exchange(&self, layout: &Layout) -> DVector<f64> {
        let mut v = DVector::zeros(layout.len());
        v[layout.stiffness(0)] = 1.0;
        for j in 0..=layout.order {
            v[layout.road(j)] = -self.deflection[j];
        }
        v
    }
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: usize = 7;

    #[test]
    fn derivatives_of_the_outputs_are_those_of_the_motion() {
        // The Taylor coefficients from the states must be those of the sum of waves: accelerations known in closed form.
        let wheels = [(CornerConfig::paper(), 200.0)];
        let layout = Layout { wheels: 1, road_known: true, order: ORDER };
        let motion = Motion::random(&wheels, ORDER, 3);
        let n = layout.len();
        let road: Vec<Dual> = motion.road.iter().map(|&u| Dual::constant(u, n)).collect();
        let start = motion.states[0].map(|s| Dual::constant(s, n));
        let found = motion.outputs(&wheels[0].0, &start, &Dual::constant(1.0, n), &road);
        // x_w'' from the deflection: x_w = x_r - deflection, coefficient j+2 times (j+2)(j+1).
        for j in 0..=ORDER - 2 {
            let wheel = (motion.road[j + 2] - motion.deflection[j + 2]) * ((j + 2) * (j + 1)) as f64;
            let value = found[2 * j + 1].value;
            assert!((value - wheel).abs() < 1e-12 * (1.0 + wheel.abs()), "{j}: {value} {wheel}");
        }
    }

    #[test]
    fn the_gradient_is_the_finite_difference() {
        let wheels = [(CornerConfig::paper(), 200.0)];
        let layout = Layout { wheels: 1, road_known: false, order: ORDER };
        let motion = Motion::random(&wheels, ORDER, 5);
        let jacobian = motion.jacobian(&wheels, &layout);
        let n = layout.len();
        let values = |k_t: f64| -> Vec<f64> {
            let road: Vec<Dual> = motion.road.iter().map(|&u| Dual::constant(u, n)).collect();
            let start = motion.states[0].map(|s| Dual::constant(s, n));
            let outputs = motion.outputs(&wheels[0].0, &start, &Dual::constant(k_t, n), &road);
            outputs.iter().map(|dual| dual.value).collect()
        };
        let (up, down) = (values(1.0 + 1e-5), values(1.0 - 1e-5));
        for (row, (up, down)) in up.iter().zip(down).enumerate() {
            let difference = (up - down) / 2e-5;
            let found = jacobian[(row, layout.stiffness(0))];
            assert!((found - difference).abs() < 1e-7 * (1.0 + found.abs()), "{row}: {found} {difference}");
        }
    }
}
