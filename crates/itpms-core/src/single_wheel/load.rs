//! What the car weighs and damps today: `γ = c_s/m_b` and `κ = k_s/m_b` from both accelerations, and from them, with
//! what the vehicle file says, masses and damping that fit (docs/math/informed.md, eq. 20-24).
//!
//! The relation between body and wheel does not contain the tire, so a changed load shows here and need not move the
//! pressure. Fed with every frame that counts; knows nothing of stiffness.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use crate::memory::blank;
use crate::real::Real;
use crate::single_wheel::{BINS, Frame};
use crate::spectrum::reconstruction::{BODY_JERK, LEAK_RAD_S, RELATIVE_ACCELERATION, RELATIVE_VELOCITY};
use crate::spectrum::transfer::Body;

/// Memory in s of full information: loads change at stops, dampers over years.
const MEMORY_S: f64 = 60.0;
/// Share of what was learned that counts after a stop.
const AFTER_STOP: f64 = 0.05;
/// Highest frequency in Hz used; above it a body is no rigid mass.
const HIGHEST_HZ: f64 = 30.0;
/// How far load, damping and spring may be from the vehicle file, as sd of their logarithms.
const PRIOR_SD: [f64; 3] = [0.15, 0.2, 0.05];
/// Largest logarithmic deviation believed.
const FURTHEST: f64 = 0.6;
/// Model error that is added to the residual's variance, as a share of the power of the body's jerk: no damper is
/// linear.
const MODEL_ERROR: f64 = 0.02;

/// Running least squares over `s a_b = γ (a_w - a_b) + κ (v_w - v_b)`, sensor noise taken off the regressors.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BodyIdentification<T: Real> {
    nominal: Body<T>,
    /// The car as it seems to be now.
    body: Body<T>,
    /// Logarithmic deviations of mass, damping and spring.
    deviation: Vector3<T>,
    regressors: Matrix2<T>,
    response: Vector2<T>,
}

blank!(BodyIdentification<T> { nominal, body, deviation, regressors, response });

impl<T: Real> BodyIdentification<T> {
    pub(crate) fn new(nominal: Body<T>) -> Self {
        let deviation = Vector3::zeros();
        Self { nominal, body: nominal, deviation, regressors: Matrix2::zeros(), response: Vector2::zeros() }
    }

    /// The car as it seems to be now.
    pub(crate) fn body(&self) -> Body<T> {
        self.body
    }

    /// Learns from a frame; `weight` is its exponent as in the likelihood of the pressure.
    pub(crate) fn learn(
        &mut self,
        frame: &Frame<T>,
        bin_spacing_hz: T,
        noise_density: T,
        weight: T,
        seconds: T,
    ) {
        let keep = (-seconds / T::lit(MEMORY_S)).exp();
        self.regressors *= keep;
        self.response *= keep;
        let [gamma, kappa] = self.ratios();
        for bin in 0..BINS {
            let frequency = bin_spacing_hz * T::lit(bin as f64 + 1.0);
            if frequency > T::lit(HIGHEST_HZ) {
                break;
            }
            let omega = T::two_pi() * frequency;
            let leak_rad_s = T::lit(LEAK_RAD_S);
            let noise = noise_density * omega * omega / (omega * omega + leak_rad_s * leak_rad_s);
            // Residual's noise: |s + γ + κ/s|² of the body's sensor, |γ + κ/s|² of the wheel's.
            let (stiff, reactive) = (kappa / omega, omega - kappa / omega);
            let power = frame.cross(bin, BODY_JERK, BODY_JERK);
            let variance = noise * (reactive * reactive + stiff * stiff + T::lit(2.0) * gamma * gamma)
                + T::lit(MODEL_ERROR) * power;
            let w = weight / variance;
            let cross = |i, j| frame.cross(bin, i, j);
            let (a, v, j) = (RELATIVE_ACCELERATION, RELATIVE_VELOCITY, BODY_JERK);
            let two_noise = T::lit(2.0) * noise;
            self.regressors += Matrix2::new(
                cross(a, a) - two_noise,
                cross(a, v),
                cross(a, v),
                cross(v, v) - two_noise / (omega * omega),
            ) * w;
            // The body's noise is in both sides: Re⟨n_b s · (-n_b/s)*⟩ = +|n_b|².
            self.response += Vector2::new(cross(a, j), cross(v, j) - noise) * w;
        }
        self.fit();
    }

    /// The car stopped: people may have got in or out, so what was seen before counts for little from now on.
    pub(crate) fn doubt(&mut self) {
        self.regressors *= T::lit(AFTER_STOP);
        self.response *= T::lit(AFTER_STOP);
    }

    fn ratios(&self) -> [T; 2] {
        let body = self.body();
        [body.damping_n_s_per_m / body.sprung_mass_kg, body.spring_n_per_m / body.sprung_mass_kg]
    }

    /// One Gauss-Newton step of the logarithmic deviations towards data and prior.
    fn fit(&mut self) {
        let [gamma, kappa] = self.ratios();
        // ∂(γ, κ) / ∂(ln m, ln c, ln k)
        let zero = T::zero();
        let jacobian = Matrix2x3::new(-gamma, gamma, zero, -kappa, zero, kappa);
        let prior = Matrix3::from_diagonal(&Vector3::from(PRIOR_SD.map(|sd| T::lit(1.0 / (sd * sd)))));
        let slope = jacobian.transpose() * (self.response - self.regressors * Vector2::new(gamma, kappa))
            - prior * self.deviation;
        let information = jacobian.transpose() * self.regressors * jacobian + prior;
        // Noise taken off a weak signal can leave the regressors indefinite: then there is nothing to learn yet.
        let Some(cholesky) = information.cholesky() else { return };
        let step = cholesky.solve(&slope);
        let furthest = T::lit(FURTHEST);
        let next = (self.deviation + step * T::lit(0.3)).map(|d| d.clamp(-furthest, furthest));
        if next.iter().all(|d| d.is_finite()) {
            self.deviation = next;
            let factor = next.map(|d| d.exp());
            self.body = Body {
                sprung_mass_kg: self.nominal.sprung_mass_kg * factor[0],
                unsprung_mass_kg: self.nominal.unsprung_mass_kg,
                damping_n_s_per_m: self.nominal.damping_n_s_per_m * factor[1],
                spring_n_per_m: self.nominal.spring_n_per_m * factor[2],
            };
        }
    }
}
