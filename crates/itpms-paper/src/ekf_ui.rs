//! The extended Kalman filter with unknown input, equations (6)-(17), one function a stage.
//!
//! Called by [`crate::aekf_ui`], which holds the state between steps. Knows nothing of how the forgetting factor is
//! chosen, of divergence or of time beyond one step.

use nalgebra::{Matrix2, Matrix2x5, Matrix5, Matrix5x2, Vector2, Vector5};

use crate::config::CorrectionInput;
use itpms_core::Real;
use itpms_core::model::QuarterCar;

use crate::quarter_car;

/// The prediction stage's result, before any forgetting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction<T: Real> {
    /// `x⁻_k`.
    pub state: Vector5<T>,
    /// `A_{k-1}` of the discrete system.
    pub transition: Matrix5<T>,
    /// `A P⁺ Aᵀ`, to which forgetting and process noise are applied by [`prior_covariance`].
    pub propagated: Matrix5<T>,
}

/// Prediction of the state by one Euler step of `dt_s` seconds, the paper's discretisation (eq. 6-9, 13, 14).
pub fn predict<T: Real>(car: &QuarterCar<T>, x: &Vector5<T>, u: T, P: &Matrix5<T>, dt_s: T) -> Prediction<T> {
    // (13)  Aₖ₋₁ = ∂fₖ₋₁/∂x = I + Δt ∂f/∂x  at x̂⁺ₖ₋₁, u*ₖ₋₁
    let A = Matrix5::identity() + quarter_car::derivative_jacobian(car, x, u) * dt_s;
    // (7), (8), (14)  x̂⁻ₖ = x̂⁺ₖ₋₁ + Δt f(x̂⁺ₖ₋₁, u*ₖ₋₁)
    let state = x + quarter_car::derivative(car, x, u) * dt_s;
    Prediction { state, transition: A, propagated: A * P * A.transpose() }
}

/// `P⁻_k` from the propagated covariance, a factor and the diagonal of `Q` (eq. 14 with `lambda = 1`, eq. 18).
pub fn prior_covariance<T: Real>(propagated: &Matrix5<T>, lambda: T, Q: &Vector5<T>) -> Matrix5<T> {
    // (18)  P⁻ₖ = λ A P⁺ₖ₋₁ Aᵀ + Q
    propagated * lambda + Matrix5::from_diagonal(Q)
}

/// The measurement predicted from the prior state (eq. 15, 19).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlook<T: Real> {
    /// `H_k`, 2x5.
    pub H: Matrix2x5<T>,
    /// `D*_k`, 2x1.
    pub D: Vector2<T>,
    /// Residual `z_k` in m/s².
    pub z: Vector2<T>,
}

/// Jacobians and residual at the prior state and the previous input (eq. 15, 19).
pub fn look_out<T: Real>(
    car: &QuarterCar<T>,
    x_prior: &Vector5<T>,
    u_previous: T,
    y: &Vector2<T>,
) -> Outlook<T> {
    Outlook {
        // (15)  Hₖ = ∂h/∂x at x̂⁻ₖ,  D*ₖ = ∂h/∂u* (which does not depend on u* here)
        H: quarter_car::output_jacobian(car, x_prior, u_previous),
        D: quarter_car::input_jacobian(car, x_prior),
        // (19)  zₖ = yₖ - h(x̂⁻ₖ, u*ₖ₋₁)
        z: y - quarter_car::output(car, x_prior, u_previous),
    }
}

/// The input estimate and the gain it comes with (eq. 16, 20).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputEstimate<T: Real> {
    /// `H P⁻ Hᵀ + R`, the residual's covariance as the filter believes it, in (m/s²)².
    pub C: Matrix2<T>,
    /// `K_k`, 5x2.
    pub K: Matrix5x2<T>,
    /// `S_k`: the input's variance in m².
    pub S: T,
    /// `u*_k`: the road's height in m.
    pub u: T,
}

/// Gain and unknown input (eq. 16). `R` is the diagonal of the measurement covariance. `None` when the measurement
/// does not determine the input: a singular residual covariance or `S_k` not positive and finite.
pub fn estimate_input<T: Real>(
    outlook: &Outlook<T>,
    P: &Matrix5<T>,
    R: &Vector2<T>,
    u_previous: T,
) -> Option<InputEstimate<T>> {
    let Outlook { H, D, z } = outlook;
    // (20)  HP⁻Hᵀ + R
    let C = H * P * H.transpose() + Matrix2::from_diagonal(R);
    // (16)  K = P⁻Hᵀ(HP⁻Hᵀ + R)⁻¹, as the solution of Cᵀ Kᵀ = H P⁻ᵀ
    let K = C.transpose().lu().solve(&(H * P.transpose()))?.transpose();
    // (16)  D*ᵀR⁻¹(I - HK)
    let weight = D.component_div(R).transpose() * (Matrix2::identity() - H * K);
    // (16)  S = [D*ᵀR⁻¹(I - HK)D*]⁻¹
    let S = T::one() / (weight * D).x;
    if !(S > T::zero() && S.is_finite()) {
        return None;
    }
    // (16)  u* = S D*ᵀR⁻¹(I - HK)[y - h(x̂⁻, u*ₖ₋₁) + D*u*ₖ₋₁]
    let u = S * (weight * (z + D * u_previous)).x;
    Some(InputEstimate { C, K, S, u })
}

