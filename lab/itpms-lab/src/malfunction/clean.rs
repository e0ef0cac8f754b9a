//! The same drives without a malfunction: what is reported for nothing, and how far off a pressure is anyway.

use itpms_core::model::{CarEstimate, CarSample, Validity};
use itpms_core::warning::{Cause, Change, MonitorReport};
use serde::Serialize;

use super::drive::Recorded;

#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Clean {
    pub hours: f64,
    pub distance_km: f64,
    pub malfunctions: usize,
    pub warnings: usize,
    /// Share of the wheels' time in which their sensors were under suspicion.
    pub share_screened: f64,
    /// Share of the time shown with a pressure more than 3 sd and 20 kPa off; more than 20 kPa off.
    pub share_wrong: f64,
    pub share_far: f64,
}

/// Looks at a drive without a malfunction.
pub(super) struct Watch<'a> {
    drive: &'a Recorded,
    before: Option<MonitorReport<f64>>,
    clean: Clean,
    shown: usize,
    wheels: usize,
    screened: usize,
    wrong: usize,
    far: usize,
}

impl<'a> Watch<'a> {
    pub(super) fn new(drive: &'a Recorded) -> Self {
        let clean = Clean::default();
        Self { drive, before: None, clean, shown: 0, wheels: 0, screened: 0, wrong: 0, far: 0 }
    }

    /// Takes a row and what was made of it.
    pub(super) fn take(
        &mut self,
        sample: &CarSample<f64>,
        estimate: &CarEstimate<f64>,
        report: &MonitorReport<f64>,
    ) {
        let hours = 1.0 / (3600.0 * self.drive.rate_hz);
        self.clean.hours += hours;
        self.clean.distance_km += 3.6 * sample.speed_m_s * hours;
        for (estimate, truth) in estimate.corners.iter().flatten().zip(&self.drive.pressure_kpa) {
            self.wheels += 1;
            self.screened += usize::from(estimate.validity == Validity::BadSignal);
            if estimate.validity.is_valid() {
                let error = (estimate.pressure_kpa - truth).abs();
                self.shown += 1;
                self.far += usize::from(error > 20.0);
                self.wrong += usize::from(error > 20.0 && error > 3.0 * estimate.pressure_sd_kpa);
            }
        }
        let before = self.before.get_or_insert(*report);
        if before.time_s != report.time_s {
            for change in report.changes_since(before) {
                if let Change::Begun(alert) = change {
                    match alert.cause {
                        Cause::Malfunction(_) | Cause::NoInformation { .. } => self.clean.malfunctions += 1,
                        _ => self.clean.warnings += 1,
                    }
                }
            }
            *before = *report;
        }
    }

    pub(super) fn finish(self) -> Clean {
        Clean {
            share_screened: self.screened as f64 / self.wheels.max(1) as f64,
            share_wrong: self.wrong as f64 / self.shown.max(1) as f64,
            share_far: self.far as f64 / self.shown.max(1) as f64,
            ..self.clean
        }
    }
}

/// All drives, which are of one length, together.
pub(super) fn sum<'a>(drives: impl Iterator<Item = &'a Clean> + Clone) -> Clean {
    let n = drives.clone().count() as f64;
    drives.fold(Clean::default(), |sum, drive| Clean {
        hours: sum.hours + drive.hours,
        distance_km: sum.distance_km + drive.distance_km,
        malfunctions: sum.malfunctions + drive.malfunctions,
        warnings: sum.warnings + drive.warnings,
        share_screened: sum.share_screened + drive.share_screened / n,
        share_wrong: sum.share_wrong + drive.share_wrong / n,
        share_far: sum.share_far + drive.share_far / n,
    })
}
