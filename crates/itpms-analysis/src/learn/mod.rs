//! A car's parameters from drives at known pressures: what the drives show is weighed against what the vehicle file says and how well
//! it says it is known (docs/math/learn.md).
//!
//! Called by whoever has drives, logged or simulated: each goes through a [`Listener`], then [`learn`] makes of the file's car the
//! learned one. Knows no files and no truth.
//!
//! | module | idea |
//! |---|---|
//! | `listen` | one drive: what its tires and struts read |
//! | `weigh` | all drives and the file: masses, tires, the slope of stiffness over pressure |
//! | `strut` | the same of a damper, a spring, a friction |
//! | `learned` | the car that comes out, parameter by parameter |
//! | `wheelbase` | before all that: how far behind the front wheels the rear ones meet the same road |

mod learned;
mod listen;
mod parameter;
mod strut;
#[cfg(test)]
mod tests;
mod weigh;
mod wheelbase;

use itpms_core::model::{CarConfig, ParameterError};
use thiserror::Error;

pub use learned::{Learned, LearnedCorner};
pub use listen::{DriveReading, Listener, StrutMean, WheelReading};
pub use parameter::Parameter;
pub use wheelbase::{FoundWheelbase, WheelbaseListener};

/// How often drives should be gone through, the second time with the car that the first has taught: where dampers are far from the
/// file's, the tires are read better with better ones.
pub const PASSES: usize = 2;

#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LearnError {
    #[error("no drive, expected one at least")]
    NoDrive,
    #[error(
        "drive {0} of the list: no tire was read for a minute after the first 30 s, expected some minutes of driving at more than walking pace"
    )]
    TooLittle(usize),
    #[error("what was learned is no car: {0}")]
    Parameter(#[from] ParameterError),
}

/// The car of the file as it is after these drives.
pub fn learn(file: &CarConfig<f64>, drives: &[DriveReading]) -> Result<Learned, LearnError> {
    if drives.is_empty() {
        return Err(LearnError::NoDrive);
    }
    if let Some(drive) = drives.iter().position(|drive| drive.wheels.iter().all(Option::is_none)) {
        return Err(LearnError::TooLittle(drive + 1));
    }
    let belief = weigh::weigh(file, drives);
    learned::learned(file, &belief, drives)
}
