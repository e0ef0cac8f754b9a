//! What a calibration teaches: how the tires' radii differ, and how the driven axle slips.

use super::{OFFSET, SLIP};
use crate::memory::blank;
use crate::real::Real;

/// The states it holds: three offsets, and the slip that is learned with the last one.
pub(super) const LEARNED: [usize; 4] = [OFFSET, OFFSET + 1, OFFSET + 2, SLIP];

/// What to store after a calibration and load at the next start. In thousandths: the log ratios of the tires' radii front left over
/// right, rear left over right, front over rear, and the slip of the driven axle per m/s².
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RadiusCalibration<T> {
    /// Offsets and slip.
    pub mean_1e3: [T; 4],
    /// Their covariance.
    pub covariance_1e6: [[T; 4]; 4],
    /// The radii at which it was learned, against those at the pressures that should be: zero unless pressures were known to differ.
    pub radius_1e3: [T; 4],
}

blank!(RadiusCalibration<T> { mean_1e3, covariance_1e6, radius_1e3 });

impl<T: Real> RadiusCalibration<T> {
    /// Whether it can be of a car: finite, offsets below a fifth, variances that are some, correlations below one.
    #[must_use]
    pub fn is_sane(&self) -> bool {
        let most = T::lit(200.0);
        let means = self.mean_1e3.iter().chain(&self.radius_1e3).all(|x| x.abs() < most);
        let variance = |i: usize| self.covariance_1e6[i][i];
        means
            && (0..4).all(|i| {
                let row = variance(i) > T::zero() && variance(i) < most * most;
                row && (0..4).all(|j| {
                    let entry = self.covariance_1e6[i][j];
                    let bound = variance(i) * variance(j) * T::lit(1.0001);
                    entry == self.covariance_1e6[j][i] && entry * entry <= bound
                })
            })
    }
}
