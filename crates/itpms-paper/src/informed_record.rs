//! Records of a step of the corrected filter, and of a stiffness measurement to it.
//!
//! Filled by [`crate::aekf_ui_informed`]; read by estimators, reports and tests.

use nalgebra::{Matrix5, Vector2, Vector5};

use crate::quarter_car::state;
use itpms_core::Real;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum InformedStatus {
    Updated,
    /// A measurement was missing or absurd: predicted only.
    PredictedOnly,
    /// The time step was not a positive, finite number: nothing was done.
    Ignored,
    /// After a gap, or because the numbers left their range: the motion starts from rest, the stiffness is kept.
    Restarted,
}

/// One step seen from outside. After any status but [`InformedStatus::Updated`] residual and NIS are NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InformedRecord<T: Real> {
    pub status: InformedStatus,
    /// State in the order and units of [`state`]; displacements and velocities without their drift.
    pub state: Vector5<T>,
    /// Force of the tire on the wheel in N, less its share of the weight.
    pub tire_force_n: T,
    /// Road height in m, without drift: the road less what the leak forgot of the wheel's displacement.
    pub road_m: T,
    pub road_variance_m2: T,
    /// Joint covariance of the four motion states and, at [`crate::motion::TIRE_FORCE`], the tire's force, 5x5.
    pub motion_covariance: Matrix5<T>,
    /// Variance of the stiffness in (N/m)²; it has no covariance with the motion.
    pub stiffness_variance: T,
    /// Innovation with the force held, in m/s².
    pub residual_m_s2: Vector2<T>,
    /// Squared, normalised residual after the input is estimated: 1 on average when consistent.
    pub nis: T,
    /// The factor that the last stiffness measurement brought about; 1 keeps everything.
    pub forgetting: T,
}

impl<T: Real> InformedRecord<T> {
    pub fn stiffness_n_per_m(&self) -> T {
        self.state[state::TIRE_STIFFNESS]
    }

    pub fn stiffness_sd_n_per_m(&self) -> T {
        self.stiffness_variance.sqrt()
    }

    pub fn road_sd_m(&self) -> T {
        self.road_variance_m2.sqrt()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StiffnessUpdate<T> {
    Used {
        /// Measurement minus estimate before the update, in N/m.
        innovation_n_per_m: T,
        /// Square of the innovation over its believed variance: 1 on average when consistent. The variance is the
        /// one before forgetting, so that a change of the tire shows here.
        nis: T,
        forgetting: T,
    },
    /// It carried no information and was left out: a value, score or information that is not finite, a standard
    /// deviation or information that is not positive, or a standard deviation of 1e9 N/m and more.
    Ignored,
}
