//! A quarter car, integrated on a fine grid while its tire loses pressure.
//!
//! Called by the simulation for corners that are on their own. It is written apart from the model in `itpms-core` on
//! purpose: the tests hold the two against each other.

use itpms_core::model::{ParameterError, QuarterCar};

use super::{Deviations, GRAVITY_M_S2, Strut, Tire};

/// Positions in m and velocities in m/s of a quarter car, upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantState {
    pub body_m: f64,
    pub body_m_s: f64,
    /// Unsprung mass displacement.
    pub wheel_m: f64,
    pub wheel_m_s: f64,
}

/// Input of the plant over one step: the road's height in m at its start, middle and end, and the tire's
/// stiffness in N/m at its start and end (straight between).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepInput {
    /// Road height under the tire in m.
    pub road_m: [f64; 3],
    pub stiffness_n_per_m: [f64; 2],
}

/// Road and tire at one instant.
#[derive(Clone, Copy)]
struct Contact {
    road_m: f64,
    road_m_s: f64,
    stiffness_n_per_m: f64,
    since_s: f64,
}

/// A quarter car in motion.
#[derive(Debug, Clone)]
pub struct Plant {
    /// Reciprocals, since a division costs as much as the rest of an acceleration.
    per_body_kg: f64,
    per_wheel_kg: f64,
    strut: Strut,
    tire: Tire,
    state: PlantState,
    /// Body and wheel acceleration at `state`, once a step has been made.
    accelerations_m_s2: [f64; 2],
}

impl Plant {
    /// The file's quarter car with the true one's deviations, at rest on a road of the given height.
    /// Errors: a factor that leaves a parameter without physical sense.
    pub fn new(nominal: &QuarterCar<f64>, truth: &Deviations, road_m: f64) -> Result<Self, ParameterError> {
        let car = truth.applied_to(nominal)?;
        Ok(Self {
            per_body_kg: car.sprung_mass_kg().recip(),
            per_wheel_kg: car.unsprung_mass_kg().recip(),
            strut: Strut::new(&car, truth),
            tire: Tire::new(truth, GRAVITY_M_S2 * (car.sprung_mass_kg() + car.unsprung_mass_kg())),
            state: PlantState { body_m: road_m, body_m_s: 0.0, wheel_m: road_m, wheel_m_s: 0.0 },
            accelerations_m_s2: [0.0; 2],
        })
    }

    pub fn state(&self) -> &PlantState {
        &self.state
    }

    /// Body and wheel acceleration in m/s² at the end of the last step.
    pub fn accelerations_m_s2(&self) -> [f64; 2] {
        self.accelerations_m_s2
    }

    /// Tire load in N, the static load included, on a road of a height in m with a stiffness in N/m.
    pub(crate) fn tire_n(&self, road_m: f64, stiffness_n_per_m: f64) -> f64 {
        self.tire.static_n + self.tire.force_n(stiffness_n_per_m, road_m - self.state.wheel_m, 0.0)
    }

