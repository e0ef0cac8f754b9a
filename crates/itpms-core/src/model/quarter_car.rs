//! The quarter car: one sprung and one unsprung mass, a linear spring and damper between them, a tire as a
//! spring to the road (paper eq. 1-4, Fig. 2). Displacements and road point up, in metres.
//!
//! Called by every filter and estimator; knows nothing of pressure, time or sensors.

use nalgebra::{Matrix2x5, Matrix5, Vector2, Vector5};
use thiserror::Error;

use crate::memory::blank;
use crate::real::Real;

/// Names of the state's components (eq. 2), used instead of bare indices.
pub mod state {
    /// Sprung mass displacement `x_b` in m.
    pub const BODY_POSITION: usize = 0;
    /// Sprung mass velocity in m/s.
    pub const BODY_VELOCITY: usize = 1;
    /// Unsprung mass displacement `x_w` in m.
    pub const WHEEL_POSITION: usize = 2;
    /// Unsprung mass velocity in m/s.
    pub const WHEEL_VELOCITY: usize = 3;
    /// Tire stiffness `k_t` in N/m.
    pub const TIRE_STIFFNESS: usize = 4;
}

/// Names of the measurement's components (eq. 3): both in m/s².
pub mod output {
    /// Sprung mass acceleration.
    pub const BODY_ACCELERATION: usize = 0;
    /// Unsprung mass acceleration.
    pub const WHEEL_ACCELERATION: usize = 1;
}

/// A parameter outside its physical range.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{name} is {value}, expected {expected}")]
pub struct ParameterError {
    /// The parameter's name with its unit, as in the vehicle file.
    pub name: &'static str,
    /// What was given.
    pub value: f64,
    /// What would be accepted.
    pub expected: &'static str,
}

/// `value` if it is finite and positive (NaN is neither).
///
/// # Errors
/// It is not; the error calls it `name`.
pub fn positive<T: Real>(name: &'static str, value: T) -> Result<T, ParameterError> {
    if value > T::zero() && value.is_finite() {
        Ok(value)
    } else {
        Err(ParameterError { name, value: value.to_f64(), expected: "a positive, finite number" })
    }
}

/// Parameters of one corner of the car, valid by construction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct QuarterCar<T> {
    sprung_mass_kg: T,
    unsprung_mass_kg: T,
    damping_n_s_per_m: T,
    spring_n_per_m: T,
}

blank!(QuarterCar<T> { sprung_mass_kg, unsprung_mass_kg, damping_n_s_per_m, spring_n_per_m });

