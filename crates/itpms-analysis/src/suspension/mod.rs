//! Dampers and load of a whole car from the accelerations of its body and wheels: what a drive has shown against what the car was when it
//! was healthy (docs/math/dampers.md).
//!
//! Called by `itpms-drive` with the rows of a log, beside the estimator of the pressures, which knows nothing of it. The idea is one:
//! over a drive the cross-spectral matrix of all signals in the body's equation of motion is summed up; whatever is asked afterwards –
//! parameters, residuals, their covariance, with springs free or held, stiffened or not – is computed from that matrix. It is as large
//! after an hour as after a minute.
//!
//! | module | idea |
//! |---|---|
//! | `car_body` | a car as its vehicle file has it |
//! | `signals` | accelerations of a corner to the signals that its strut's force is made of, by filters that all signals pass |
//! | `spectra` | frames of these to their cross-spectral matrix, bin by bin; rough frames apart |
//! | `equation` | the body's equation of motion: what each signal counts in it, for given parameters |
//! | `fit` | the parameters that fit best, from the matrix alone |
//! | `reading` | struts and body of a drive; a reference from it, or against one |
//! | `health` | dampers: over the reference, left over right, front over rear; states |
//! | `load` | mass on the axles |
//! | `verdict` | both, as far as they may be judged |
//! | `because` | why they are not |

mod because;
mod car_body;
mod equation;
mod fit;
mod health;
mod load;
mod reading;
mod signals;
mod spectra;
#[cfg(test)]
mod tests;
mod verdict;

pub use because::Because;
pub use car_body::CarBody;
pub use health::{DamperHealth, DamperState, Measured};
pub use load::{Load, LoadState, Masses};
pub use reading::SuspensionReading;
pub use spectra::SuspensionSpectra;
pub use verdict::{SuspensionVerdict, Terms};
