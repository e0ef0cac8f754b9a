//! The paper's filters, and the paper's filter corrected.
//!
//! To be studied, not to be shipped: a controller takes [`itpms_core`] alone, which this crate is built on. Derivations: `docs/math/ekf-ui.md`, `docs/math/forgetting.md` and `docs/math/lean-aekf-ui.md`.
//!
//! | module | idea |
//! |---|---|
//! | [`config`] | what a published filter is given: start, covariances, the readings of the ambiguous equations |
//! | [`quarter_car`] | the state, its motion and its Jacobians (eq. 1-4) |
//! | [`ekf_ui`] | the recursion with unknown input, one function a stage (eq. 6-17) |
//! | [`forgetting`] | the residual's covariance and the factor drawn from it (eq. 18-37) |
//! | [`aekf_ui`] | both put together: [`AekfUi`], which is the EKF-UI when set not to forget |
//! | [`record`] | what one step says about itself |
//! | [`lean`] | the same filter in closed form: [`AekfUiLean`], for controllers and `f32` |
//! | [`informed_config`], [`informed_record`] | the same for the corrected filter |
//! | [`motion`] | body and wheel under the tire's force: linear, third order, without drift |
//! | [`parameter`] | forgetting on one scalar parameter |
//! | [`aekf_ui_informed`] | the corrected filter: [`AekfUiInformed`], which needs to be given the stiffness |
//! | `kind` | the estimators by name, the default one of [`itpms_core`] among them |
//! | `estimator`, `car` | a corner or a car estimated by one of these filters, as [`itpms_core`] estimates it |
//!
//! **The published filters do not find the tire stiffness.** Two accelerations and an arbitrary road fix the tire's
//! force, not its stiffness; `k_t` stays where it started (shown in `docs/math/ekf-ui.md`, tested in
//! `tests/published_filter.rs`). They are here to the letter so that this can be seen.

#![no_std]
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a part of the program: names say it, and comments what they do not")]
#![allow(non_snake_case, reason = "matrices have the paper's letters")]
#![allow(clippy::op_ref)] // A matrix that is multiplied by value is copied on the stack first.

pub mod aekf_ui;
pub mod aekf_ui_informed;
mod car;
pub mod config;
pub mod ekf_ui;
mod estimator;
pub mod forgetting;
pub mod informed_config;
pub mod informed_record;
mod kind;
pub mod lean;
pub mod motion;
pub mod parameter;
pub mod quarter_car;
pub mod record;

pub use aekf_ui::AekfUi;
pub use aekf_ui_informed::AekfUiInformed;
pub use car::PaperCar;
pub use config::{CorrectionInput, FactorTiming, FilterConfig, Forgetting, GradientDescent};
pub use estimator::{AnyEstimator, PaperEstimator};
pub use informed_config::InformedConfig;
pub use informed_record::{InformedRecord, InformedStatus, StiffnessUpdate};
pub use kind::EstimatorKind;
pub use lean::{AekfUiLean, LeanError, LeanRecord};
pub use parameter::ParameterForgetting;
pub use record::{Divergence, StepRecord, StepStatus};
