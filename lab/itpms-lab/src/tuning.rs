//! The monitor as a study has it: with its numbers as they are shipped, or with those of `--tuning`.
//!
//! Set once, by the command, for all that the process drives: a study compares drives, and two tables are two runs.

use std::sync::OnceLock;

use itpms_core::model::CarConfig;
use itpms_core::monitor::MonitorConfig;
use itpms_data::tuning::Tuning;

static TUNING: OnceLock<Tuning> = OnceLock::new();

/// Sets the numbers of all monitors from now on; `false`: they were set before.
#[must_use]
pub fn set(tuning: Tuning) -> bool {
    TUNING.set(tuning).is_ok()
}

pub(crate) fn monitor(car: &CarConfig<f64>) -> MonitorConfig<f64> {
    MonitorConfig { tuning: numbers().monitor, ..MonitorConfig::new(car) }
}

/// Its numbers, and those of wheel speeds.
pub(crate) fn numbers() -> Tuning {
    TUNING.get().copied().unwrap_or_default()
}
