//! Record of one step of the lean filter. Quantities and names are those of
//! [`crate::StepRecord`]; what costs a matrix is left out.
//!
//! Filled by [`crate::lean`]; read by reports and tests.

use nalgebra::{Matrix2, Vector2};

use crate::record::StepStatus;
use itpms_core::Real;

/// One step seen from outside. After [`StepStatus::Updated`] every field is that step's; after any other status the
/// fields of the measurement are NaN and the rest is what the filter holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeanRecord<T: Real> {
    pub status: StepStatus,
    /// `u*_k`: the road's height in m (eq. 16).
    pub road_m: T,
    /// `S_k` in m² (eq. 16).
    pub road_variance_m2: T,
    /// `k_t` in N/m (eq. 17).
    pub stiffness_n_per_m: T,
    /// Its variance `P_55` in (N/m)² (eq. 17).
    pub stiffness_variance_n2_per_m2: T,
    /// Residual (innovation) `z_k` in m/s², body and wheel (eq. 19).
    pub residual_m_s2: Vector2<T>,
    /// The residual's covariance as the filter believes it, `H P⁻ Hᵀ + R`, in (m/s²)² (eq. 20).
    pub believed_covariance: Matrix2<T>,
    /// Trace of the residual's covariance as measured, `tr C_{0,k}`, in (m/s²)² (eq. 31).
    pub measured_trace: T,
    /// `lambda_k` (eq. 28); 1 without forgetting.
    pub forgetting: T,
}

impl<T: Real> LeanRecord<T> {
    /// `zᵀ (H P⁻ Hᵀ + R)⁻¹ z`: 2 on average for a filter that believes rightly (`lean-aekf-ui.md`, eq. 67).
    pub fn nis(&self) -> T {
        let (z, C) = (&self.residual_m_s2, &self.believed_covariance);
        let along = C.m12 / C.m11;
        let rest = z.y - along * z.x;
        // (67)  z₀²/c₀₀ + (z₁ - c₀₁/c₀₀ z₀)²/(c₁₁ - c₀₁²/c₀₀)
        z.x * z.x / C.m11 + rest * rest / (C.m22 - along * C.m12)
    }

    /// The standard deviation the filter claims for the stiffness, in N/m.
    pub fn stiffness_sd_n_per_m(&self) -> T {
        self.stiffness_variance_n2_per_m2.max(T::zero()).sqrt()
    }

    /// True once the filter has diverged.
    pub fn is_diverged(&self) -> bool {
        matches!(self.status, StepStatus::Diverged(_))
    }
}