    /// One classical Runge-Kutta step of `h` seconds. With a damped tire the road's rate is that of the parabola
    /// through the three heights, which makes the step second-order in the tire damper's (small) force.
    pub fn step(&mut self, h: f64, input: &StepInput) {
        let [r0, r1, r2] = input.road_m;
        let [k0, k2] = input.stiffness_n_per_m;
        let half = 0.5 * h;
        let contact = |road_m, rate, stiffness_n_per_m, since_s| Contact {
            road_m,
            road_m_s: rate / h,
            stiffness_n_per_m,
            since_s,
        };
        let start = contact(r0, 4.0 * r1 - 3.0 * r0 - r2, k0, 0.0);
        let middle = contact(r1, r2 - r0, 0.5 * (k0 + k2), half);
        let end = contact(r2, r0 - 4.0 * r1 + 3.0 * r2, k2, h);

        let s0 = self.state;
        let a0 = self.accelerations(&s0, start);
        let s1 = advance(&s0, half, &s0, a0);
        let a1 = self.accelerations(&s1, middle);
        let s2 = advance(&s0, half, &s1, a1);
        let a2 = self.accelerations(&s2, middle);
        let s3 = advance(&s0, h, &s2, a2);
        let a3 = self.accelerations(&s3, end);
        let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * (b + c) + d) * (1.0 / 6.0);
        self.state = PlantState {
            body_m: s0.body_m + h * mean(s0.body_m_s, s1.body_m_s, s2.body_m_s, s3.body_m_s),
            body_m_s: s0.body_m_s + h * mean(a0[0], a1[0], a2[0], a3[0]),
            wheel_m: s0.wheel_m + h * mean(s0.wheel_m_s, s1.wheel_m_s, s2.wheel_m_s, s3.wheel_m_s),
            wheel_m_s: s0.wheel_m_s + h * mean(a0[1], a1[1], a2[1], a3[1]),
        };
        self.accelerations_m_s2 = self.accelerations(&self.state, end);
        self.strut.advance(self.state.wheel_m - self.state.body_m, h);
    }

    /// Newton's second law for both masses (eq. 1, with what it leaves out).
    #[inline]
    fn accelerations(&self, s: &PlantState, contact: Contact) -> [f64; 2] {
        let strut = self.strut.force_n(s.wheel_m - s.body_m, s.body_m_s - s.wheel_m_s, contact.since_s);
        let (deflection_m, rate_m_s) = (contact.road_m - s.wheel_m, contact.road_m_s - s.wheel_m_s);
        let tire = self.tire.force_n(contact.stiffness_n_per_m, deflection_m, rate_m_s);
        [strut * self.per_body_kg, (tire - strut) * self.per_wheel_kg]
    }
}