/// Correction of state and covariance (eq. 17), in the paper's product form.
pub fn correct<T: Real>(
    car: &QuarterCar<T>,
    x_prior: &Vector5<T>,
    P: &Matrix5<T>,
    R: &Vector2<T>,
    outlook: &Outlook<T>,
    input: &InputEstimate<T>,
    y: &Vector2<T>,
    reading: CorrectionInput,
) -> (Vector5<T>, Matrix5<T>) {
    let (Outlook { H, D, z }, InputEstimate { K, S, u, .. }) = (outlook, input);
    let innovation = match reading {
        CorrectionInput::Current => y - quarter_car::output(car, x_prior, *u),
        CorrectionInput::Previous => *z,
    };
    // (17)  x̂⁺ = x̂⁻ + K[y - h(x̂⁻, u*)]
    let x = x_prior + K * innovation;
    let I = Matrix5::identity();
    // (17)  P⁺ = [I + K D* S D*ᵀ R⁻¹ H](I - KH)P⁻
    let P = (I + K * D * (D.component_div(R).transpose() * *S) * H) * (I - K * H) * P;
    (x, P)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> (QuarterCar<f64>, Vector5<f64>, f64, Matrix5<f64>, Vector2<f64>) {
        let x = Vector5::new(0.012, -0.21, -0.004, 0.35, 198_000.0);
        // A full symmetric positive definite covariance: L Lᵀ with some lower triangle.
        let mut l = Matrix5::from_diagonal(&Vector5::new(0.01, 0.1, 0.02, 0.3, 300.0));
        l[(1, 0)] = 0.05;
        l[(2, 1)] = -0.01;
        l[(3, 2)] = 0.1;
        l[(4, 3)] = 20.0;
        l[(4, 0)] = -30.0;
        (QuarterCar::paper_table_2(), x, 0.007, l * l.transpose(), Vector2::new(1.3, -4.2))
    }

    /// Generalised least squares over state and input at once: minimise
    /// `(x - x⁻)ᵀ P⁻¹ (x - x⁻) + (r - H dx - D du)ᵀ R⁻¹ (..)` by its 6x6 normal equations.
    fn joint_least_squares(
        o: &Outlook<f64>,
        p: &Matrix5<f64>,
        r: &Vector2<f64>,
    ) -> (nalgebra::Vector6<f64>, nalgebra::Matrix6<f64>) {
        let mut g = nalgebra::Matrix2x6::zeros();
        g.fixed_view_mut::<2, 5>(0, 0).copy_from(&o.H);
        g.set_column(5, &o.D);
        let w = Matrix2::from_diagonal(&r.map(|v| 1.0 / v));
        let mut information = g.transpose() * w * g;
        let prior = p.try_inverse().unwrap();
        let block = information.fixed_view::<5, 5>(0, 0) + prior;
        information.fixed_view_mut::<5, 5>(0, 0).copy_from(&block);
        let covariance = information.try_inverse().unwrap();
        (covariance * g.transpose() * w * o.z, covariance)
    }

    #[test]
    fn one_step_is_joint_least_squares_over_state_and_input() {
        // Yang et al. derive (16)-(17) as the minimiser of one quadratic form in state and input. An independent
        // solution of that form must give the same state, input and covariances (reading `Current`).
        let (car, x, u, p, y) = scene();
        let r = Vector2::new(0.5, 0.7);
        let o = look_out(&car, &x, u, &y);
        let input = estimate_input(&o, &p, &r, u).unwrap();
        let (x_plus, p_plus) = correct(&car, &x, &p, &r, &o, &input, &y, CorrectionInput::Current);
        let (step, covariance) = joint_least_squares(&o, &p, &r);
        for i in 0..5 {
            let scale = covariance[(i, i)].sqrt();
            assert!((x_plus[i] - x[i] - step[i]).abs() < 1e-6 * scale, "state {i}");
            for j in 0..5 {
                let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
                assert!((p_plus[(i, j)] - covariance[(i, j)]).abs() < 1e-6 * scale, "covariance {i} {j}");
            }
        }
        assert!((input.u - u - step[5]).abs() < 1e-6 * covariance[(5, 5)].sqrt());
        assert!((input.S / covariance[(5, 5)] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn prediction_is_an_euler_step() {
        let (car, x, u, p, _) = scene();
        let dt = 1e-3;
        let prediction = predict(&car, &x, u, &p, dt);
        // Written out from eq. (1), not through `QuarterCar`.
        let force = 29_114.0 * (x[2] - x[0]) + 925.8 * (x[3] - x[1]);
        assert!((prediction.state[0] - (x[0] + dt * x[1])).abs() < 1e-15);
        assert!((prediction.state[1] - (x[1] + dt * force / 240.8)).abs() < 1e-15);
        assert!((prediction.state[3] - (x[3] + dt * (x[4] * (u - x[2]) - force) / 56.9)).abs() < 1e-13);
        assert_eq!(prediction.state[4], x[4]);
        // The covariance of the step: (18) with λ = 1 adds Q to A P Aᵀ.
        let q = Vector5::new(1.0, 2.0, 3.0, 4.0, 5.0);
        let prior = prior_covariance(&prediction.propagated, 1.0, &q);
        assert!((prior.diagonal() - prediction.propagated.diagonal() - q).amax() < 1e-9);
    }

    #[test]
    fn an_input_the_measurement_does_not_see_is_refused() {
        let (car, mut x, u, p, y) = scene();
        // Without stiffness the road moves nothing: D* = 0.
        x[4] = 0.0;
        let o = look_out(&car, &x, u, &y);
        assert!(estimate_input(&o, &p, &Vector2::new(0.5, 0.5), u).is_none());
    }
}
