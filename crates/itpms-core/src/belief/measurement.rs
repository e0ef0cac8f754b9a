//! A measurement of one side: the residual of a frame with its derivatives, its expected covariance, and the record of its update.

use nalgebra::{Complex, SMatrix, SVector};

use super::state::{SIDE_SIZE, SideReading};
use crate::memory::Blank;
use crate::real::Real;

pub(crate) const BINS: usize = 5;
/// Real numbers in a frame's residual: real and imaginary part of every bin.
pub(crate) const ROWS: usize = 2 * BINS;

/// Rows and columns over a side's quantities.
pub(crate) type Gram<T> = SMatrix<T, SIDE_SIZE, SIDE_SIZE>;
/// Lower triangle of a symmetric one, packed by columns.
pub(crate) type Products<T> = SVector<T, PRODUCTS>;
const PRODUCTS: usize = SIDE_SIZE * (SIDE_SIZE + 1) / 2;

/// Gradient of a frame's log-likelihood by a side's quantities.
pub(crate) type Score<T> = SVector<T, SIDE_SIZE>;
/// Derivatives of a residual by a side's quantities.
pub(crate) type Slope<T> = SMatrix<T, ROWS, SIDE_SIZE>;

/// Residual of a frame, linearized at a state: what front and rear reconstruct of one road, front less rear.
#[derive(Debug, Clone)]
pub(crate) struct AxleResidual<T: Real> {
    /// Prefit residual in m/s: real parts of all bins, then imaginary parts.
    pub(crate) rows: SVector<T, ROWS>,
    pub(crate) slope: Slope<T>,
    /// Road velocity of every bin, mean of the axles.
    pub(crate) common: [Complex<T>; BINS],
    /// Road power of every bin, mean of the axles.
    pub(crate) road_power: [T; BINS],
}

/// What is expected of a frame, and what it is worth.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Expectation<T: Real> {
    /// Power of the residual, per bin.
    pub(crate) power: [T; BINS],
    /// Road power, per bin, as the state reads it that the frame is held against.
    pub(crate) road_power: [T; BINS],
    /// Information about the side's quantities: the lower triangular `G` with `G G'`.
    pub(crate) information_root: Gram<T>,
}

/// A frame of one side as the belief takes it.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SideMeasurement<T: Real> {
    pub(crate) reading: SideReading<T>,
    pub(crate) expected: Expectation<T>,
    /// Derivatives taken from the road that both axles agree on, free of the axles' differences.
    pub(crate) instrument: Slope<T>,
    /// How much of the frame counts, 0 to 1.
    pub(crate) weight: T,
    /// Seconds of incoherence by which the belief about the side's tires fades before the update.
    pub(crate) incoherent_s: T,
}

/// Outcome of an update with a frame, for the most likely hypothesis.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct UpdateRecord<T: Real> {
    /// Road power of every bin, as the hypothesis reads it.
    pub(crate) road_power: [T; BINS],
    /// Power of the residual over its expectation, per bin.
    pub(crate) power_ratio: [T; BINS],
    /// How much of the frame counted, 0 to 1.
    pub(crate) weight: T,
}