/// `from`, moved for `h` seconds with the velocities of `at` and the accelerations given.
#[inline]
fn advance(from: &PlantState, h: f64, at: &PlantState, a: [f64; 2]) -> PlantState {
    PlantState {
        body_m: from.body_m + h * at.body_m_s,
        body_m_s: from.body_m_s + h * a[0],
        wheel_m: from.wheel_m + h * at.wheel_m_s,
        wheel_m_s: from.wheel_m_s + h * a[1],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const K_T: f64 = 233_146.0;

    fn run(plant: &mut Plant, h: f64, steps: usize, road: impl Fn(f64) -> f64, k_t: impl Fn(f64) -> f64) {
        for i in 0..steps {
            let t = i as f64 * h;
            let road_m = [road(t), road(t + 0.5 * h), road(t + h)];
            plant.step(h, &StepInput { road_m, stiffness_n_per_m: [k_t(t), k_t(t + h)] });
        }
    }

    /// Transfer from road to body and wheel acceleration at `f` Hz with tire damping `c_t`, from Cramer's rule on the
    /// Laplace transform of eq. (1): `[re, im]` each.
    fn closed_form(f: f64, c_t: f64) -> [[f64; 2]; 2] {
        type C = [f64; 2];
        let mul = |a: C, b: C| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let add = |a: C, b: C| [a[0] + b[0], a[1] + b[1]];
        let div = |a: C, b: C| {
            let n = b[0] * b[0] + b[1] * b[1];
            mul(a, [b[0] / n, -b[1] / n])
        };
        let (m_b, m_w, c_s, k_s) = (240.8, 56.9, 925.8, 29_114.0);
        let w = TAU * f;
        let strut = [k_s, w * c_s];
        let tire = [K_T, w * c_t];
        let body = add([-w * w * m_b, 0.0], strut);
        let wheel = add(add([-w * w * m_w, 0.0], strut), tire);
        let minus_strut_squared = mul([-1.0, 0.0], mul(strut, strut));
        let determinant = add(mul(body, wheel), minus_strut_squared);
        let s_squared = [-w * w, 0.0];
        [
            mul(s_squared, div(mul(strut, tire), determinant)),
            mul(s_squared, div(mul(body, tire), determinant)),
        ]
    }

    /// The same from the plant: a sine for 8 s, then the Fourier coefficient over whole periods.
    fn simulated(f: f64, c_t: f64, h: f64) -> [[f64; 2]; 2] {
        let truth = Deviations { tire_damping_n_s_per_m: c_t, ..Deviations::default() };
        let mut plant = Plant::new(&QuarterCar::paper_table_2(), &truth, 0.0).unwrap();
        let road = |t: f64| (TAU * f * t).sin();
        let settle = (8.0 / h).round() as usize;
        run(&mut plant, h, settle, road, |_| K_T);
        let samples = (2.0 / h).round() as usize;
        let mut sums = [[0.0; 2]; 2];
        for i in 0..samples {
            let t = (settle + i) as f64 * h;
            let road_m = [road(t), road(t + 0.5 * h), road(t + h)];
            plant.step(h, &StepInput { road_m, stiffness_n_per_m: [K_T; 2] });
            let (sin, cos) = (TAU * f * (t + h)).sin_cos();
            for (sum, a) in sums.iter_mut().zip(plant.accelerations_m_s2()) {
                // a = re sin + im cos for a transfer re + i im and a sine road.
                sum[0] += a * sin * 2.0 / samples as f64;
                sum[1] += a * cos * 2.0 / samples as f64;
            }
        }
        sums
    }

    fn relative_error(a: [f64; 2], b: [f64; 2]) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1]) / b[0].hypot(b[1])
    }

    #[test]
    fn the_transfer_from_the_road_is_the_closed_form() {
        for f in [0.5, 1.5, 5.0, 11.0, 20.0, 60.0, 100.0] {
            let (sim, exact) = (simulated(f, 0.0, 1.0 / 4000.0), closed_form(f, 0.0));
            for (s, e) in sim.into_iter().zip(exact) {
                // RK4's error per unit of time is about (ωh)^4/120: 5e-6 at 100 Hz and 4 kHz. After 8 s the sprung mode's transient has
                // fallen to exp(-1.92 * 8) = 2e-7 of a 1 m step, 1e-4 of the small accelerations at 0.5 Hz at worst.
                assert!(relative_error(s, e) < 1e-4, "{f} Hz: {s:?} {e:?}");
            }
        }
    }

    #[test]
    fn a_damped_tire_is_the_closed_form_too() {
        for f in [5.0, 11.0, 60.0] {
            let (sim, exact) = (simulated(f, 300.0, 1.0 / 4000.0), closed_form(f, 300.0));
            for (s, e) in sim.into_iter().zip(exact) {
                // The parabola's rate is off by (ωh)²/12 of ω c_t against K_T at most: 60 Hz, 4e-4.
                assert!(relative_error(s, e) < 1e-3, "{f} Hz: {s:?} {e:?}");
            }
        }
    }

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        let road = |t: f64| 0.01 * (30.0 * t).sin() + 0.003 * (75.0 * t).cos() - 0.003;
        let k_t = |t: f64| K_T - 50_000.0 * t;
        let end = |h: f64| {
            let mut plant = Plant::new(&QuarterCar::paper_table_2(), &Deviations::default(), 0.0).unwrap();
            run(&mut plant, h, (1.0 / h).round() as usize, road, k_t);
            plant.state().wheel_m
        };
        let exact = end(1.0 / 16_384.0);
        let errors: Vec<f64> = [256.0, 512.0, 1024.0].map(|n| (end(1.0 / n) - exact).abs()).into();
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 4.0).abs() < 0.25, "order {order}");
        }
    }

    #[test]
    fn work_of_the_road_is_energy_plus_heat() {
        let (m_b, m_w, c_s, k_s) = (240.8, 56.9, 925.8, 29_114.0);
        let mut plant = Plant::new(&QuarterCar::paper_table_2(), &Deviations::default(), 0.0).unwrap();
        let (h, w) = (1e-4, 60.0);
        let road = |t: f64| 0.01 * (1.0 - (w * t).cos());
        let rate = |t: f64| 0.01 * w * (w * t).sin();
        let (mut work, mut heat) = (0.0, 0.0);
        for i in 0..20_000 {
            let t = i as f64 * h;
            let power = |p: &Plant, t: f64| {
                let s = p.state();
                let slip = s.body_m_s - s.wheel_m_s;
                (K_T * (road(t) - s.wheel_m) * rate(t), c_s * slip * slip)
            };
            let before = power(&plant, t);
            let road_m = [road(t), road(t + 0.5 * h), road(t + h)];
            plant.step(h, &StepInput { road_m, stiffness_n_per_m: [K_T; 2] });
            let after = power(&plant, t + h);
            work += 0.5 * h * (before.0 + after.0);
            heat += 0.5 * h * (before.1 + after.1);
        }
        let s = plant.state();
        let energy = 0.5 * m_b * s.body_m_s.powi(2)
            + 0.5 * m_w * s.wheel_m_s.powi(2)
            + 0.5 * k_s * (s.body_m - s.wheel_m).powi(2)
            + 0.5 * K_T * (road(2.0) - s.wheel_m).powi(2);
        // Trapezoidal sums of the powers: (ωh)²/12 = 3e-6.
        assert!(((work - energy - heat) / heat).abs() < 2e-5, "{work} {energy} {heat}");
        assert!(heat > 1.0);
    }

    #[test]
    fn it_moves_as_the_equations_of_motion_say() {
        let nominal = QuarterCar::<f64>::paper_table_2();
        let mut plant = Plant::new(&nominal, &Deviations::default(), 0.0).unwrap();
        run(&mut plant, 2.5e-4, 4000, |t| 0.01 * (40.0 * t).sin(), |_| K_T);
        let s = *plant.state();
        // docs/math/state-space.md, (1)-(3).
        let strut_n = nominal.spring_n_per_m() * (s.wheel_m - s.body_m)
            + nominal.damping_n_s_per_m() * (s.wheel_m_s - s.body_m_s);
        let tire_n = K_T * (0.01 * 40f64.sin() - s.wheel_m);
        let expected = [strut_n / nominal.sprung_mass_kg(), (tire_n - strut_n) / nominal.unsprung_mass_kg()];
        for (a, expected) in plant.accelerations_m_s2().into_iter().zip(expected) {
            assert!((a - expected).abs() < 1e-9 * (1.0 + a.abs()));
        }
    }

    #[test]
    fn deviations_reach_their_parameters() {
        let truth = Deviations { sprung_mass_factor: 1.08, damper_asymmetry: 0.2, ..Deviations::default() };
        let plant = Plant::new(&QuarterCar::paper_table_2(), &truth, 0.0).unwrap();
        assert!((plant.per_body_kg * 260.064 - 1.0).abs() < 1e-12);
        assert!((plant.strut.force_n(0.0, 1.0, 0.0) + 1110.96).abs() < 1e-9);
        assert!((plant.strut.force_n(0.0, -1.0, 0.0) - 740.64).abs() < 1e-9);
        assert!(Deviations { friction_n: f64::NAN, ..Deviations::default() }.validate().is_err());
    }

    /// A body on a hard tire that swings against dry friction alone loses 4 F/k of its amplitude a cycle and stops where
    /// the spring is weaker than the friction.
    #[test]
    fn a_free_swing_loses_four_times_friction_over_spring_a_cycle() {
        let (spring, friction_n, start_m) = (29_114.0, 50.0, 0.02);
        let nominal = QuarterCar::new(240.8, 56.9, 0.01, spring).unwrap();
        let truth = Deviations { friction_n, friction_presliding_m: [1e-5; 3], ..Deviations::default() };
        let mut plant = Plant::new(&nominal, &truth, 0.0).unwrap();
        plant.state.body_m = start_m;
        plant.strut.place(-start_m);
        let cycle_s = TAU * (240.8f64 / spring).sqrt();
        let (h, mut peaks, mut last) = (2.5e-5, [0.0f64; 2], [start_m; 2]);
        for i in 0..120_000 {
            plant.step(h, &StepInput { road_m: [0.0; 3], stiffness_n_per_m: [5e7; 2] });
            last = [last[1], plant.state().body_m - plant.state().wheel_m];
            // The top of the swing is near the end of a cycle; the wheel trembles about it.
            let cycles = i as f64 * h / cycle_s;
            for (n, peak) in (1..).zip(&mut peaks) {
                if (cycles - f64::from(n)).abs() < 0.25 {
                    *peak = peak.max(last[1]);
                }
            }
        }
        // 20 mm less 6.87 mm a cycle: two more peaks. What slides in over 0.01 mm is worth two thousandths of a cycle.
        let lost = 4.0 * friction_n / spring;
        assert!((peaks[0] - (start_m - lost)).abs() < 0.01 * lost, "{peaks:?} {lost}");
        assert!((peaks[1] - (start_m - 2.0 * lost)).abs() < 0.02 * lost, "{peaks:?} {lost}");
        assert!(last[1].abs() <= friction_n / spring && (last[1] - last[0]).abs() < 1e-7, "{last:?}");
    }
}
