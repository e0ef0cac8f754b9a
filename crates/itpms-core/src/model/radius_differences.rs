//! By how much the tires' radii differ from what they were at a calibration, as a source that compares wheel speeds finds it.

use crate::memory::Blank;

/// Derivatives of the three ratios by each wheel's radius.
pub(crate) const SEEN: [[f64; 3]; 4] =
    [[1.0, 0.0, 0.5], [-1.0, 0.0, 0.5], [0.0, 1.0, -0.5], [0.0, -1.0, -0.5]];

/// Changes of three ratios of rolling radii since the calibration, in thousandths of the log: front left over right, rear left over
/// right, front over rear (the mean of left and right each). What all four radii do alike is in none of them. Given to
/// [`CarEstimator::follow_radii`](crate::CarEstimator::follow_radii).
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RadiusDifferences<T> {
    pub change_1e3: [T; 3],
    /// Their covariance in the order 00, 10, 11, 20, 21, 22, with what loads may have done.
    pub covariance_1e6: [T; 6],
    /// Change of the log of a radius per change of the log of the pressure.
    pub per_ln_pressure: T,
    /// Its standard deviation, as a share of it.
    pub per_ln_pressure_relative_sd: T,
}
