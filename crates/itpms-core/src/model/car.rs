//! Configuration of a car's estimator.

use super::estimate::CornerConfig;
use crate::memory::Blank;
use crate::real::Real;

/// Configuration of a car's estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarConfig<T> {
    /// The corners, in the order of [`Corner::ALL`](crate::model::Corner::ALL); those that are measured.
    pub corners: [Option<CornerConfig<T>>; 4],
    /// Distance between the axles in m; `None`: the shared road is not used.
    pub wheelbase_m: Option<T>,
}

impl<T: Real> Blank for CarConfig<T> {
    /// Corners of zeros: that there is none is no zero.
    const BLANK: Self = Self { corners: [Some(CornerConfig::BLANK); 4], wheelbase_m: None };
}

impl<T> CarConfig<T> {
    /// Whether a corner is measured at all.
    pub fn has_corners(&self) -> bool {
        self.corners.iter().any(Option::is_some)
    }
}

/// When tires may gain air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Inflation {
    /// At stops only: while they roll, tires hold their air or lose it. So after a calibration none is believed to have more
    /// than it was set to, but for warming up.
    #[default]
    #[blank]
    AtStops,
    /// On the way, too: a car with pumps.
    WhileRolling,
}
