//! Products with the quarter car's Jacobians, of which only two rows are neither zero nor one.
//! Derivation: `docs/math/lean-aekf-ui.md`, section 1.
//!
//! Called by [`crate::lean`]; knows nothing of covariances, noise or measurements.

use crate::quarter_car::state::{
    BODY_POSITION, BODY_VELOCITY, TIRE_STIFFNESS, WHEEL_POSITION, WHEEL_VELOCITY,
};
use itpms_core::Real;
use itpms_core::model::QuarterCar;

/// A state, or a row or column of a 5x5 matrix, in the order and units of [`crate::quarter_car::state`].
pub type StateVector<T> = [T; 5];

/// The corner with its masses inverted: divisions are paid for once.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Corner<T> {
    /// Spring `k_s` in N/m.
    pub k_s: T,
    /// Damper `c_s` in N s/m.
    pub c_s: T,
    /// Unsprung mass `m_w` in kg.
    pub m_w: T,
    /// `1/m_b` in 1/kg.
    pub per_m_b: T,
    /// `1/m_w` in 1/kg.
    pub per_m_w: T,
}

impl<T: Real> Corner<T> {
    pub fn new(car: &QuarterCar<T>) -> Self {
        Self {
            k_s: car.spring_n_per_m(),
            c_s: car.damping_n_s_per_m(),
            m_w: car.unsprung_mass_kg(),
            per_m_b: car.sprung_mass_kg().recip(),
            per_m_w: car.unsprung_mass_kg().recip(),
        }
    }

    #[inline(always)]
    pub fn suspension(&self, x: &StateVector<T>) -> T {
        // (53)  sᵀx = k_s (x_w - x_b) + c_s (ẋ_w - ẋ_b)
        self.k_s * (x[WHEEL_POSITION] - x[BODY_POSITION]) + self.c_s * (x[WHEEL_VELOCITY] - x[BODY_VELOCITY])
    }

    /// `h(x, u*)`: body and wheel acceleration in m/s².
    #[inline(always)]
    pub fn accelerations(&self, x: &StateVector<T>, road_m: T) -> [T; 2] {
        let suspension = self.suspension(x);
        let tire = x[TIRE_STIFFNESS] * (road_m - x[WHEEL_POSITION]);
        [self.per_m_b * suspension, self.per_m_w * (tire - suspension)]
    }

    /// The two rows of `H` at a state and a road height, times `scale`.
    #[inline(always)]
    pub fn acceleration_rows(&self, x: &StateVector<T>, road_m: T, scale: T) -> AccelerationRows<T> {
        let per_m_w = scale * self.per_m_w;
        AccelerationRows {
            corner: *self,
            per_m_b: scale * self.per_m_b,
            per_m_w,
            tire: per_m_w * x[TIRE_STIFFNESS],
            deflection: per_m_w * (road_m - x[WHEEL_POSITION]),
        }
    }
}

/// `scale h_0` and `scale h_1`: derivatives of body and wheel acceleration by the state.
#[derive(Debug, Clone, Copy)]
pub struct AccelerationRows<T> {
    corner: Corner<T>,
    /// `scale / m_b`.
    pub per_m_b: T,
    /// `scale / m_w`.
    pub per_m_w: T,
    /// `scale k_t / m_w`.
    pub tire: T,
    /// `scale (u* - x_w) / m_w`.
    pub deflection: T,
}

impl<T: Real> AccelerationRows<T> {
    #[inline(always)]
    pub fn times(&self, v: &StateVector<T>) -> [T; 2] {
        // (54)  h₀ᵀv = sᵀv/m_b,  h₁ᵀv = (e v₄ - k_t v₂ - sᵀv)/m_w
        let suspension = self.corner.suspension(v);
        let wheel =
            self.deflection * v[TIRE_STIFFNESS] - self.tire * v[WHEEL_POSITION] - self.per_m_w * suspension;
        [self.per_m_b * suspension, wheel]
    }

    /// `A v` of the Euler step of `dt_s` seconds; the rows must have been scaled by `dt_s`.
    #[inline(always)]
    pub fn step(&self, v: &StateVector<T>, dt_s: T) -> StateVector<T> {
        // (55)  A = I + Δt (ε₀ε₁ᵀ + ε₁h₀ᵀ + ε₂ε₃ᵀ + ε₃h₁ᵀ)
        let [body, wheel] = self.times(v);
        [
            v[BODY_POSITION] + dt_s * v[BODY_VELOCITY],
            v[BODY_VELOCITY] + body,
            v[WHEEL_POSITION] + dt_s * v[WHEEL_VELOCITY],
            v[WHEEL_VELOCITY] + wheel,
            v[TIRE_STIFFNESS],
        ]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix5, Vector5};

    use super::*;
    use crate::quarter_car;

    #[test]
    fn the_products_are_those_of_the_full_jacobians() {
        let car = QuarterCar::<f64>::paper_table_2();
        let (x, road, dt) = (Vector5::new(0.012, -0.21, -0.004, 0.35, 198_000.0), 0.007, 2e-3);
        let corner = Corner::new(&car);
        let (h, a) =
            (quarter_car::output_jacobian(&car, &x, road), quarter_car::derivative_jacobian(&car, &x, road));
        let rows = corner.acceleration_rows(&x.into(), road, 1.0);
        let scaled = corner.acceleration_rows(&x.into(), road, dt);
        // Every column of a basis in which no element is zero.
        let basis = Matrix5::from_fn(|i, j| 1.0 / (1.0 + i as f64 + j as f64));
        for v in basis.column_iter() {
            let column: StateVector<f64> = v.into_owned().into();
            let full = h * v;
            for (found, expected) in rows.times(&column).iter().zip(&full) {
                assert!((found - expected).abs() < 1e-13 * full.amax());
            }
            let stepped = v + a * v * dt;
            let found = Vector5::from(scaled.step(&column, dt));
            assert!((found - stepped).amax() < 1e-13 * stepped.amax());
        }
        let y = corner.accelerations(&x.into(), road);
        assert!((nalgebra::Vector2::from(y) - quarter_car::output(&car, &x, road)).amax() < 1e-13);
    }
}
