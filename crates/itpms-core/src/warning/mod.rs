//! Warnings: limits, pressures against them, and the report.

mod alert;
pub(crate) mod all_low;
pub(crate) mod all_tires;
pub(crate) mod leak;
mod limits;
pub(crate) mod low;
pub(crate) mod reference_pressure;
pub(crate) mod report;
mod tuning;

pub use self::alert::{Alert, Basis, Cause, LeakOverDays, Reading};
pub use self::limits::{Limits, Regulation};
pub use self::report::{Change, Doubt, MonitorReport, WheelReport, WheelState};
pub use self::tuning::Tuning;
use crate::decision;

/// By what warnings are decided.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rules<'a, T> {
    pub(crate) limits: &'a Limits<T>,
    pub(crate) decision: &'a decision::Tuning,
    pub(crate) tuning: &'a Tuning,
}
