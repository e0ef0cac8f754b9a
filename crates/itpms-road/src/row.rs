//! A row of a road record, on its way in and out of [`crate::RoadRecorder`].

use itpms_core::Real;

/// One row in the window: memory for [`crate::RoadRecorder`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadRow<T> {
    pub(crate) time_s: f64,
    pub(crate) forward_m: T,
    /// Variance beside the filter's own: the stiffness's uncertainty, and time spent blind, m².
    pub(crate) extra_m2: T,
    pub(crate) smooth_m: T,
    pub(crate) variance_m2: T,
    pub(crate) observed: bool,
}

impl<T: Real> Default for RoadRow<T> {
    fn default() -> Self {
        let zero = T::zero();
        Self {
            time_s: 0.0,
            forward_m: zero,
            extra_m2: zero,
            smooth_m: zero,
            variance_m2: zero,
            observed: false,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadPoint<T> {
    pub time_s: f64,
    /// Road height in m under the wheel at that time, without phase, behind the configured high-pass (0.05 Hz, fourth order in all).
    pub road_m: T,
    /// Its standard deviation in m, slow drift included; for a band use [`crate::RoadLimits::band_sd_m`].
    pub road_sd_m: T,
    /// False where the wheel's acceleration was missing and the height is a bridge between its neighbours.
    pub observed: bool,
}
