//! The published AEKF-UI step on other people's Kalman filters, beside this project's own: the same equations, the same start, the same
//! noise, the same drive. Called by the example `peers`, by its program for a controller (`examples/firmware`) and by the test that all
//! of them find the same.
//!
//! | module | idea |
//! |---|---|
//! | [`corner`] | the quarter car of the paper (eq. 1-3, 13, 15), its state with or without the road, its setting and its drive |
//! | [`unknown_input`] | what a Kalman filter has to be given to find an input that nothing is known of (eq. 16, 28-33) |
//! | [`ours`] | [`ours::Dense`], [`ours::Lean`]: the filters of this project |
//! | [`on_nalgebra`] | both recursions written out with `nalgebra` |
//! | [`on_kfilter`], [`on_minikalman`] | both recursions on the library's own prediction and correction |
//!
//! **Two recursions.** *The step*: AEKF-UI with the one-step factor. A library predicts and corrects, and between the two the road is
//! found; that is what this project computes, and all of them agree. *An ordinary EKF*: the road is a sixth state that walks at random,
//! and nothing else is needed. That is another filter, which believes to know something of the road; its peers agree among themselves.

pub mod corner;
pub mod on_kfilter;
pub mod on_minikalman;
pub mod on_nalgebra;
pub mod ours;
pub mod unknown_input;

use itpms_core::Real;
use minikalman::matrix::MatrixDataType;
use nalgebra_of_kfilter::RealField as RealOfKfilter;

/// `f32` or `f64`, as every library asks for it.
pub trait Number: Real + RealOfKfilter + MatrixDataType {}

impl Number for f32 {}
impl Number for f64 {}

/// A filter at its start that takes a sample after the other.
pub trait Peer {
    /// What it computes with.
    type Scalar: Number;

    /// At its start, in the setting of [`corner`].
    fn fresh() -> Self;

    /// One sample: the accelerations of body and wheel in m/s², 2 ms after the one before.
    fn step(&mut self, measured: [Self::Scalar; 2]);

    /// `x_b, v_b, x_w, v_w, k_t` and the road, in m, m/s and N/m. NaN once the filter says that it has diverged.
    fn found(&self) -> [f64; 6];
}

/// Steps that are counted and timed, each time from the start: later the published filter walks off.
pub const STEPS: usize = 300;
