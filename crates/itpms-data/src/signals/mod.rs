//! What comes signal by signal instead of row by row: bus logs and measurement files whose signals have their own
//! clocks.
//!
//! Called by the log reader and by whoever listens to a bus; knows nothing of estimators.

pub mod align;

use crate::log::Slot;
pub use align::Aligner;

/// One value of one signal at its own time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Time in s on the log's clock.
    pub time_s: f64,
    /// What it is.
    pub slot: Slot,
    /// The value in the unit of [`Slot::name`]; NaN is a value that was sent as invalid.
    pub value: f64,
}
