//! In the place of the periodic road without feature `test-bench`: no road is taken to repeat itself.

use crate::real::Real;
use crate::spectrum::transfer::Body;

/// Whether the road repeats itself: without feature `test-bench` it never does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RoadRepetition {
    /// Never looked for.
    #[default]
    Never,
}

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
    pub(crate) surprise: T,
    /// Seconds since the last word.
    pub(crate) seconds: T,
    /// True once per period.
    pub(crate) whole_period: bool,
}

/// What is believed of the compliance from elsewhere when the road is met.
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
    Yes,
    /// Else.
    No,
}

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

/// A road that never repeats itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RepeatedRoad<T>(core::marker::PhantomData<T>);

impl<T: Real> RepeatedRoad<T> {
    pub(crate) fn new(_: RoadRepetition, _: f64, _: f64) -> Self {
        Self(core::marker::PhantomData)
    }

    pub(crate) fn interrupted(&mut self, _: T) {}

    pub(crate) fn push(
        &mut self,
        _: &Step<T>,
        _: &Corner<T>,
        _: impl FnOnce() -> Belief<T>,
    ) -> Option<PeriodicEstimate<T>> {
        None
    }

    pub(crate) fn is_following(&self) -> bool {
        false
    }
}