impl<T: Real> QuarterCar<T> {
    /// A quarter car of sprung mass `m_b`, unsprung mass `m_w` (kg), damping `c_s` (N s/m) and suspension spring
    /// `k_s` (N/m).
    ///
    /// # Errors
    /// Names the first parameter that is not a positive, finite number.
    pub fn new(
        sprung_mass_kg: T,
        unsprung_mass_kg: T,
        damping_n_s_per_m: T,
        spring_n_per_m: T,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            sprung_mass_kg: positive("sprung_mass_kg", sprung_mass_kg)?,
            unsprung_mass_kg: positive("unsprung_mass_kg", unsprung_mass_kg)?,
            damping_n_s_per_m: positive("damping_n_s_per_m", damping_n_s_per_m)?,
            spring_n_per_m: positive("spring_n_per_m", spring_n_per_m)?,
        })
    }

    /// The paper's simulated corner (Table 2).
    #[must_use]
    pub fn paper_table_2() -> Self {
        Self {
            sprung_mass_kg: T::lit(240.8),
            unsprung_mass_kg: T::lit(56.9),
            damping_n_s_per_m: T::lit(925.8),
            spring_n_per_m: T::lit(29_114.0),
        }
    }

    /// Sprung mass `m_b` in kg.
    pub fn sprung_mass_kg(&self) -> T {
        self.sprung_mass_kg
    }

    /// Unsprung mass `m_w` in kg.
    pub fn unsprung_mass_kg(&self) -> T {
        self.unsprung_mass_kg
    }

    /// Damping `c_s` in N s/m.
    pub fn damping_n_s_per_m(&self) -> T {
        self.damping_n_s_per_m
    }

    /// Suspension spring `k_s` in N/m.
    pub fn spring_n_per_m(&self) -> T {
        self.spring_n_per_m
    }

    /// `ẋ = f(x, x_r)` (eq. 3, complete): the state's time derivative for a road height in m.
    #[allow(non_snake_case)]
    pub fn derivative(&self, x: &Vector5<T>, road_m: T) -> Vector5<T> {
        let y = self.output(x, road_m);
        Vector5::new(
            x[state::BODY_VELOCITY],
            y[output::BODY_ACCELERATION],
            x[state::WHEEL_VELOCITY],
            y[output::WHEEL_ACCELERATION],
            T::zero(),
        )
    }

    /// `y = h(x, x_r)` (eq. 3): body and wheel acceleration in m/s².
    pub fn output(&self, x: &Vector5<T>, road_m: T) -> Vector2<T> {
        let (m_b, m_w) = (self.sprung_mass_kg, self.unsprung_mass_kg);
        // Suspension force on the body: k_s (x_w - x_b) + c_s (ẋ_w - ẋ_b)
        let suspension = self.spring_n_per_m * (x[state::WHEEL_POSITION] - x[state::BODY_POSITION])
            + self.damping_n_s_per_m * (x[state::WHEEL_VELOCITY] - x[state::BODY_VELOCITY]);
        // Tire force on the wheel: k_t (x_r - x_w)
        let tire = x[state::TIRE_STIFFNESS] * (road_m - x[state::WHEEL_POSITION]);
        Vector2::new(suspension / m_b, (tire - suspension) / m_w)
    }

    /// `∂f/∂x`, 5x5.
    pub fn derivative_jacobian(&self, x: &Vector5<T>, road_m: T) -> Matrix5<T> {
        let h = self.output_jacobian(x, road_m);
        let mut a = Matrix5::zeros();
        a[(state::BODY_POSITION, state::BODY_VELOCITY)] = T::one();
        a[(state::WHEEL_POSITION, state::WHEEL_VELOCITY)] = T::one();
        a.set_row(state::BODY_VELOCITY, &h.row(output::BODY_ACCELERATION));
        a.set_row(state::WHEEL_VELOCITY, &h.row(output::WHEEL_ACCELERATION));
        a
    }

    /// `H = ∂h/∂x`, 2x5.
    pub fn output_jacobian(&self, x: &Vector5<T>, road_m: T) -> Matrix2x5<T> {
        let (m_b, m_w) = (self.sprung_mass_kg, self.unsprung_mass_kg);
        let (k_s, c_s) = (self.spring_n_per_m, self.damping_n_s_per_m);
        let k_t = x[state::TIRE_STIFFNESS];
        Matrix2x5::new(
            -k_s / m_b,
            -c_s / m_b,
            k_s / m_b,
            c_s / m_b,
            T::zero(),
            k_s / m_w,
            c_s / m_w,
            -(k_s + k_t) / m_w,
            -c_s / m_w,
            (road_m - x[state::WHEEL_POSITION]) / m_w,
        )
    }

    /// `D* = ∂h/∂x_r`, 2x1: only the wheel feels the road directly.
    pub fn input_jacobian(&self, x: &Vector5<T>) -> Vector2<T> {
        Vector2::new(T::zero(), x[state::TIRE_STIFFNESS] / self.unsprung_mass_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some_state() -> (Vector5<f64>, f64) {
        (Vector5::new(0.012, -0.21, -0.004, 0.35, 198_000.0), 0.007)
    }

    #[test]
    fn jacobians_agree_with_finite_differences() {
        let car = QuarterCar::<f64>::paper_table_2();
        let (x, road) = some_state();
        let (a, h, d) =
            (car.derivative_jacobian(&x, road), car.output_jacobian(&x, road), car.input_jacobian(&x));
        for j in 0..5 {
            let step = 1e-6 * x[j].abs().max(1e-3);
            let (mut up, mut down) = (x, x);
            up[j] += step;
            down[j] -= step;
            // f and h are bilinear in (x, k_t), so the central difference is exact up to rounding.
            let df = (car.derivative(&up, road) - car.derivative(&down, road)) / (2.0 * step);
            let dh = (car.output(&up, road) - car.output(&down, road)) / (2.0 * step);
            assert!((df - a.column(j)).amax() <= 1e-6 * (1.0 + a.column(j).amax()));
            assert!((dh - h.column(j)).amax() <= 1e-6 * (1.0 + h.column(j).amax()));
        }
        let dd = (car.output(&x, road + 1e-6) - car.output(&x, road - 1e-6)) / 2e-6;
        assert!((dd - d).amax() <= 1e-6 * d.amax());
    }

    #[test]
    fn momentum_balances_the_tire_force() {
        // Adding both lines of eq. (1): m_b a_b + m_w a_w = k_t (x_r - x_w).
        let car = QuarterCar::<f64>::paper_table_2();
        let (x, road) = some_state();
        let y = car.output(&x, road);
        let force = car.sprung_mass_kg() * y[0] + car.unsprung_mass_kg() * y[1];
        let tire = x[state::TIRE_STIFFNESS] * (road - x[state::WHEEL_POSITION]);
        assert!((force - tire).abs() < 1e-9 * tire.abs());
    }

    #[test]
    fn a_parameter_outside_its_range_is_named() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(QuarterCar::new(bad, 50.0, 900.0, 3e4).unwrap_err().name, "sprung_mass_kg");
            assert_eq!(QuarterCar::new(240.0, bad, 900.0, 3e4).unwrap_err().name, "unsprung_mass_kg");
            assert_eq!(QuarterCar::new(240.0, 50.0, bad, 3e4).unwrap_err().name, "damping_n_s_per_m");
            assert_eq!(QuarterCar::new(240.0, 50.0, 900.0, bad).unwrap_err().name, "spring_n_per_m");
        }
    }
}
