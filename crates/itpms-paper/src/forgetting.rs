//! The forgetting factor: the residual's covariance measured from the data (eq. 31-33), how far the gain is from optimal for it (eq.
//! 23-24), and the factor that brings it there, in one step (eq. 28-30) or by descent (eq. 25-27). Derivation: `docs/math/forgetting.md`.
//!
//! Called by [`crate::aekf_ui`]; knows nothing of the state.

use nalgebra::{Matrix2, Matrix2x5, Matrix5, Matrix5x2, Vector2, Vector5};

use crate::config::GradientDescent;
use itpms_core::Real;

/// Fading sums of the residual's outer products (eq. 31-33).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ResidualMemory<T: Real> {
    G_1: Matrix2<T>,
    G_2: T,
}

impl<T: Real> Default for ResidualMemory<T> {
    /// `G_{1,0} = 0`, `G_{2,0} = 0`.
    fn default() -> Self {
        Self { G_1: Matrix2::zeros(), G_2: T::zero() }
    }
}

impl<T: Real> ResidualMemory<T> {
    /// Takes in the residual `z_k` under the previous factor; returns `C_{0,k}`, 2x2 in (m/s²)².
    pub fn take_in(&mut self, z: &Vector2<T>, previous_lambda: T) -> Matrix2<T> {
        // (32)  G₁ₖ = G₁ₖ₋₁/λₖ₋₁ + z zᵀ
        self.G_1 = self.G_1 / previous_lambda + z * z.transpose();
        // (33)  G₂ₖ = G₂ₖ₋₁/λₖ₋₁ + 1
        self.G_2 = self.G_2 / previous_lambda + T::one();
        // (31)  C₀ₖ = G₁ₖ/G₂ₖ
        self.G_1 / self.G_2
    }
}

/// Inputs of the factor: the measurement matrix, `A P⁺ Aᵀ`, the diagonals of `Q` and `R`, and the measured residual covariance.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a, T: Real> {
    /// `H_k`, 2x5.
    pub H: &'a Matrix2x5<T>,
    /// `A P⁺_{k-1} Aᵀ`, 5x5.
    pub propagated: &'a Matrix5<T>,
    /// Diagonal of `Q`.
    pub Q: &'a Vector5<T>,
    /// Diagonal of `R`.
    pub R: &'a Vector2<T>,
    /// `C_{0,k}`, 2x2.
    pub C_0: &'a Matrix2<T>,
}

/// The one-step factor (eq. 28).
pub fn one_step_factor<T: Real>(evidence: &Evidence<'_, T>) -> T {
    let Evidence { H, propagated, Q, R, C_0 } = evidence;
    // (29)  M = H A P⁺ Aᵀ Hᵀ
    let M = *H * *propagated * H.transpose();
    // (30)  N = C₀ - H Q Hᵀ - R
    let N = *C_0 - *H * Matrix5::from_diagonal(Q) * H.transpose() - Matrix2::from_diagonal(R);
    // (28)  λ = max{1, tr N / tr M}
    (N.trace() / M.trace()).max(T::one())
}

/// `T_k` and its derivative to `lambda` for a prior covariance `lambda A P⁺ Aᵀ + Q` (eq. 18, 23).
fn mismatch<T: Real>(evidence: &Evidence<'_, T>, lambda: T) -> Option<(Matrix5x2<T>, Matrix5x2<T>)> {
    let Evidence { H, propagated: F, Q, R, C_0 } = evidence;
    // (18)  P⁻Hᵀ with P⁻ = λF + Q, and its derivative FHᵀ
    let slope = *F * H.transpose();
    let PHt = slope * lambda + Matrix5::from_diagonal(Q) * H.transpose();
    // (16)  K = P⁻Hᵀ(HP⁻Hᵀ + R)⁻¹
    let C_inverse = (*H * PHt + Matrix2::from_diagonal(R)).try_inverse()?;
    let K = PHt * C_inverse;
    // (23)  T = P⁻Hᵀ - K C₀
    let T_k = PHt - K * *C_0;
    // ∂K/∂λ = (FHᵀ - K H F Hᵀ)(HP⁻Hᵀ + R)⁻¹
    let dK = (slope - K * (*H * slope)) * C_inverse;
    Some((T_k, slope - dK * *C_0))
}

/// `g_{lambda,k}` (eq. 24) for a factor; NaN when the residual covariance is singular.
pub fn optimality<T: Real>(evidence: &Evidence<'_, T>, lambda: T) -> T {
    // (24)  g = ½ Σᵢⱼ T²ᵢⱼ
    mismatch(evidence, lambda).map_or(T::lit(f64::NAN), |(t, _)| t.norm_squared() * T::lit(0.5))
}

