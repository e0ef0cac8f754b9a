//! Events of a drive, for the engine to number and publish.

use itpms_core::warning::Change;
use serde_json::{Map, Value};

/// Something that began or ended.
#[derive(Debug)]
pub enum Reported {
    Change(Change<f64>),
    /// Found beside the pressures, as an alert.
    BesideBegun(Map<String, Value>),
    /// See [`BesideBegun`](Self::BesideBegun).
    BesideEnded(Map<String, Value>),
}
