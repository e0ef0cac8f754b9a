//! The task for a log: given before the first row, known to all that work on a drive.

use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::log::LogOptions;

use crate::settings::Settings;

/// Which heights of the road under each wheel are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Heights {
    #[default]
    None,
    /// Those that are known with each row: for a roughness.
    Causal,
    /// Those that are known half a minute later: for a road record or a report.
    Smoothed,
}

/// The task for a log.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    pub vehicle: &'a Vehicle,
    /// The corners to estimate: see [`crate::common_corners`].
    pub corners: &'a [Corner],
    pub settings: &'a Settings,
    pub reading: &'a LogOptions,
    pub road: Heights,
    /// Whether a report is drawn: what only a report shows is not computed without one.
    pub report: bool,
}
