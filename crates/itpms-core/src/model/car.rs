//! What an estimator is told about the car.

use super::estimate::CornerConfig;
use crate::memory::blank;

/// What an estimator is told about the car.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarConfig<T> {
    /// The corners, in the order of [`Corner::ALL`](crate::model::Corner::ALL); those that are measured.
    pub corners: [Option<CornerConfig<T>>; 4],
    /// Distance between the axles in m; `None`: the shared road is not used.
    pub wheelbase_m: Option<T>,
}

blank!(CarConfig<T> { corners, wheelbase_m });

/// When tires may gain air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Inflation {
    /// At stops only: while they roll, tires hold their air or lose it. So after a calibration none is believed to have more
    /// than it was set to, but for warming up.
    #[default]
    AtStops,
    /// On the way, too: a car with pumps.
    WhileRolling,
}

blank!(Inflation::AtStops);
