//! Calibration of wheel speeds: how the tires' radii differ, and how the driven axle slips.

use super::state::{BEND, OFFSET, SLIP, UNEQUAL_SLIP};
use crate::memory::Blank;
use crate::real::Real;
use crate::wheel_speed::Tuning;

pub(super) const NUMBERS: usize = 8;
/// The states it holds: three offsets, the slip that is learned with the last one, and those learned with the first two.
pub(super) const LEARNED: [usize; NUMBERS] =
    [OFFSET, OFFSET + 1, OFFSET + 2, SLIP, UNEQUAL_SLIP, UNEQUAL_SLIP + 1, BEND, BEND + 1];

/// The stored calibration, loaded at the next start. In thousandths: the log ratios of the tires' radii front left over
/// right, rear left over right, front over rear, the slip of the driven axle per m/s², what of it the left wheel in front, and the
/// left one at the rear, has more than the right one, and what the load of a bend does to the first two, per m/s² to the left.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RadiusCalibration<T> {
    /// Offsets and slips.
    pub mean_1e3: [T; NUMBERS],
    /// Their covariance.
    pub covariance_1e6: [[T; NUMBERS]; NUMBERS],
    /// The radii at which it was learned, against those at the pressures that should be: zero unless pressures were known to differ.
    pub radius_1e3: [T; 4],
    /// Whether the yaw rate went against the wheels and was left out: so it is from the next start on, until a calibration judges it anew.
    pub leaves_out_yaw_rate: bool,
}

impl<T: Real> RadiusCalibration<T> {
    /// That of no car, to be filled in: of a bend's load it says what is known before any drive.
    #[must_use]
    pub fn nothing() -> Self {
        let mut nothing = Self::BLANK;
        let [mean, sd, _] = Tuning::DEFAULT.bend;
        for (i, _) in LEARNED.into_iter().enumerate().filter(|(_, state)| *state >= BEND) {
            (nothing.mean_1e3[i], nothing.covariance_1e6[i][i]) = (T::lit(mean), T::lit(sd * sd));
        }
        nothing
    }

    /// Whether it can be of a car: finite, offsets below a fifth, variances that are some, correlations below one.
    #[must_use]
    pub fn is_sane(&self) -> bool {
        let most = T::lit(200.0);
        let means = self.mean_1e3.iter().chain(&self.radius_1e3).all(|x| x.abs() < most);
        let variance = |i: usize| self.covariance_1e6[i][i];
        means
            && (0..NUMBERS).all(|i| {
                let row = variance(i) > T::zero() && variance(i) < most * most;
                row && (0..NUMBERS).all(|j| {
                    let entry = self.covariance_1e6[i][j];
                    let bound = variance(i) * variance(j) * T::lit(1.0001);
                    entry == self.covariance_1e6[j][i] && entry * entry <= bound
                })
            })
    }
}
