//! What one step of a published filter says about itself: every quantity the paper draws, and whether it holds.
//!
//! Filled by [`crate::aekf_ui`]; read by reports and tests.

use nalgebra::{Matrix2, Matrix5, Vector2, Vector5};

use crate::quarter_car::state;
use itpms_core::Real;

/// How a filter left its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Divergence {
    /// A state, covariance, factor or input became infinite or NaN.
    NotFinite,
    /// The stiffness left the range of anything with a tire on it.
    StiffnessOutOfRange,
    /// A displacement, velocity or the road left the range of anything on wheels.
    MotionOutOfRange,
    /// The measurement no longer determined the input (`S_k` not positive).
    InputNotDetermined,
    /// A variance on the diagonal of the covariance fell below zero.
    NegativeVariance,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StepStatus {
    Updated,
    /// A measurement was missing (not finite): predicted only, with the input held.
    PredictedOnly,
    /// The time step was not a positive, finite number: nothing was done.
    Ignored,
    /// The filter has diverged, now or earlier; it holds its last good state until it is reset.
    Diverged(Divergence),
}

/// One step seen from outside. After [`StepStatus::Updated`] every field is that step's; after any other status the
/// fields of the measurement are NaN and the rest is what the filter holds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepRecord<T: Real> {
    pub status: StepStatus,
    /// `x⁻_k`, in the order and units of [`state`].
    pub prior_state: Vector5<T>,
    /// `P⁻_k` (eq. 14, 18).
    pub prior_covariance: Matrix5<T>,
    /// `x⁺_k` (eq. 17).
    pub state: Vector5<T>,
    /// `P⁺_k` (eq. 17).
    pub covariance: Matrix5<T>,
    /// `u*_k`: the road's height in m (eq. 16).
    pub road_m: T,
    /// `S_k` in m² (eq. 16).
    pub road_variance_m2: T,
    /// Residual `z_k` in m/s² (eq. 19).
    pub residual_m_s2: Vector2<T>,
    /// The residual's covariance as the filter believes it, `H P⁻ Hᵀ + R`, in (m/s²)² (eq. 20).
    pub believed_covariance: Matrix2<T>,
    /// The residual's covariance as measured, `C_{0,k}`, in (m/s²)² (eq. 31).
    pub measured_covariance: Matrix2<T>,
    /// `zᵀ (H P⁻ Hᵀ + R)⁻¹ z`: 2 on average for a filter that believes rightly.
    pub nis: T,
    /// `lambda_k` (eq. 27, 28); 1 without forgetting.
    pub forgetting: T,
    /// `g_{lambda,k}` (eq. 24): 0 when the gain is optimal for the measured covariance.
    pub optimality: T,
}

impl<T: Real> StepRecord<T> {
    pub fn stiffness_n_per_m(&self) -> T {
        self.state[state::TIRE_STIFFNESS]
    }

    pub fn stiffness_sd_n_per_m(&self) -> T {
        self.covariance[(state::TIRE_STIFFNESS, state::TIRE_STIFFNESS)].max(T::zero()).sqrt()
    }

    /// True once the filter has diverged.
    pub fn is_diverged(&self) -> bool {
        matches!(self.status, StepStatus::Diverged(_))
    }
}
