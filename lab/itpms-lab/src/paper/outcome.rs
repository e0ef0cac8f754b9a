//! Outcome of a case: the drive that is drawn, and figures over all its drives.
//!
//! Filled by `plan`, read by the sections.

use itpms_paper::EstimatorKind;

use super::case::Case;
use super::contestant::Contestant;
use super::drive::{Drive, Trace, Truth};
use crate::score::stats::Spread;

/// One contestant over all drives of a case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    pub(super) who: Contestant,
    /// RMSE over t > 3 s in kPa.
    pub(super) rmse: Spread,
    pub(super) after: Spread,
    /// Mean share of the time after the reset drive with the truth inside the 95 % interval, over the drives that
    /// did not diverge; NaN if all did.
    pub(super) coverage: f64,
    pub(super) diverged: usize,
    pub(super) drives: usize,
    pub(super) drawn_diverged_s: Option<f64>,
    pub(super) trace: Trace,
    pub(super) drawn_rmse_kpa: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    pub(super) truth: Truth,
    /// In the order of the case's contestants.
    pub(super) records: Vec<Record>,
    pub(super) duration_s: f64,
    pub(super) rate_hz: f64,
}

impl Outcome {
    /// The first drive is the drawn one.
    pub(super) fn of(case: &Case, mut drives: Vec<Drive>) -> Self {
        let record = |(i, who): (usize, &Contestant)| {
            let each = || drives.iter().filter_map(move |drive| drive.results.get(i));
            // A diverged filter claims nothing.
            let covered: Vec<f64> =
                each().filter(|result| result.diverged_s.is_none()).map(|result| result.coverage).collect();
            let drawn = each().next();
            Record {
                who: *who,
                rmse: Spread::of(each().map(|result| result.rmse_kpa)),
                after: Spread::of(each().map(|result| result.rmse_after_kpa)),
                coverage: covered.iter().sum::<f64>() / covered.len() as f64,
                diverged: each().filter(|result| result.diverged_s.is_some()).count(),
                drives: drives.len(),
                drawn_diverged_s: drawn.and_then(|result| result.diverged_s),
                trace: drawn.map(|result| result.trace.clone()).unwrap_or_default(),
                drawn_rmse_kpa: drawn.map_or(f64::NAN, |result| result.rmse_kpa),
            }
        };
        let records = case.contestants.iter().enumerate().map(record).collect();
        let truth = drives.first_mut().map(|drive| std::mem::take(&mut drive.truth)).unwrap_or_default();
        Self { truth, records, duration_s: case.scenario.duration_s, rate_hz: case.scenario.rate_hz }
    }

    /// Name of a record in columns of data. Who drives with and without a reset has the reset in the name.
    pub(super) fn column(&self, record: &Record) -> String {
        let name = record.who.label().replace('-', "_");
        let twice = self.records.iter().filter(|other| other.who.kind == record.who.kind).count() > 1;
        if twice && record.who.reset_s == 0.0 { name + "_no_reset" } else { name }
    }

    /// The four that every figure shows.
    pub(super) fn shown(&self) -> impl Iterator<Item = &Record> {
        self.records.iter().take(EstimatorKind::ALL.len())
    }

    pub(super) fn informed(&self) -> Option<&Record> {
        self.shown().find(|record| record.who.kind == EstimatorKind::Informed)
    }

    /// RMSE of a kind after its reset, if it has one.
    pub(super) fn judged(&self, kind: EstimatorKind) -> Option<Spread> {
        let found = self.shown().find(|record| record.who.kind == kind);
        found.map(|record| if record.who.reset_s > 0.0 { record.after } else { record.rmse })
    }

    /// Its RMSE over t > 3 s.
    pub(super) fn informed_rmse(&self) -> Spread {
        let none = Spread { p10: f64::NAN, median: f64::NAN, p90: f64::NAN };
        self.informed().map_or(none, |record| record.rmse)
    }
}
