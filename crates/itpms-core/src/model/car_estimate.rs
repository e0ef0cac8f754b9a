//! The estimate of a car after a sample.

use super::estimate::CornerEstimate;
use crate::memory::Blank;
use crate::real::Real;

/// The estimate of the car after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarEstimate<T> {
    /// Time of the sample in s.
    pub time_s: f64,
    /// The corners, in the order of [`Corner::ALL`](crate::model::Corner::ALL).
    pub corners: [Option<CornerEstimate<T>>; 4],
    /// Correlation coefficients of the pressures' errors, in the order of [`Corner::ALL`](crate::model::Corner::ALL).
    pub correlation: [[T; 4]; 4],
    /// The same of the errors of the tires' losses, where these are counted.
    pub loss_correlation: [[T; 4]; 4],
    /// Left and right track: how the rear wheels follow the front ones.
    pub tracks: [TrackState<T>; 2],
}

/// How far front and rear of one side share a road now.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrackState<T> {
    /// Whether the shared road is being learned from.
    pub shared: bool,
    /// Share of the road's power near wheel hop that front and rear do not have in common, 0.001 to 2 (what two
    /// roads that have nothing in common differ by has twice the power of one); NaN when unknown.
    pub incoherence: T,
}

impl<T: Real> TrackState<T> {
    /// Nothing is shared, nothing is known.
    pub fn unknown() -> Self {
        Self { shared: false, incoherence: T::lit(f64::NAN) }
    }
}