/// The iterative factor (eq. 25-27), as a descent: eq. (25) is printed with a plus sign, which would climb. Every
/// iterate is kept in `lambda >= 0`, where `P⁻` is a covariance.
///
/// The paper leaves `lambda⁰` open, and it matters: (24) has a second minimum at no gain at all, `lambda = 0`, into
/// which the descent falls from any start with `C_0 R > (H P⁻ Hᵀ + R)²` (scalar case). So it starts from above, at
/// the factor that would explain the whole residual by the state, or at `previous_lambda` if that is larger.
pub fn iterative_factor<T: Real>(
    settings: &GradientDescent<T>,
    evidence: &Evidence<'_, T>,
    previous_lambda: T,
) -> T {
    let M = *evidence.H * *evidence.propagated * evidence.H.transpose();
    let mut lambda = (evidence.C_0.trace() / M.trace()).max(previous_lambda);
    for _ in 0..settings.max_iterations {
        let Some((t, dt)) = mismatch(evidence, lambda) else { break };
        // ∂g/∂λ = Σᵢⱼ Tᵢⱼ ∂Tᵢⱼ/∂λ, and φ = relative step / |∂T/∂λ|²
        let (gradient, curvature) = (t.dot(&dt), dt.norm_squared());
        if !(curvature > T::zero()) {
            break;
        }
        // (25)  λˡ⁺¹ = λˡ - φ ∂g/∂λ
        let next = (lambda - settings.relative_step / curvature * gradient).max(T::zero());
        let moved = (next - lambda).abs();
        lambda = next;
        // (26)  |λˡ⁺¹ - λˡ| < ε
        if !(moved >= settings.tolerance) {
            break;
        }
    }
    // (27)  λ = max{1, λᵖ}
    lambda.max(T::one())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quarter_car::output_jacobian;
    use itpms_core::model::QuarterCar;

    struct Scene {
        h: Matrix2x5<f64>,
        f: Matrix5<f64>,
        q: Vector5<f64>,
        r: Vector2<f64>,
    }

    fn scene() -> Scene {
        let x = Vector5::new(0.012, -0.21, -0.004, 0.35, 198_000.0);
        let mut l = Matrix5::from_diagonal(&Vector5::new(1e-3, 1e-2, 1e-4, 2e-2, 300.0));
        l[(3, 1)] = 5e-3;
        l[(4, 2)] = -20.0;
        Scene {
            h: output_jacobian(&QuarterCar::paper_table_2(), &x, 0.007),
            f: l * l.transpose(),
            q: Vector5::repeat(1e-8),
            r: Vector2::new(0.5, 0.5),
        }
    }

    /// The residual covariance that a filter with `lambda` would believe: there (22) holds exactly.
    fn matching_covariance(s: &Scene, lambda: f64) -> Matrix2<f64> {
        s.h * (s.f * lambda + Matrix5::from_diagonal(&s.q)) * s.h.transpose() + Matrix2::from_diagonal(&s.r)
    }

    fn evidence<'a>(s: &'a Scene, c_0: &'a Matrix2<f64>) -> Evidence<'a, f64> {
        Evidence { H: &s.h, propagated: &s.f, Q: &s.q, R: &s.r, C_0: c_0 }
    }

    #[test]
    fn both_factors_recover_the_one_that_made_the_covariance() {
        let s = scene();
        for lambda in [1.0, 1.7, 12.0] {
            let c_0 = matching_covariance(&s, lambda);
            let e = evidence(&s, &c_0);
            assert!((one_step_factor(&e) / lambda - 1.0).abs() < 1e-9);
            let settings =
                GradientDescent { tolerance: 1e-9, max_iterations: 500, ..GradientDescent::default() };
            let found = iterative_factor(&settings, &e, 1.0);
            assert!((found / lambda - 1.0).abs() < 1e-6, "{found} for {lambda}");
            // (22): the gain is optimal there and nowhere near it.
            assert!(optimality(&e, lambda) < 1e-12 * optimality(&e, 2.0 * lambda));
        }
    }

    #[test]
    fn from_below_the_descent_would_fall_into_the_other_minimum() {
        // The reason for the start from above: g falls towards lambda = 0 on the near side of its hill.
        let s = scene();
        let c_0 = matching_covariance(&s, 12.0);
        let e = evidence(&s, &c_0);
        let (t, dt) = mismatch(&e, 1.0).unwrap();
        assert!(t.dot(&dt) > 0.0);
        assert!(optimality(&e, 0.0) < optimality(&e, 1.0));
    }

    #[test]
    fn a_residual_smaller_than_believed_is_not_forgotten_for() {
        let s = scene();
        let c_0 = matching_covariance(&s, 1.0) * 0.3;
        assert_eq!(one_step_factor(&evidence(&s, &c_0)), 1.0);
        assert_eq!(iterative_factor(&GradientDescent::default(), &evidence(&s, &c_0), 1.0), 1.0);
    }

    #[test]
    fn the_gradient_agrees_with_finite_differences() {
        let s = scene();
        let c_0 = Matrix2::new(900.0, 300.0, 300.0, 4000.0);
        let e = evidence(&s, &c_0);
        for lambda in [0.5, 1.0, 3.0, 40.0] {
            let (t, dt) = mismatch(&e, lambda).unwrap();
            let step = 1e-5 * lambda;
            let difference = (optimality(&e, lambda + step) - optimality(&e, lambda - step)) / (2.0 * step);
            // Central difference of a smooth function: relative error of order step²/lambda² plus rounding.
            assert!((t.dot(&dt) - difference).abs() < 1e-6 * (t.norm() * dt.norm()), "at {lambda}");
        }
    }

    #[test]
    fn without_forgetting_the_measured_covariance_is_the_mean() {
        let mut memory = ResidualMemory::default();
        let residuals = [Vector2::new(1.0, 2.0), Vector2::new(-3.0, 0.5), Vector2::new(0.0, -1.0)];
        let mut c_0 = Matrix2::zeros();
        for z in &residuals {
            c_0 = memory.take_in(z, 1.0);
        }
        assert!((c_0 - Matrix2::new(10.0, 0.5, 0.5, 5.25) / 3.0).amax() < 1e-12);
        // A huge factor leaves the last residual alone.
        let c_0 = memory.take_in(&Vector2::new(2.0, 1.0), 1e12);
        assert!((c_0 - Matrix2::new(4.0, 2.0, 2.0, 1.0)).amax() < 1e-9);
    }
}
