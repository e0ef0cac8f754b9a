//! Problems of a stored reference; read by people as part of a [`Problem`](crate::error::Problem).

use itpms_core::model::CalibrationError;
use thiserror::Error;

/// Why a reference is not used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ReferenceProblem {
    #[error("is no learned reference: its beginning is {found:?}, expected \"itpms-reference\"")]
    Foreign { found: String },
    #[error("the learned reference is damaged: its checksum says {found}, expected {expected}")]
    Damaged { found: String, expected: String },
    #[error("the learned reference has format {found}, expected at most {newest}: a newer itpms wrote it")]
    Newer { found: u32, newest: u32 },
    #[error("the reference was learned on a vehicle whose {what} is {found}, expected {expected}")]
    OtherVehicle { what: &'static str, found: String, expected: String },
    #[error("the learned reference is not plausible: {0}")]
    Implausible(CalibrationError),
    #[error(
        "the calibration shows a wheelbase of {found_m:.2} m, the vehicle file has {file_m} m: measure it, or write wheelbase_sd_m = 0.15 beside wheelbase_m to have it learned"
    )]
    Wheelbase { found_m: f64, file_m: f64 },
    #[error("the learned reference does not have {0}")]
    Lacks(&'static str),
}
