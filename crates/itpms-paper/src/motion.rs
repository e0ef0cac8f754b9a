//! Motion of body and wheel under the tire's force, for the corrected filter: linear, without drift, stepped to
//! third order. Derivation: `docs/math/ekf-ui.md`, section 5; its equations (39)-(42) continue the paper's numbering.
//!
//! Called by [`crate::aekf_ui_informed`]; knows nothing of the stiffness, of covariances or of time beyond one step.

use nalgebra::{Matrix2x4, Matrix4, Matrix5, RowVector4, Vector2, Vector4};

use crate::quarter_car::{output, state};
use itpms_core::Real;
use itpms_core::model::QuarterCar;

/// Place of the tire's force behind the four motion states of [`state`].
pub const TIRE_FORCE: usize = 4;

/// The linear system `ẋ = A x + b F`, `y = H x + D F` of the four motion states and the tire's force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<T: Real> {
    /// 4x4, leak included.
    pub A: Matrix4<T>,
    /// 4x1, per N.
    pub b: Vector4<T>,
    /// 2x4: what the accelerometers see of the state.
    pub H: Matrix2x4<T>,
    /// 2x1: what they see of the force.
    pub D: Vector2<T>,
}

/// One step of a [`Motion`] with the force moving in a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionStep<T: Real> {
    /// `Φ = ∂x_k/∂x_{k-1}`, 4x4.
    pub Phi: Matrix4<T>,
    /// `∂x_k/∂F_{k-1}`: effect of the force at the start of the step.
    pub G_0: Vector4<T>,
    /// `∂x_k/∂F_k`: effect of the force at its end.
    pub G_1: Vector4<T>,
}

impl<T: Real> Motion<T> {
    /// The quarter car pushed by its tire, forgetting what body and wheel share at `leak_rad_s`.
    pub fn new(car: &QuarterCar<T>, leak_rad_s: T) -> Self {
        let (k_s, c_s) = (car.spring_n_per_m(), car.damping_n_s_per_m());
        // (39)  suspension force on the body: k_s (x_w - x_b) + c_s (ẋ_w - ẋ_b)
        let suspension = RowVector4::new(-k_s, -c_s, k_s, c_s);
        let mut H = Matrix2x4::zeros();
        H.set_row(output::BODY_ACCELERATION, &(suspension / car.sprung_mass_kg()));
        H.set_row(output::WHEEL_ACCELERATION, &(-suspension / car.unsprung_mass_kg()));
        let D = Vector2::new(T::zero(), T::one() / car.unsprung_mass_kg());
        let mut A = Matrix4::zeros();
        A[(state::BODY_POSITION, state::BODY_VELOCITY)] = T::one();
        A[(state::WHEEL_POSITION, state::WHEEL_VELOCITY)] = T::one();
        A.set_row(state::BODY_VELOCITY, &H.row(output::BODY_ACCELERATION));
        A.set_row(state::WHEEL_VELOCITY, &H.row(output::WHEEL_ACCELERATION));
        // (40)  the same ω x_w and ω ẋ_w taken from body and wheel: their difference stays exact
        for position in [state::BODY_POSITION, state::WHEEL_POSITION] {
            A[(position, state::WHEEL_POSITION)] -= leak_rad_s;
        }
        for velocity in [state::BODY_VELOCITY, state::WHEEL_VELOCITY] {
            A[(velocity, state::WHEEL_VELOCITY)] -= leak_rad_s;
        }
        let mut b = Vector4::zeros();
        b[state::WHEEL_VELOCITY] = D[output::WHEEL_ACCELERATION];
        Self { A, b, H, D }
    }

    /// A step of `dt_s` seconds, exact to third order.
    pub fn step(&self, dt_s: T) -> MotionStep<T> {
        let Self { A, b, .. } = self;
        let I = Matrix4::identity();
        let (half, third) = (dt_s * T::lit(1.0 / 2.0), dt_s * T::lit(1.0 / 3.0));
        // (41)  Ψ = Δt (I + Δt/2 A + Δt²/6 A²),  Φ = I + Ψ A
        let Psi = (I + (I + A * third) * A * half) * dt_s;
        // (42)  G₁ = Δt/2 (I + Δt/3 A) b,  G₀ + G₁ = Ψ b
        let G_1 = (b + A * b * third) * half;
        MotionStep { Phi: I + Psi * A, G_0: Psi * b - G_1, G_1 }
    }

