//! Identification of a spring, a damper and a tire on a bench: the numbers of a vehicle file with their standard errors
//! (paper, Sec. 5.1, eq. 5, Table 1; docs/math/identification.md).
//!
//! | module | idea |
//! |---|---|
//! | `spring` | stiffness from load and displacement |
//! | `damper`, `damper_result`, `motion`, `sine`, `doubts` | damping from sinusoidal excitation: the fit, the rows made ready for it, frequencies, concerns |
//! | `bump` | spring, damper, friction, hop and tire from a drop or a bump |
//! | `calibrate` | the pressure-stiffness line of a tire |
//! | `blocks` | least squares whose covariance comes from the disagreement of blocks |
//! | `strokes`, `loops` | where a displacement turns; what is left beside a line |
//! | `estimate`, `distribution` | a number with its standard error; Student's t and its kin |
//! | `guard`, `error` | what is refused, and the sentence that says so |
//! | `text`, `figures` | results for people |
//!
//! Called by the binary with columns of numbers; knows no files. A result names what it could not make sure of
//! (`concerns`); what makes a number meaningless is an error.

mod blocks;
mod bump;
mod calibrate;
mod damper;
mod damper_result;
mod distribution;
mod doubts;
mod error;
mod estimate;
mod figures;
mod guard;
mod loops;
mod motion;
mod sine;
mod spring;
mod strokes;
mod text;

pub use bump::{BumpCorner, BumpFit, BumpMasses, BumpParts, BumpResult, BumpSignals, BumpWindow, bump};
pub use calibrate::{Calibration, CalibrationRow, Coefficient, Test, calibrate};
pub use damper::damper;
pub use damper_result::{Consistency, DamperResult, RunResult};
pub use error::{IdentifyError, Result};
pub use estimate::{ErrorBasis, Estimate};
pub use guard::Units;
pub use motion::SineRecord;
pub use spring::{Nonlinearity, SpringResult, spring};
