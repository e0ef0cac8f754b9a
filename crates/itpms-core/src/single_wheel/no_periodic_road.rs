//! In the place of the periodic road without feature `test-bench`: no road is taken to repeat itself.

use crate::memory::{Blank, blank};
use crate::real::Real;
pub(crate) use crate::single_wheel::repetition::{Belief, Corner, Held, PeriodicEstimate, Step};

/// Whether the road repeats itself: without feature `test-bench` it never does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RoadRepetition {
    /// Never looked for.
    #[default]
    Never,
}

blank!(RoadRepetition::Never);

/// A road that never repeats itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RepeatedRoad<T>(core::marker::PhantomData<T>);

impl<T: Real> Blank for RepeatedRoad<T> {
    const BLANK: Self = Self(core::marker::PhantomData);
}

impl<T: Real> RepeatedRoad<T> {
    pub(crate) fn configure(&mut self, _: RoadRepetition, _: f64, _: f64) {}

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
