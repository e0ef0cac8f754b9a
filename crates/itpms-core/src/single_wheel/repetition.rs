//! What a corner and its repeated road tell each other.

use crate::memory::blank;
use crate::spectrum::transfer::Body;

/// The compliance that a repeated road tells.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PeriodicEstimate<T> {
    /// Compliance in m/N.
    pub(crate) theta: T,
    /// Its relative standard deviation.
    pub(crate) relative_sd: T,
    /// Relative change of the compliance per second.
    pub(crate) rate_per_s: T,
    /// Probability that it changes.
    pub(crate) moving: T,
    /// Residual power over expected power: about 1 when the model holds.
    pub(crate) nis: T,
    /// Seconds since the last estimate.
    pub(crate) seconds: T,
    /// True once per period.
    pub(crate) whole_period: bool,
}

blank!(PeriodicEstimate<T> { theta, relative_sd, rate_per_s, moving, nis, seconds, whole_period });

/// What is believed of the compliance by others when the road is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Belief<T> {
    /// Compliance in m/N.
    pub(crate) theta: T,
    /// Its relative standard deviation.
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

blank!(Held::No);

/// One grid step of what the road velocity is made of: `wheel + θ force`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step<T> {
    pub(crate) wheel: T,
    pub(crate) force: T,
    /// A sensor was at its limit.
    pub(crate) invalid: bool,
}

/// What is known of the car and its sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner<T> {
    pub(crate) body: Body<T>,
    /// One-sided accelerometer noise density in (m/s²)²/Hz.
    pub(crate) noise_density: T,
}
