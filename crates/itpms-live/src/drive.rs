//! The running estimate: a drive as `itpms estimate` has it, and what is counted along the way.
//!
//! Owned by the engine, which hands it row after row. Knows nothing of sources, threads and outputs.

use itpms_analysis::odometer::Odometer;
use itpms_core::model::CarEstimate;
use itpms_core::warning::{Change, MonitorReport};
use itpms_data::out::{RateGate, WheelSpeedUse};
use itpms_data::pulses::Pulse;
use itpms_data::{LogRow, Vehicle};
use itpms_drive::Drive;

use crate::beside::BesideWatch;
pub use crate::clock::Clock;
use crate::error::LiveError;
pub use crate::options::DriveOptions;
pub use crate::reported::Reported;
use crate::roughness::Roughness;
use crate::speed::SpeedDoubt;

/// A drive being estimated. Made and restored in parts that are moved about: whoever does so needs a stack as a program's first
/// thread has it (8 MB), not a test's.
#[derive(Debug)]
pub struct LiveDrive {
    pub(crate) clock: Clock,
    pub(crate) drive: Box<Drive>,
    pub(crate) gate: RateGate,
    pub(crate) progress: Progress,
    pub(crate) roughness: Roughness,
    pub(crate) beside: BesideWatch,
    pub(crate) latest: Option<CarEstimate<f64>>,
}

/// Counters that are saved with the estimate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Progress {
    pub(crate) rows: u64,
    pub(crate) time_s: f64,
    pub(crate) odometer: Odometer,
    /// The last report: transitions are found against it.
    pub(crate) before: Option<MonitorReport<f64>>,
}

impl LiveDrive {
    /// A drive about to begin. Errors: parameters or a reference that the estimator refuses.
    pub fn new(vehicle: &Vehicle, clock: Clock, options: &DriveOptions) -> Result<Self, LiveError> {
        let DriveOptions { settings, reference, .. } = options;
        let (corners, rate_hz) = (&clock.corners, clock.sample_rate_hz);
        let wheel_speeds = match clock.wheel_speeds {
            true if corners.is_empty() => WheelSpeedUse::Alone,
            true => WheelSpeedUse::Beside,
            false => WheelSpeedUse::None,
        };
        let mut drive =
            Drive::with_reference(settings, reference.as_ref(), vehicle, corners, wheel_speeds, rate_hz)?;
        if !corners.is_empty() {
            drive = drive.with_road(vehicle, corners, rate_hz)?;
        }
        let roughness = Roughness::new(&clock)?;
        let beside = BesideWatch::new(vehicle, &clock, options);
        let progress = Progress { rows: 0, time_s: f64::NAN, odometer: Odometer::new(), before: None };
        Ok(Self {
            clock,
            drive: Box::new(drive),
            gate: RateGate::new(settings.rate_hz),
            progress,
            roughness,
            beside,
            latest: None,
        })
    }

    /// Takes a tooth pulse, before the first row that is not earlier. One of before the last row was taken then, or is lost.
    pub(crate) fn pulse(&mut self, pulse: &Pulse) {
        if !(pulse.time_s <= self.progress.time_s) {
            self.drive.pulse(pulse);
        }
    }

    /// Takes a row; gives what began and ended to `reported`. `true` if an estimate is due to be published.
    pub fn update(&mut self, row: &LogRow, mut reported: impl FnMut(f64, Reported)) -> bool {
        let mut row = *row;
        let estimate = self.drive.update(&mut row);
        let progress = &mut self.progress;
        (progress.rows, progress.time_s) = (progress.rows + 1, row.time_s);
        let speed_m_s = progress.odometer.push(row.time_s, row.speed_m_s);
        self.roughness.push(&estimate, speed_m_s, progress.odometer.distance_m());
        self.beside.take(&row, speed_m_s, &estimate.corners, &self.drive, &mut reported);
        self.latest = Some(estimate);
        let report = self.drive.report();
        if self.progress.before.as_ref().is_none_or(|before| before.time_s != report.time_s) {
            let time_s = report.time_s;
            match self.progress.before.replace(*report) {
                None => {
                    report
                        .alerts()
                        .for_each(|alert| reported(time_s, Reported::Change(Change::Begun(*alert))));
                }
                Some(before) => report
                    .changes_since(&before)
                    .for_each(|change| reported(time_s, Reported::Change(change))),
            }
        }
        self.gate.lets_through(row.time_s)
    }

    /// There are no more rows: what takes a while is worked out of all of them.
    pub(crate) fn finish(&mut self) {
        self.beside.finish(&self.drive);
    }

    /// The monitor's report after the last row.
    pub fn report(&self) -> &MonitorReport<f64> {
        self.drive.report()
    }

    /// The estimate after the last row.
    pub fn latest(&self) -> Option<&CarEstimate<f64>> {
        self.latest.as_ref()
    }

    /// Why the speed of the car is unknown; `None` where it is known.
    pub fn speed_doubt(&self) -> Option<SpeedDoubt> {
        match self.progress.odometer.speed_m_s().is_nan() {
            true if self.drive.denies_standstill() => Some(SpeedDoubt::Contradicted),
            true => Some(SpeedDoubt::Missing),
            false => None,
        }
    }

    /// Time of the last row in s; NaN before the first.
    pub fn time_s(&self) -> f64 {
        self.progress.time_s
    }
}