    /// The same step over a road that keeps its height under a tire of stiffness `k_t`: 5x5 for motion and force,
    /// which then follows the wheel, `Ḟ = -k_t ẋ_w`.
    pub fn step_on_still_road(&self, k_t: T, dt_s: T) -> Matrix5<T> {
        let mut A = Matrix5::zeros();
        A.fixed_view_mut::<TIRE_FORCE, TIRE_FORCE>(0, 0).copy_from(&self.A);
        A.fixed_view_mut::<TIRE_FORCE, 1>(0, TIRE_FORCE).copy_from(&self.b);
        A[(TIRE_FORCE, state::WHEEL_VELOCITY)] = -k_t;
        let I = Matrix5::identity();
        // (41) for the five
        I + (I + (I + A * (dt_s * T::lit(1.0 / 3.0))) * A * (dt_s * T::lit(1.0 / 2.0))) * A * dt_s
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector5;

    use super::*;
    use crate::quarter_car;

    const LEAK: f64 = 0.6;

    fn motion(leak: f64) -> Motion<f64> {
        Motion::new(&QuarterCar::paper_table_2(), leak)
    }

    fn start() -> Vector4<f64> {
        Vector4::new(0.012, -0.21, -0.004, 0.35)
    }

    #[test]
    fn without_leak_it_is_the_quarter_car_at_any_stiffness() {
        let (car, motion, x, force) = (QuarterCar::<f64>::paper_table_2(), motion(0.0), start(), 830.0);
        for k_t in [90_000.0, 233_000.0] {
            let full = Vector5::new(x[0], x[1], x[2], x[3], k_t);
            let road = x[2] + force / k_t;
            let derivative = quarter_car::derivative(&car, &full, road);
            assert!((motion.A * x + motion.b * force - derivative.fixed_rows::<4>(0)).amax() < 1e-12);
            assert!(
                (motion.H * x + motion.D * force - quarter_car::output(&car, &full, road)).amax() < 1e-12
            );
        }
    }

    #[test]
    fn the_leak_leaves_relative_motion_alone() {
        let (with, without) = (motion(LEAK).A * start(), motion(0.0).A * start());
        assert!(((with[0] - with[2]) - (without[0] - without[2])).abs() < 1e-15);
        assert!(((with[1] - with[3]) - (without[1] - without[3])).abs() < 1e-12);
        assert!((with[2] - without[2] + LEAK * start()[2]).abs() < 1e-15);
    }

    /// The same motion by many small Runge-Kutta steps, the force moving linearly by `rate` N/s.
    fn fine(x: &Vector4<f64>, force: f64, rate: f64, dt: f64) -> Vector4<f64> {
        let m = motion(LEAK);
        let h = dt / 200.0;
        let f = |x: &Vector4<f64>, t: f64| m.A * x + m.b * (force + rate * t);
        let mut x = *x;
        for i in 0..200 {
            let t = f64::from(i) * h;
            let k1 = f(&x, t);
            let k2 = f(&(x + k1 * (h / 2.0)), t + h / 2.0);
            let k3 = f(&(x + k2 * (h / 2.0)), t + h / 2.0);
            let k4 = f(&(x + k3 * h), t + h);
            x += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
        }
        x
    }

    #[test]
    fn the_step_is_of_third_order_in_the_state_and_in_the_force() {
        let x = start();
        for rate in [0.0, 2e5] {
            let error = |dt: f64| {
                let MotionStep { Phi, G_0, G_1 } = motion(LEAK).step(dt);
                (Phi * x + G_0 * 500.0 + G_1 * (500.0 + rate * dt) - fine(&x, 500.0, rate, dt)).amax()
            };
            // Halving the step divides the local error by 2⁴, up to the next order's part in it.
            let ratio = error(2e-3) / error(1e-3);
            assert!((ratio - 16.0).abs() < 1.5, "{ratio}");
        }
    }

    #[test]
    fn on_a_still_road_energy_is_lost_to_the_damper_only() {
        // No leak: a wheel left alone on its tire comes to rest where spring and tire carry nothing.
        let step = motion(0.0).step_on_still_road(233_000.0, 2e-3);
        let mut x = Vector5::new(0.0, 0.0, 0.0, 0.3, 0.0);
        let energy = |x: &Vector5<f64>| {
            let (m_b, m_w, k_s) = (240.8, 56.9, 29_114.0);
            m_b * x[1].powi(2) + m_w * x[3].powi(2) + k_s * (x[2] - x[0]).powi(2) + x[4].powi(2) / 233_000.0
        };
        let first = energy(&x);
        let mut before = first;
        for _ in 0..2000 {
            x = step * x;
            assert!(energy(&x) <= before * (1.0 + 1e-9));
            before = energy(&x);
        }
        // Four seconds are some four time constants of the body's motion (2 m_b/c_s = 0.52 s).
        assert!(before < 1e-4 * first, "{before} of {first}");
    }
}
