//! Outcome of a later day by one estimator: levels, warnings, and how far another tire rose.
//!
//! Filled row by row by the path, read by the rows of the score.

use itpms_core::model::{CarEstimate, Corner};
use itpms_core::warning::{Cause, MonitorReport};
use itpms_sim::simulation::SimRow;

use super::super::stats::ErrorSum;

/// A loss on the later day: when it begins and how long it takes, in s.
pub(super) const LOSS_S: [f64; 2] = [60.0, 10.0];
/// Seconds at the start of a drive whose errors do not count, and before a loss in which the others' level is taken.
const SETTLED_S: f64 = 20.0;
const BEFORE_S: f64 = 10.0;

/// One wheel: without a loss, or since it began.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wheel {
    pub(super) errors: ErrorSum,
    pub(super) sds: f64,
    pub(super) valid: u64,
    /// Rows in which it was shown as fine, and all.
    pub(super) fine: u64,
    pub(super) rows: u64,
    /// Whether it was called low though it is not.
    pub(super) false_low: bool,
    before: [f64; 2],
}

#[derive(Debug, Clone, Default)]
pub(super) struct Seen {
    pub(super) struck: Option<Corner>,
    pub(super) wheels: [Wheel; 4],
    /// Seconds from the complete loss to the warning of that tire.
    pub(super) after_s: Option<f64>,
    /// Largest rise in kPa of another tire since before the loss.
    pub(super) rise_kpa: f64,
    /// Whether it was reported that all are low, that one is overfull, that a sensor does not work: all of it false here.
    pub(super) all_low: bool,
    pub(super) over: bool,
    pub(super) sensor: bool,
}

impl Seen {
    pub(super) fn sound() -> Self {
        Self::default()
    }

    pub(super) fn losing(struck: Corner) -> Self {
        Self { struck: Some(struck), ..Self::default() }
    }

    /// Whether a tire was called low, or all were, though nothing of the kind is true.
    pub(super) fn is_false_low(&self) -> bool {
        self.all_low || self.wheels.iter().any(|wheel| wheel.false_low)
    }

    pub(super) fn take(&mut self, row: &SimRow, estimate: &CarEstimate<f64>, report: &MonitorReport<f64>) {
        self.hear(row.time_s, report);
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let (Some(truth), Some(corner), Some(shown)) =
                (&row.corners[i], &estimate.corners[i], &report.wheels[i])
            else {
                continue;
            };
            if row.time_s <= SETTLED_S {
                continue;
            }
            let is_valid = corner.validity.is_valid();
            wheel.rows += 1;
            wheel.fine += u64::from(shown.state.label() == "fine");
            if !is_valid {
                continue;
            }
            wheel.valid += 1;
            let since_s = row.time_s - LOSS_S[0];
            if since_s < 0.0 && since_s > -BEFORE_S {
                wheel.before[0] += corner.pressure_kpa;
                wheel.before[1] += 1.0;
            }
            // Times before a loss count in the same drive without one.
            if self.struck.is_none() || since_s >= 0.0 {
                wheel.sds += corner.pressure_sd_kpa;
                wheel.errors.push(corner.pressure_kpa - truth.pressure_kpa, corner.pressure_sd_kpa);
            }
            if since_s >= 0.0 && self.struck.is_some_and(|struck| struck.index() != i) {
                let rise_kpa = corner.pressure_kpa - wheel.before[0] / wheel.before[1];
                self.rise_kpa = self.rise_kpa.max(rise_kpa);
            }
        }
    }

    fn hear(&mut self, time_s: f64, report: &MonitorReport<f64>) {
        for alert in report.alerts() {
            match &alert.cause {
                Cause::AllLow { .. } => self.all_low = true,
                Cause::OverInflated(_) => self.over = true,
                Cause::Malfunction(_) => self.sensor = true,
                cause if cause.is_low() => {
                    for corner in alert.wheels.iter() {
                        if self.struck == Some(corner) && time_s >= LOSS_S[0] {
                            self.after_s.get_or_insert(time_s - LOSS_S[0] - LOSS_S[1]);
                        } else {
                            self.wheels[corner.index()].false_low = true;
                        }
                    }
                }
                _ => {}
            }
        }
    }
}
