//! The paper's filters.
//!
//! Called by whoever turns a drive into estimates or draws the paper's figures; knows nothing of pressure, files,
//! clocks or what a warning is. Derivations: `docs/math/ekf-ui.md` and `docs/math/forgetting.md`.
//!
//! | room | idea |
//! |---|---|
//! | [`config`] | what a published filter is told: start, covariances, the readings of the ambiguous equations |
//! | [`ekf_ui`] | the recursion with unknown input, one function a stage (eq. 6-17) |
//! | [`forgetting`] | the residual's covariance and the factor drawn from it (eq. 18-37) |
//! | [`aekf_ui`] | both put together: [`AekfUi`], which is the EKF-UI when told not to forget |
//! | [`record`] | what one step says about itself |
//!
//! **The published filters do not find the tire stiffness.** Two accelerations and an arbitrary road fix the tire's
//! force, not its stiffness; `k_t` stays where it started (shown in `docs/math/ekf-ui.md`, tested in
//! `tests/published_filter.rs`). They are here to the letter so that this can be seen.

pub mod aekf_ui;
pub mod config;
pub mod ekf_ui;
pub mod forgetting;
pub mod record;

pub use aekf_ui::AekfUi;
pub use config::{CorrectionInput, FactorTiming, FilterConfig, Forgetting, GradientDescent};
pub use record::{Divergence, StepRecord, StepStatus};
