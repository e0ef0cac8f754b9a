//! The quarter car as a system (docs/math/state-space.md): the paper's state and outputs (eq. 2-4), and their Jacobians. Displacements and
//! road point up, in metres.
//!
//! Called by the filters; knows nothing of pressure, time or sensors.

use itpms_core::Real;
use itpms_core::model::QuarterCar;
use nalgebra::{Matrix2x5, Matrix5, Vector2, Vector5};

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
    pub const BODY_ACCELERATION: usize = 0;
    pub const WHEEL_ACCELERATION: usize = 1;
}

/// `ẋ = f(x, x_r)` (eq. 3, complete): the state's time derivative for a road height in m.
pub fn derivative<T: Real>(car: &QuarterCar<T>, x: &Vector5<T>, road_m: T) -> Vector5<T> {
    let y = output(car, x, road_m);
    Vector5::new(
        x[state::BODY_VELOCITY],
        y[output::BODY_ACCELERATION],
        x[state::WHEEL_VELOCITY],
        y[output::WHEEL_ACCELERATION],
        T::zero(),
    )
}

/// `y = h(x, x_r)` (eq. 3): body and wheel acceleration in m/s².
pub fn output<T: Real>(car: &QuarterCar<T>, x: &Vector5<T>, road_m: T) -> Vector2<T> {
    let (m_b, m_w) = (car.sprung_mass_kg(), car.unsprung_mass_kg());
    // Suspension force on the body: k_s (x_w - x_b) + c_s (ẋ_w - ẋ_b)
    let suspension = car.spring_n_per_m() * (x[state::WHEEL_POSITION] - x[state::BODY_POSITION])
        + car.damping_n_s_per_m() * (x[state::WHEEL_VELOCITY] - x[state::BODY_VELOCITY]);
    // Tire force on the wheel: k_t (x_r - x_w)
    let tire = x[state::TIRE_STIFFNESS] * (road_m - x[state::WHEEL_POSITION]);
    Vector2::new(suspension / m_b, (tire - suspension) / m_w)
}

/// `∂f/∂x`, 5x5.
pub fn derivative_jacobian<T: Real>(car: &QuarterCar<T>, x: &Vector5<T>, road_m: T) -> Matrix5<T> {
    let h = output_jacobian(car, x, road_m);
    let mut a = Matrix5::zeros();
    a[(state::BODY_POSITION, state::BODY_VELOCITY)] = T::one();
    a[(state::WHEEL_POSITION, state::WHEEL_VELOCITY)] = T::one();
    a.set_row(state::BODY_VELOCITY, &h.row(output::BODY_ACCELERATION));
    a.set_row(state::WHEEL_VELOCITY, &h.row(output::WHEEL_ACCELERATION));
    a
}

/// `H = ∂h/∂x`, 2x5.
pub fn output_jacobian<T: Real>(car: &QuarterCar<T>, x: &Vector5<T>, road_m: T) -> Matrix2x5<T> {
    let (m_b, m_w) = (car.sprung_mass_kg(), car.unsprung_mass_kg());
    let (k_s, c_s) = (car.spring_n_per_m(), car.damping_n_s_per_m());
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
pub fn input_jacobian<T: Real>(car: &QuarterCar<T>, x: &Vector5<T>) -> Vector2<T> {
    Vector2::new(T::zero(), x[state::TIRE_STIFFNESS] / car.unsprung_mass_kg())
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
            (derivative_jacobian(&car, &x, road), output_jacobian(&car, &x, road), input_jacobian(&car, &x));
        for j in 0..5 {
            let step = 1e-6 * x[j].abs().max(1e-3);
            let (mut up, mut down) = (x, x);
            up[j] += step;
            down[j] -= step;
            // f and h are bilinear in (x, k_t), so the central difference is exact up to rounding.
            let df = (derivative(&car, &up, road) - derivative(&car, &down, road)) / (2.0 * step);
            let dh = (output(&car, &up, road) - output(&car, &down, road)) / (2.0 * step);
            assert!((df - a.column(j)).amax() <= 1e-6 * (1.0 + a.column(j).amax()));
            assert!((dh - h.column(j)).amax() <= 1e-6 * (1.0 + h.column(j).amax()));
        }
        let dd = (output(&car, &x, road + 1e-6) - output(&car, &x, road - 1e-6)) / 2e-6;
        assert!((dd - d).amax() <= 1e-6 * d.amax());
    }

    #[test]
    fn momentum_balances_the_tire_force() {
        // Adding both lines of eq. (1): m_b a_b + m_w a_w = k_t (x_r - x_w).
        let car = QuarterCar::<f64>::paper_table_2();
        let (x, road) = some_state();
        let y = output(&car, &x, road);
        let force = car.sprung_mass_kg() * y[0] + car.unsprung_mass_kg() * y[1];
        let tire = x[state::TIRE_STIFFNESS] * (road - x[state::WHEEL_POSITION]);
        assert!((force - tire).abs() < 1e-9 * tire.abs());
    }
}
