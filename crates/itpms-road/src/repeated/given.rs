//! Input of a repeated road: the car, and the belief about the tire.

use itpms_core::model::QuarterCar;

/// Belief about the compliance from outside when the road is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Belief<T> {
    pub(crate) theta: T,
    pub(crate) relative_sd: T,
    /// True while it is known to be constant, as during a calibration.
    pub(crate) held: Held,
}

/// Whether the pressure is known not to move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Held {
    /// During a calibration drive.
    Yes = 1,
    /// Else.
    No = 0,
}

/// Parameters of the car and its sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner<T> {
    pub(crate) quarter_car: QuarterCar<T>,
    /// One-sided accelerometer noise density in (m/s²)²/Hz.
    pub(crate) noise_density: T,
}
